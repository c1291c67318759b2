#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "compute/form_factors.h"
#include "compute/kernel_choice.h"
#include "engine/app/commands.h"
#include "engine/app/first_few.h"
#include "engine/app/light_report.h"
#include "engine/app/progress.h"
#include "engine/app/scene_input.h"
#include "engine/app/table_file.h"
#include "geometry/input_error.h"

namespace heliodon::app {

namespace {

constexpr size_t kLargestDense = 16000; // patches, 1 GB; larger matrices go to the file as they are made
constexpr size_t kTilesPay =
    4000; // from which `exact`, which makes tiles, gains by that: no page is made twice

// Faces in one place that face one way: the rows of a closed room with such faces sum to more than one.
void warnOfDoubles(Run& run, const geometry::PatchMesh& mesh) {
    std::vector<std::string> pairs;
    for (const std::vector<uint32_t>& group : compute::patchesInOnePlace(mesh))
        for (size_t k = 1; k < group.size(); ++k)
            pairs.push_back(fmt::format("{} and {}", group[0], group[k]));
    if (pairs.empty()) return;
    run.warn(fmt::format("{} face{} the place of another and face{} the same way (faces {}, counted from 0): "
                         "exact, hemicube and hierarchical count both whole, montecarlo one of them",
                         pairs.size(), pairs.size() == 1 ? " takes" : "s take", pairs.size() == 1 ? "s" : "",
                         firstFew(pairs, 3)));
}

geometry::PatchMesh loadPatches(Run& run, const SceneArguments& arguments) {
    const std::string extension = arguments.input.extension().string();
    const bool facesAsTheyAre = extension == ".obj" && !arguments.triangles;
    if (facesAsTheyAre && arguments.chordError)
        throw geometry::InputError("--chord-error", "",
                                   "is for curved walls on the table, a model's faces are flat");
    if (!facesAsTheyAre) return loadScene(run, arguments).mesh;
    const StageTimer timer(run, "read");
    geometry::PatchMesh mesh = geometry::readPatches(arguments.input, upAxisOf(arguments), materialsOf(arguments));
    warnOfDoubles(run, mesh);
    return mesh;
}

nlohmann::json errorAgainst(std::span<const float> reference, std::span<const float> values, size_t n) {
    double sum = 0, worstRow = 0, worstEntry = 0;
    for (size_t i = 0; i < n; ++i) {
        double row = 0;
        for (size_t j = 0; j < n; ++j) {
            const double d =
                static_cast<double>(values[i * n + j]) - static_cast<double>(reference[i * n + j]);
            row += d * d;
            worstEntry = std::max(worstEntry, std::abs(d));
        }
        sum += row;
        worstRow = std::max(worstRow, std::sqrt(row));
    }
    return {{"row_l2_rms", std::sqrt(sum / static_cast<double>(n))},
            {"row_l2_max", worstRow},
            {"entry_rms", std::sqrt(sum) / static_cast<double>(n)},
            {"entry_max", worstEntry}};
}

// Settings of kernels that are not at work.
void warnOfIdle(Run& run, const FormFactorArguments& arguments) {
    const bool hemicube = arguments.kernel == "hemicube", rays = arguments.kernel == "montecarlo";
    if (arguments.resolution && !hemicube && !rays)
        run.warn("--resolution is not used: it is for --kernel hemicube or montecarlo");
    if (arguments.points && !hemicube) run.warn("--points is not used: it is for --kernel hemicube");
}

// Claims are cautious; where they lie above what was asked for without a warning, users are told all the
// same.
void noteClaim(Run& run, const compute::FormFactorReport& report, double asked) {
    if (asked > 0 && report.claimedRowError > asked && report.warnings.empty())
        run.note(
            fmt::format("form factors: rows within {:.1e} by kernel {}'s own, cautious estimate; {:.1e} was "
                        "asked for",
                        report.claimedRowError, report.kernel, asked));
}

// Straight to the file, tile by tile.
compute::FormFactorReport stream(Run& run, const geometry::PatchMesh& mesh,
                                 const compute::FormFactorOptions& options, NpyWriter& out) {
    const StageTimer timer(run, "formfactors");
    gpu::Device& device = run.device();
    const size_t n = mesh.patchCount();
    // From the first tile on: links are all made before it, in a time of their own.
    std::optional<Progress> progress;
    size_t entries = 0, before = 0;
    return compute::streamFormFactors(device, mesh, options, [&](const compute::FormFactorTile& tile) {
        out.put(tile.firstRow, tile.rows, tile.firstColumn, tile.columns, tile.values);
        entries = std::min(entries + tile.values.size(), n * n); // some may come again
        if (!progress) {
            before = entries;
            progress.emplace("formfactors", n, run.showsProgress());
        }
        const double left =
            static_cast<double>(n * n - entries) / static_cast<double>(std::max<size_t>(n * n - before, 1));
        progress->advance(entries / n, 1 - left);
    });
}

// Faces in one place are told from columns of the whole matrix.
bool goesByTiles(gpu::Device& device, const geometry::PatchMesh& mesh,
                 const compute::FormFactorOptions& options, bool compared) {
    const size_t n = mesh.patchCount();
    if (n > kLargestDense) return true;
    return n > kTilesPay && !compared && compute::chooseKernel(device, mesh, options).kernel == "exact" &&
           compute::patchesInOnePlace(mesh).empty();
}

} // namespace

void execute(Run& run, const FormFactorArguments& arguments) {
    const geometry::PatchMesh mesh = loadPatches(run, arguments.scene);
    gpu::Device& device = run.device();
    compute::FormFactorOptions options;
    options.kernel = arguments.kernel;
    options.resolution = arguments.resolution.value_or(options.resolution);
    options.points = arguments.points.value_or(options.points);
    warnOfIdle(run, arguments);
    options.maxError = arguments.maxError;
    options.maxRadiosityError = arguments.maxRadiosityError;
    // Measured behind crowds: ten times the error takes a fifth to a sixteenth of the time.
    options.longWork = noteOfLongWork(run, "ten times the --max-error would take a fifth of it or less");
    const size_t n = mesh.patchCount();
    if (n > kLargestDense && !arguments.reference.empty())
        throw geometry::InputError("--reference", "",
                                   fmt::format("is for at most {} patches", kLargestDense));
    std::vector<float> reference; // a wrong one should not cost the form factors
    if (!arguments.reference.empty()) reference = readMatrix(arguments.reference, n, n);
    NpyWriter::writeWhole(arguments.output, n, n, [&](NpyWriter& out) {
        if (goesByTiles(device, mesh, options, !reference.empty())) {
            const compute::FormFactorReport report = stream(run, mesh, options, out);
            reportFormFactors(run, n, report);
            noteClaim(run, report, options.maxError);
            return;
        }
        const compute::FormFactors factors = [&] {
            const StageTimer timer(run, "formfactors");
            Progress progress("formfactors", n, run.showsProgress());
            options.progress = [&](double share) {
                progress.advance(static_cast<size_t>(share * static_cast<double>(n)), share);
            };
            return compute::computeFormFactors(device, mesh, options);
        }();
        const gpu::HostView<float> view(factors.values, n * n);
        const std::span<const float> values(view.data(), n * n);
        reportFormFactors(run, n, factors.report);
        noteClaim(run, factors.report, options.maxError);
        if (!reference.empty()) run.report()["error"] = errorAgainst(reference, values, n);
        out.write(values);
    });
}

} // namespace heliodon::app
