#include "compute/form_factors.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/geometric.hpp>

#include "compute/closed_solid.h"
#include "compute/exact_form_factors.h"
#include "compute/gpu/device.h"
#include "compute/hemicube.h"
#include "compute/hemicube_refined.h"
#include "compute/hierarchical.h"
#include "compute/kernel_choice.h"
#include "compute/matrix_sums.h"
#include "compute/monte_carlo.h"
#include "compute/parallel.h"
#include "compute/row_claims.h"
#include "compute/stopwatch.h"
#include "geometry/input_error.h"
#include "geometry/outline_area.h"

namespace heliodon::compute {

namespace {

constexpr uint32_t kFirstRays = 1024, kMostRays = 65536;
constexpr uint32_t kStreamedRows = 256;
constexpr uint32_t kSamples = 32, kSampledTogether = 8; // rows by which a stream's rays are chosen
constexpr double kBelowAsked = 0.9;                     // of the sample, so that all rows are below too
constexpr double kMargin = 1.5; // over what was asked, that claims of all but `exact` may have without a word
// Of `auto`: about the least row error that all rays reach; how much finer visible polygons are asked again.
constexpr double kLeastOfRays = 2e-3, kFinerExact = 1.0 / 3;

// How many times the rays bring `claimed` to `wanted`: a kernel's error falls about with their 0.6th power.
double moreRays(double claimed, double wanted) {
    return std::pow(claimed / wanted, 1 / 0.6);
}

std::string allRaysCast(double claimed) {
    return fmt::format("; the most there are, {:.1e} remains", claimed);
}

// Until the kernel's own claim is below what is asked.
FormFactors monteCarloFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                                  const FormFactorOptions& options, double maxError) {
    const uint32_t side = std::min(options.resolution, 256u);
    uint32_t rays = maxError > 0 ? kFirstRays : side * side;
    for (;;) {
        MonteCarlo kernel(device, mesh, {rays});
        FormFactors result = kernel.run().factors;
        const double claimed = result.report.claimedRowError;
        result.report.resolution = static_cast<uint32_t>(std::lround(std::sqrt(kernel.rays())));
        if (!(maxError > 0) || claimed <= maxError) return result;
        if (kernel.rays() >= kMostRays) {
            result.report.why += allRaysCast(claimed);
            return result;
        }
        rays = static_cast<uint32_t>(
            std::clamp(kernel.rays() * moreRays(claimed, maxError), 2.0 * kernel.rays(), 1.0 * kMostRays));
    }
}

// Rays a patch that a sample of the rows needs, each from its own rays, until their claim is below what is
// asked.
uint32_t raysOfRows(gpu::Device& device, const geometry::PatchMesh& mesh, double maxError) {
    const auto n = static_cast<uint32_t>(mesh.patchCount());
    const uint32_t samples = std::min(kSamples, (n + kSampledTogether - 1) / kSampledTogether);
    std::vector<float> values(size_t{kSampledTogether} * n);
    std::vector<MonteCarloSpread> spreads(kSampledTogether);
    for (uint32_t rays = 256;;) {
        MonteCarlo kernel(device, mesh, {rays});
        MonteCarloSpread sampled;
        double rows = 0;
        for (uint32_t k = 0; k < samples; ++k) {
            const auto first = static_cast<uint32_t>(uint64_t{n} * k / samples);
            const uint32_t count = std::min(kSampledTogether, n - first);
            kernel.rows(first, count, values, spreads);
            for (uint32_t i = 0; i < count; ++i) sampled.add(spreads[i]);
            rows += count;
        }
        const double claimed = sampled.claim() / std::sqrt(std::max(rows, 1.0));
        const double wanted = kBelowAsked * maxError, now = kernel.rays();
        if (claimed <= wanted || kernel.rays() >= kMostRays) return kernel.rays();
        // Kernels cast powers of two: from the one below, since all rows pay for rays too many.
        rays = std::bit_floor(
            static_cast<uint32_t>(std::clamp(now * moreRays(claimed, wanted), 2 * now, 1.0 * kMostRays)));
    }
}

// From few pixels on, until the claim is below what is asked or what lacks falls no more. Past 64 pixels
// points do as much as pixels and see more of each patch.
FormFactors hemicubeFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                                const FormFactorOptions& options, double maxError) {
    RefinedHemicubeOptions hemicube{options.resolution, options.points};
    if (!(maxError > 0)) return refinedHemicubeFormFactors(device, mesh, hemicube).factors;
    constexpr std::array<std::array<uint32_t, 2>, 5> kSteps{{{32, 1}, {64, 1}, {64, 4}, {128, 4}, {128, 16}}};
    constexpr double kPart = 0.7, kFalls = 0.9; // of both errors; of one, when more is spent on it
    constexpr double kCounts = 0.3;             // of the other error: less is not worth going on for alone
    double lastNear = INFINITY, lastFar = INFINITY;
    bool nearFalls = true, farFalls = true;
    for (size_t step = 0;;) {
        hemicube.resolution = kSteps[step][0], hemicube.points = kSteps[step][1];
        RefinedHemicube result = refinedHemicubeFormFactors(device, mesh, hemicube);
        FormFactorReport& report = result.factors.report;
        if (report.claimedRowError <= maxError) return std::move(result.factors);
        nearFalls = nearFalls && result.nearError <= kFalls * lastNear;
        // What more pixels do not lower, more points may.
        farFalls = farFalls && (result.farError <= kFalls * lastFar || hemicube.points == 1) &&
                   step + 1 < kSteps.size();
        const bool near = nearFalls && result.nearError > kPart * maxError &&
                          (farFalls || result.nearError > kCounts * result.farError),
                   far = farFalls && result.farError > kPart * maxError &&
                         (nearFalls || result.farError > kCounts * result.nearError);
        if (!near && !far) {
            report.why += fmt::format("; {:.1e} remains", report.claimedRowError);
            return std::move(result.factors);
        }
        lastNear = lastFar = INFINITY;
        if (near) {
            hemicube.pairTolerance *= std::clamp(0.5 * maxError / result.nearError, 0.1, 0.5);
            lastNear = result.nearError;
        }
        if (far) {
            // Each step about halves it: those that would not do are left out.
            const double lacking = std::floor(std::log2(result.farError / maxError));
            step = std::min(step + static_cast<size_t>(std::clamp(lacking, 1.0, 1.0 * kSteps.size())),
                            kSteps.size() - 1);
            lastFar = result.farError;
        }
    }
}

HierarchicalFormFactors links(gpu::Device& device, const geometry::PatchMesh& mesh, double maxError,
                              double mostClaim = 0) {
    HierarchicalOptions options{.mostClaim = mostClaim};
    if (maxError > 0) options.maxError = maxError;
    return HierarchicalFormFactors(device, mesh, options);
}

using TakeTile = std::function<void(const FormFactorTile&)>;

ExactOptions exactOptions(const FormFactorOptions& options, double maxError) {
    ExactOptions exact;
    if (maxError > 0) exact.maxError = maxError;
    exact.progress = options.progress;
    exact.longWork = options.longWork;
    exact.longFrom = options.longFrom;
    return exact;
}

FormFactorReport exactTiles(gpu::Device& device, const geometry::PatchMesh& mesh, const ExactOptions& exact,
                            const TakeTile& take) {
    const auto takeTile = [&](const ExactTile& t) {
        take({t.firstRow, t.rows, t.firstColumn, t.columns, {t.values, size_t{t.rows} * t.columns}});
    };
    FormFactorReport report = exactFormFactorTiles(device, mesh, exact, takeTile).factors.report;
    report.reciprocityRms = 0;
    return report;
}

[[noreturn]] void refuseErrorOfRows(size_t patches) {
    throw geometry::InputError(
        "--kernel", "hemicube",
        fmt::format(
            "rows of {} patches are written as they come, before what their columns show of the error "
            "is known: no error can be asked for; expected --resolution instead, or another kernel",
            patches));
}

FormFactorReport hemicubeRows(gpu::Device& device, const geometry::PatchMesh& mesh,
                              const FormFactorOptions& options, const TakeTile& take) {
    const auto n = static_cast<uint32_t>(mesh.patchCount());
    FormFactorReport report;
    Hemicube hemicube(device, mesh, {options.resolution});
    for (uint32_t first = 0; first < n; first += kStreamedRows) {
        const uint32_t count = std::min(kStreamedRows, n - first);
        const PatchViewpoints views = patchViewpoints(mesh, options.points, first, count);
        const auto values =
            hemicube.run(views.viewpoints, views.pointsPerPatch).factors.download<float>(size_t{count} * n);
        take({first, count, 0, n, values});
        report.points = views.pointsPerPatch;
    }
    report.why = "rows as their points see them";
    report.resolution = hemicube.resolution();
    return report;
}

FormFactorReport monteCarloRows(gpu::Device& device, const geometry::PatchMesh& mesh,
                                const FormFactorOptions& options, double maxError, const TakeTile& take) {
    const auto n = static_cast<uint32_t>(mesh.patchCount());
    const uint32_t side = std::min(options.resolution, 256u);
    MonteCarlo kernel(device, mesh, {maxError > 0 ? raysOfRows(device, mesh, maxError) : side * side});
    std::vector<float> values(size_t{std::min(n, kStreamedRows)} * n);
    std::vector<MonteCarloSpread> spreads(kStreamedRows);
    MonteCarloSpread all;
    for (uint32_t first = 0; first < n; first += kStreamedRows) {
        const uint32_t count = std::min(kStreamedRows, n - first);
        kernel.rows(first, count, values, spreads);
        for (uint32_t k = 0; k < count; ++k) all.add(spreads[k]);
        take({first, count, 0, n, std::span(values).first(size_t{count} * n)});
    }
    FormFactorReport report;
    report.why = fmt::format("each row from its own {} rays", kernel.rays());
    report.points = kernel.rays();
    report.claimedRowError = all.claim() / std::sqrt(std::max(n, 1u));
    if (maxError > 0 && report.claimedRowError > maxError && kernel.rays() >= kMostRays)
        report.why += allRaysCast(report.claimedRowError);
    return report;
}

// Rows [0, n) in blocks, each block's on all cores.
void takeRows(const HierarchicalFormFactors& factors, const TakeTile& take) {
    const uint32_t n = factors.patchCount();
    std::vector<float> values(size_t{std::min(n, kStreamedRows)} * n);
    for (uint32_t first = 0; first < n; first += kStreamedRows) {
        const uint32_t count = std::min(kStreamedRows, n - first);
        inParallel(count, [&](size_t k) {
            factors.rows(first + static_cast<uint32_t>(k), 1, std::span(values).subspan(k * n, n));
        });
        take({first, count, 0, n, std::span(values).first(size_t{count} * n)});
    }
}

// No values where the links gave up: above `mostClaim`, if not 0.
FormFactors hierarchicalFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh, double maxError,
                                    double mostClaim) {
    const HierarchicalFormFactors compressed = links(device, mesh, maxError, mostClaim);
    const uint32_t n = compressed.patchCount();
    FormFactors result;
    result.patchCount = n;
    result.report = compressed.report();
    if (compressed.gaveUp()) return result;
    result.values = gpu::Buffer(device, size_t{n} * n * sizeof(float), "form factors");
    if (auto* F = result.values.mapped<float>()) {
        inParallel(n,
                   [&](size_t i) { compressed.rows(static_cast<uint32_t>(i), 1, std::span(F + i * n, n)); });
        return result;
    }
    takeRows(compressed, [&](const FormFactorTile& tile) {
        result.values.upload(tile.values, size_t{tile.firstRow} * n * sizeof(float));
    });
    return result;
}

[[noreturn]] void refuse(const std::string& kernel) {
    throw geometry::InputError(
        "--kernel", kernel, fmt::format("unknown; expected auto, {}", fmt::join(formFactorKernels(), ", ")));
}

FormFactors factorsOf(gpu::Device& device, const geometry::PatchMesh& mesh, const FormFactorOptions& options,
                      const KernelChoice& choice) {
    if (choice.kernel == "exact")
        return exactFormFactors(device, mesh, exactOptions(options, choice.maxError)).factors;
    if (choice.kernel == "hemicube") return hemicubeFormFactors(device, mesh, options, choice.maxError);
    if (choice.kernel == "hierarchical")
        return hierarchicalFormFactors(device, mesh, choice.ofLinks * choice.maxError,
                                       options.kernel == "auto" ? kMargin * choice.maxError : 0);
    if (choice.kernel == "montecarlo") return monteCarloFormFactors(device, mesh, options, choice.maxError);
    refuse(choice.kernel);
}

// Where `exact` has rows above one (only then it claims anything of sums) its errors are as large as that.
double marginOf(const FormFactorReport& report, const std::string& kernel) {
    return kernel == "exact" && report.claimedRowSumError > 0 ? kMargin : report.caution;
}

// Of `auto`, where visible polygons cannot be found.
void leaveToLinks(KernelChoice& choice) {
    choice.kernel = "hierarchical";
    choice.maxError = std::max(choice.maxError, kLeastErrorOfLinks);
    choice.why += "; more blockers stand between two patches than this device can find visible polygons "
                  "behind: links between clusters instead";
}

// Another kernel goes on where the first does not keep what was asked, or cannot.
FormFactors factorsOfAuto(gpu::Device& device, const geometry::PatchMesh& mesh,
                          const FormFactorOptions& options, KernelChoice& choice) {
    try {
        FormFactors result = factorsOf(device, mesh, options, choice);
        const double claimed = result.report.claimedRowError, sums = result.report.claimedRowSumError;
        // Sums matter to light only; of entries, rows are what was asked.
        const double missed = options.forLight ? std::max(claimed, sums / kSumOverRow) : claimed;
        if (choice.kernel == "exact" || missed <= kMargin * choice.maxError) return result;
        choice.kernel = "exact";
        choice.why += fmt::format("; these leave up to {:.2g}", claimed);
        if (sums > 0) choice.why += fmt::format(", {:.2g} of a row's sum", sums); // not once they gave up
        choice.why += ": visible polygons instead";
        result = {}; // both matrices would take twice the memory
        return factorsOf(device, mesh, options, choice);
    } catch (const TooManyBlockers&) {
        leaveToLinks(choice);
        return hierarchicalFormFactors(device, mesh, choice.ofLinks * choice.maxError, 0);
    }
}

// With the claims that only the finished matrix allows.
void measure(gpu::Device& device, const geometry::PatchMesh& mesh, const std::string& kernel,
             FormFactors& factors) {
    measureFormFactors(device, mesh, factors.values, factors.report);
    if (kernel == "montecarlo") claimWhatRaysMiss(mesh, factors.report);
}

bool keepsRows(const FormFactors& factors, const KernelChoice& choice, double asked) {
    return factors.report.claimedRowError <= marginOf(factors.report, choice.kernel) * asked;
}

// What may keep the rows that `choice` has not kept: nothing where faces lie in one place, since who gets
// their light is not defined.
std::vector<KernelChoice> alternativesTo(const KernelChoice& choice, const FormFactors& missed,
                                         const geometry::PatchMesh& mesh) {
    std::vector<KernelChoice> others;
    if (!patchesInOnePlace(mesh).empty()) return others;
    KernelChoice other = choice;
    other.kernel = "montecarlo";
    if (choice.kernel != other.kernel && choice.maxError >= kLeastOfRays) others.push_back(other);
    other.kernel = "exact";
    other.maxError = std::max(kFinerExact * choice.maxError, 1e-7);
    if (choice.kernel == other.kernel && missed.report.claimedRowSumError == 0) others.push_back(other);
    return others;
}

// Of `auto`, where an error was asked of the matrix that its measured claim lies above: the least claim of
// what there is, and a warning where none keeps it. False where nothing lacks.
bool goOnWhereMissed(gpu::Device& device, const geometry::PatchMesh& mesh, const FormFactorOptions& options,
                     KernelChoice& choice, FormFactors& factors) {
    const double asked = choice.maxError;
    if (options.forLight || !(options.maxError > 0 || options.maxRadiosityError > 0) ||
        keepsRows(factors, choice, asked))
        return false;
    const auto claimOf = [](const KernelChoice& of, const FormFactors& made) {
        return fmt::format("{} {:.2g}", of.kernel, made.report.claimedRowError);
    };
    std::string claims = claimOf(choice, factors);
    for (KernelChoice& other : alternativesTo(choice, factors, mesh)) {
        FormFactors made;
        try {
            made = factorsOf(device, mesh, options, other);
        } catch (const TooManyBlockers&) { // which finer errors may meet first
            continue;
        }
        measure(device, mesh, other.kernel, made);
        claims += ", " + claimOf(other, made);
        if (made.report.claimedRowError >= factors.report.claimedRowError) continue;
        factors = std::move(made);
        choice = other;
        if (keepsRows(factors, choice, asked)) break;
    }
    choice.why += fmt::format("; rows are claimed within {} where {:.2g} was asked for: {} it is", claims,
                              asked, choice.kernel);
    if (!keepsRows(factors, choice, asked))
        choice.missed = fmt::format(
            "no kernel keeps the row error of {:.2g} that was asked for; claimed are {}", asked, claims);
    return true;
}

FormFactorReport tilesOf(gpu::Device& device, const geometry::PatchMesh& mesh,
                         const FormFactorOptions& options, const KernelChoice& choice, const TakeTile& take) {
    if (choice.kernel == "exact")
        return exactTiles(device, mesh, exactOptions(options, choice.maxError), take);
    if (choice.kernel == "hierarchical") {
        const HierarchicalFormFactors factors = links(device, mesh, choice.ofLinks * choice.maxError);
        takeRows(factors, take);
        return factors.report();
    }
    if (choice.kernel == "hemicube") {
        if (choice.maxError > 0) refuseErrorOfRows(mesh.patchCount());
        return hemicubeRows(device, mesh, options, take);
    }
    if (choice.kernel == "montecarlo") return monteCarloRows(device, mesh, options, choice.maxError, take);
    refuse(choice.kernel);
}

void measureClosure(std::span<const double> rowSums, FormFactorReport& report) {
    double squares = 0;
    report.closureMax = 0;
    for (double sum : rowSums) {
        report.closureMax = std::max(report.closureMax, std::abs(sum - 1));
        squares += (sum - 1) * (sum - 1);
    }
    report.closureRms = std::sqrt(squares / static_cast<double>(std::max<size_t>(rowSums.size(), 1)));
}

// Open scenes' rows end where their light leaves; of closed rooms all of it arrives.
void warnOfLostLight(const geometry::PatchMesh& mesh, FormFactorReport& report) {
    if (report.closureMax <= kClosureBound || !isClosedSolid(mesh)) return;
    if (facesLookOutwards(mesh))
        report.warnings.emplace_back(kFacesLookOutwards);
    else
        report.warnings.push_back(fmt::format("the room is closed, but the form factors of a patch sum to 1 "
                                              "+- {:.2g} (RMS of all {:.1g}): a lower "
                                              "error asked, or --kernel exact, keeps the light of single "
                                              "patches, unless bodies cross one another",
                                              report.closureMax, report.closureRms));
}

void explain(FormFactorReport& report, const FormFactorOptions& options, const KernelChoice& choice) {
    report.kernel = choice.kernel;
    if (!choice.why.empty()) report.why = choice.why + "; " + report.why;
    report.claimedRadiosityError = choice.amplification * report.claimedRowError;
    const double margin = marginOf(report, report.kernel);
    const auto warnIfAbove = [&](const char* of, double claimed, double asked,
                                 const char* why = "was asked for") {
        if (asked > 0 && claimed > margin * asked)
            report.warnings.push_back(fmt::format("the error of {} is estimated as up to {:.2g}, {:.2g} {}",
                                                  of, claimed, asked, why));
    };
    warnIfAbove("radiosity", report.claimedRadiosityError, options.maxRadiosityError);
    if (choice.missed.empty())
        warnIfAbove("rows", report.claimedRowError, options.maxError);
    else
        report.warnings.push_back(choice.missed);
    if (report.kernel == "hierarchical")
        warnIfAbove("a row's sum", report.claimedRowSumError, kSumOverRow * options.maxError,
                    "is what such an error of rows leaves light that goes round");
}

} // namespace

std::vector<std::vector<uint32_t>> patchesInOnePlace(const geometry::PatchMesh& mesh) {
    std::map<std::vector<std::array<double, 3>>, std::vector<uint32_t>> byCorners;
    for (uint32_t i = 0; i < mesh.patchCount(); ++i) {
        std::vector<std::array<double, 3>> corners{{1.0 * mesh.room[i], 0, 0}};
        for (uint32_t c : mesh.patch(i))
            corners.push_back({mesh.vertices[c].x, mesh.vertices[c].y, mesh.vertices[c].z});
        // From the least corner on: the way round stays.
        std::rotate(corners.begin() + 1, std::min_element(corners.begin() + 1, corners.end()), corners.end());
        byCorners[std::move(corners)].push_back(i);
    }
    std::vector<std::vector<uint32_t>> groups;
    for (auto& [corners, group] : byCorners)
        if (group.size() > 1 && geometry::patchArea(mesh, group[0]) > 0) groups.push_back(std::move(group));
    std::ranges::sort(groups);
    return groups;
}

void measureFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh, const gpu::Buffer& values,
                        FormFactorReport& report) {
    const size_t n = mesh.patchCount();
    if (n == 0) return;
    std::vector<double> area(n);
    for (size_t i = 0; i < n; ++i) area[i] = geometry::patchArea(mesh, i);
    const double total = std::accumulate(area.begin(), area.end(), 0.0);
    const MatrixSums sums = sumsOfMatrix(device, values, area);
    const MatrixOnHost F(values, n * n);
    measureClosure(sums.rows, report);
    claimExcess(sums.rows, report);
    claimDuplicates(mesh, F, report);
    claimWedges(mesh, F, report);
    claimCrossings(mesh, F, report);
    const double pairs = 0.5 * static_cast<double>(n) * static_cast<double>(n - 1);
    report.reciprocityRms =
        std::sqrt(sums.reciprocitySquares / std::max(pairs, 1.0)) / (total / static_cast<double>(n));
}

std::span<const std::string_view> formFactorKernels() {
    static constexpr std::string_view kNames[]{"exact", "hemicube", "hierarchical", "montecarlo"};
    return kNames;
}

FormFactors computeFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                               const FormFactorOptions& options) {
    const Stopwatch watch;
    KernelChoice choice = chooseKernel(device, mesh, options);
    FormFactors result = options.kernel == "auto" ? factorsOfAuto(device, mesh, options, choice)
                                                  : factorsOf(device, mesh, options, choice);
    double seconds = watch.seconds();
    measure(device, mesh, choice.kernel, result);
    if (options.kernel == "auto" && goOnWhereMissed(device, mesh, options, choice, result))
        seconds = watch.seconds();
    result.report.seconds = seconds;
    explain(result.report, options, choice);
    warnOfLostLight(mesh, result.report);
    return result;
}

FormFactorReport streamFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                                   const FormFactorOptions& options,
                                   const std::function<void(const FormFactorTile&)>& take) {
    const Stopwatch watch;
    KernelChoice choice = chooseKernel(device, mesh, options);
    std::vector<double> sums(mesh.patchCount(), 0.0);
    const TakeTile taken = [&](const FormFactorTile& tile) {
        for (size_t i = 0; i < tile.rows; ++i)
            for (size_t j = 0; j < tile.columns; ++j)
                sums[tile.firstRow + i] += double{tile.values[i * tile.columns + j]};
        take(tile);
    };
    FormFactorReport report;
    try {
        report = tilesOf(device, mesh, options, choice, taken);
    } catch (const TooManyBlockers&) {
        if (options.kernel != "auto") throw;
        leaveToLinks(choice);
        std::ranges::fill(sums, 0.0);
        report = tilesOf(device, mesh, options, choice, taken);
    }
    measureClosure(sums, report);
    claimExcess(sums, report);
    if (choice.kernel == "montecarlo") claimWhatRaysMiss(mesh, report);
    explain(report, options, choice);
    warnOfLostLight(mesh, report);
    report.seconds = watch.seconds();
    return report;
}

} // namespace heliodon::compute
