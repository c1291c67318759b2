#include "compute/radiosity.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <glm/common.hpp>

#include "compute/daylight/glazing.h"
#include "compute/largest.h"

namespace heliodon::compute {

namespace {

constexpr size_t kBasis = 24; // Krylov vectors before a restart
// Residual over B that may be all rounding: of the gather, and of B to float32, eps / 2 as such and at most
// as much again through K F.
constexpr double kRounding = kGatherRounding + double{std::numeric_limits<float>::epsilon()};
constexpr double kLeastSlack = 1e-6;
constexpr double kSpoilt = 0.5; // of the slack that reflectances leave, below which rows are to blame
constexpr double kToFind = -1;

double dot(std::span<const double> a, std::span<const double> b) {
    double parts[4]{};
    size_t i = 0;
    for (; i + 4 <= a.size(); i += 4)
        for (size_t k = 0; k < 4; ++k) parts[k] += a[i + k] * b[i + k];
    for (; i < a.size(); ++i) parts[0] += a[i] * b[i];
    return (parts[0] + parts[1]) + (parts[2] + parts[3]);
}

} // namespace

// One column's Krylov space: orthonormal basis, Hessenberg matrix made triangular by Givens rotations as it
// grows.
struct RadiositySolver::Column {
    std::vector<double> solution, residual;
    std::vector<std::vector<double>> basis, hessenberg; // hessenberg[k]: column k, rotated
    std::vector<double> cosines, sines, right;          // right: rotated right-hand side
    double scale = 0, target = 0;                       // largest B; residual to reach (max norm)
    bool done = false;
    double before = 0; // relative residual at the last restart
    uint32_t idle = 0; // restarts in a row that gained nothing

    // A bound that rounding keeps out of reach is not waited for.
    bool hasEnded() const { return done || idle >= 2; }
    void setResidual(double relative, double allowed) {
        done = relative <= allowed;
        idle = relative < kRounding && relative > 0.5 * before && before > 0 ? idle + 1 : 0;
        before = relative;
    }

    void begin() {
        basis.clear(), hessenberg.clear(), cosines.clear(), sines.clear();
        const double norm = std::sqrt(dot(residual, residual));
        right.assign(1, norm);
        basis.push_back(residual);
        if (norm > 0)
            for (double& x : basis[0]) x /= norm;
    }

    // w = A v_k arrives; returns the residual's 2-norm estimate.
    double extend(std::vector<double> w) {
        std::vector<double> h(basis.size() + 1);
        for (int pass = 0; pass < 2; ++pass) // twice is enough (Kahan, Parlett)
            for (size_t k = 0; k < basis.size(); ++k) {
                const double along = dot(basis[k], w);
                h[k] += along;
                for (size_t i = 0; i < w.size(); ++i) w[i] -= along * basis[k][i];
            }
        const double norm = std::sqrt(dot(w, w));
        h.back() = norm;
        if (norm > 0)
            for (double& x : w) x /= norm;
        basis.push_back(std::move(w));
        for (size_t k = 0; k < cosines.size(); ++k) {
            const double a = h[k], b = h[k + 1];
            h[k] = cosines[k] * a + sines[k] * b;
            h[k + 1] = -sines[k] * a + cosines[k] * b;
        }
        const size_t k = cosines.size();
        const double length = std::hypot(h[k], h[k + 1]);
        cosines.push_back(length > 0 ? h[k] / length : 1);
        sines.push_back(length > 0 ? h[k + 1] / length : 0);
        h[k] = length;
        right.push_back(-sines[k] * right[k]);
        right[k] *= cosines[k];
        hessenberg.push_back(std::move(h));
        return std::abs(right.back());
    }

    void finish() {
        std::vector<double> y(hessenberg.size());
        for (size_t k = y.size(); k-- > 0;) {
            double sum = right[k];
            for (size_t j = k + 1; j < y.size(); ++j) sum -= hessenberg[j][k] * y[j];
            y[k] = hessenberg[k][k] != 0 ? sum / hessenberg[k][k] : 0;
            for (size_t i = 0; i < solution.size(); ++i) solution[i] += y[k] * basis[k][i];
        }
    }
};

RadiosityMatter radiosityMatter(const geometry::PatchMesh& mesh, uint32_t channels) {
    const size_t n = mesh.patchCount();
    RadiosityMatter matter;
    matter.patchCount = static_cast<uint32_t>(n);
    matter.twin = mesh.twin;
    std::vector<glm::vec3> through; // diffusely, by material
    for (const geometry::Material& m : mesh.materials)
        through.push_back(
            glm::min(glm::vec3(daylight::glazingOf(m).diffuseTransmittance()), 1.0f - m.reflectance));
    for (int c = 0; c < static_cast<int>(channels); ++c) {
        std::vector<float> rho(n), tau(n);
        for (size_t i = 0; i < n; ++i) {
            rho[i] = mesh.materials[mesh.material[i]].reflectance[c];
            if (mesh.twin[i] != geometry::kNoTwin) tau[i] = through[mesh.material[i]][c];
        }
        matter.reflectance.push_back(std::move(rho));
        matter.transmittance.push_back(std::move(tau));
    }
    return matter;
}

RadiositySolver::RadiositySolver(FormFactorOperator& factors, std::vector<float> rowSums)
    : factors_(&factors), rowSums_(std::move(rowSums)) {}

void RadiositySolver::setMatter(RadiosityMatter matter) {
    matter_ = std::move(matter);
    slack_.clear();
    std::vector<double> handedOn(matter_.patchCount), ofUnit(matter_.patchCount);
    const std::vector<float> ones(matter_.patchCount, 1.0f);
    for (uint32_t channel = 0; channel < matter_.reflectance.size(); ++channel) {
        matter_.reflect<double>(channel, rowSums_, handedOn);
        matter_.reflect<double>(channel, ones, ofUnit);
        const double slack = 1 - largest(handedOn), without = 1 - largest(ofUnit);
        slack_.push_back(slack < kSpoilt * without ? kToFind : std::max(slack, kLeastSlack));
    }
}

double RadiositySolver::slack(uint32_t channel) {
    uint32_t passes = 0;
    return slack(channel, passes);
}

double RadiositySolver::slack(uint32_t channel, uint32_t& passes) {
    if (slack_[channel] < 0) slack_[channel] = weightedSlack(channel, passes);
    return slack_[channel];
}

// With any w > 0 and d_i = ((I - K F) w)_i > 0, an error e of residual r keeps |e_i| <= w_i max_k |r_k| /
// d_k, since K F has no negative entries (R. Varga, "Matrix Iterative Analysis", 1962, on M-matrices). So w
// is a rough solution for light of one from every patch.
double RadiositySolver::weightedSlack(uint32_t channel, uint32_t& passes) {
    const size_t n = matter_.patchCount;
    const std::vector<float> ones(n, 1.0f);
    std::vector<double> given(n);
    matter_.reflect<double>(channel, ones, given);
    RadiosityOptions rough;
    rough.tolerance = 0.2 * std::max(1 - largest(given), 1e-4); // w is about the inverse of that
    rough.maxPasses = 3 * kBasis;
    const Goal ofResidual; // what tolerance is of here
    std::vector<float> w, gathered;
    passes += solveFor(std::span(&ofResidual, 1), ones, std::span(&channel, 1), w, gathered, rough).passes;
    matter_.reflect<double>(channel, gathered, given);
    double most = 0, least = INFINITY;
    for (size_t i = 0; i < n; ++i) {
        most = std::max(most, double{w[i]});
        least = w[i] > 0 ? std::min(least, w[i] - given[i]) : 0.0;
        if (!(least > 0)) break;
    }
    return std::max((least - kGatherRounding * most) / std::max(most, 1e-30), kLeastSlack);
}

// As above, with w for the light r of the residual itself: |e_i| <= w_i max_k r_k / d_k, a little over w_i.
bool RadiositySolver::findErrors(std::span<const uint32_t> channel, std::span<const float> radiosity,
                                 std::span<const float> gathered, std::vector<float>& error,
                                 std::vector<float>& ofGathered) {
    constexpr double kLeast = 0.01, kOfLeast = 0.3; // of the largest residual; how exact w is, of that
    const size_t n = matter_.patchCount;
    std::vector<float> light(radiosity.size());
    std::vector<double> reflected(n), given(n);
    RadiosityOptions rough;
    rough.tolerance = kLeast * kOfLeast;
    rough.maxPasses = 3 * kBasis;
    std::vector<float> measured(radiosity.size());
    factors_->gatherIn(channel, radiosity, measured);
    for (size_t c = 0; c < channel.size(); ++c) {
        float* residual = &light[c * n];
        // Of E + K gathered, since E itself has no error, however much float32 rounds where it is bright.
        matter_.reflect<double>(channel[c], {&gathered[c * n], n}, reflected);
        matter_.reflect<double>(channel[c], {&measured[c * n], n}, given);
        for (size_t i = 0; i < n; ++i)
            residual[i] = static_cast<float>(std::abs(given[i] - reflected[i]) + kGatherRounding * given[i]);
        const float most = *std::max_element(residual, residual + n);
        for (size_t i = 0; i < n; ++i)
            residual[i] = std::max(residual[i], std::max(static_cast<float>(kLeast) * most, 1e-30F));
        uint32_t passes = 0;
        rough.tolerance = std::min(rough.tolerance, kLeast * kOfLeast * slack(channel[c], passes));
    }
    const std::vector<Goal> ofResidual(channel.size()); // what tolerance is of here
    solveFor(ofResidual, light, channel, error, ofGathered, rough);
    for (size_t c = 0; c < channel.size(); ++c) {
        matter_.reflect<double>(channel[c], {&ofGathered[c * n], n}, given);
        double times = 0;
        for (size_t i = 0; i < n; ++i) {
            const double d = error[c * n + i] - (1 + kGatherRounding) * given[i];
            if (!(d > 0)) return false;
            times = std::max(times, light[c * n + i] / d);
        }
        for (size_t i = c * n; i < (c + 1) * n; ++i) {
            error[i] *= static_cast<float>(times);
            ofGathered[i] = ofGathered[i] * static_cast<float>(times) + std::abs(measured[i] - gathered[i]);
        }
    }
    return true;
}

RadiosityReport RadiositySolver::solve(std::span<const float> emitted, std::span<const uint32_t> channel,
                                       std::vector<float>& radiosity, std::vector<float>& gathered,
                                       const RadiosityOptions& options) {
    const size_t n = matter_.patchCount, count = channel.size();
    assert(emitted.size() == n * count);
    std::vector<float> direct(n * count), once(n * count);
    factors_->gatherIn(channel, emitted, direct);
    std::vector<double> known(count), rounding(count);
    for (size_t c = 0; c < count; ++c) {
        matter_.reflect<float>(channel[c], {&direct[c * n], n}, {&once[c * n], n});
        known[c] = largest(std::span<const float>(&once[c * n], n));
        rounding[c] = kRounding * known[c];
    }
    RadiosityReport report = solveReflected(once, channel, known, rounding, radiosity, gathered, options);
    ++report.passes;
    for (size_t k = 0; k < n * count; ++k) gathered[k] += direct[k];
    for (size_t c = 0; c < count; ++c) {
        matter_.reflect<float>(channel[c], {&gathered[c * n], n}, {&radiosity[c * n], n});
        for (size_t i = c * n; i < (c + 1) * n; ++i) radiosity[i] += emitted[i];
    }
    return report;
}

RadiosityReport RadiositySolver::solveReflected(std::span<const float> once,
                                                std::span<const uint32_t> channel,
                                                std::span<const double> known,
                                                std::span<const double> rounding,
                                                std::vector<float>& reflected, std::vector<float>& gathered,
                                                const RadiosityOptions& options) {
    std::vector<Goal> goals;
    uint32_t passes = 0;
    for (size_t c = 0; c < channel.size(); ++c)
        goals.push_back({slack(channel[c], passes), known[c], rounding[c]});
    RadiosityReport report = solveFor(goals, once, channel, reflected, gathered, options);
    report.passes += passes;
    return report;
}

RadiosityReport RadiositySolver::solveFor(std::span<const Goal> goals, std::span<const float> light,
                                          std::span<const uint32_t> channel, std::vector<float>& solution,
                                          std::vector<float>& gathered, const RadiosityOptions& options) {
    const size_t n = matter_.patchCount, count = channel.size();
    assert(light.size() == n * count);
    RadiosityReport report;
    solution.assign(light.begin(), light.end());
    gathered.assign(n * count, 0);
    std::vector<Column> columns(count);
    std::vector<double> given(n);
    for (size_t c = 0; c < count; ++c) columns[c].solution.assign(&solution[c * n], &solution[c * n] + n);

    for (;;) {
        // The true residual, of the solution as it will be handed out.
        for (size_t c = 0; c < count; ++c)
            std::transform(columns[c].solution.begin(), columns[c].solution.end(), &solution[c * n],
                           [](double x) { return static_cast<float>(x); });
        factors_->gatherIn(channel, solution, gathered);
        ++report.passes;
        report.residual = report.bound = 0;
        for (size_t c = 0; c < count; ++c) {
            Column& column = columns[c];
            matter_.reflect<double>(channel[c], {&gathered[c * n], n}, given);
            column.residual.resize(n);
            for (size_t i = 0; i < n; ++i)
                column.residual[i] = light[c * n + i] + given[i] - solution[c * n + i];
            column.scale = std::max({largest(column.solution), goals[c].known, 1e-30});
            const double room = goals[c].slack;
            const double residual = largest(column.residual) / column.scale;
            column.target = options.tolerance * room * column.scale;
            column.setResidual(residual, options.tolerance * room);
            report.residual = std::max(report.residual, residual);
            const double rounding = kGatherRounding * largest(given) + goals[c].rounding;
            report.bound = std::max(report.bound, (residual + rounding / column.scale) / room);
        }
        report.converged = std::ranges::all_of(columns, &Column::done);
        if (std::ranges::all_of(columns, &Column::hasEnded) || report.passes >= options.maxPasses)
            return report;

        for (Column& column : columns) column.begin();
        std::vector<float> in(n * count), out(n * count);
        bool growing = true;
        for (size_t k = 0; k < kBasis && growing && report.passes < options.maxPasses; ++k) {
            for (size_t c = 0; c < count; ++c)
                std::transform(columns[c].basis[k].begin(), columns[c].basis[k].end(), &in[c * n],
                               [](double x) { return static_cast<float>(x); });
            factors_->gatherIn(channel, in, out);
            ++report.passes;
            growing = false;
            for (size_t c = 0; c < count; ++c) {
                matter_.reflect<double>(channel[c], {&out[c * n], n}, given);
                std::vector<double> w(n);
                for (size_t i = 0; i < n; ++i) w[i] = columns[c].basis[k][i] - given[i];
                // A 2-norm spread over n patches; the true residual decides above, whatever is guessed here.
                growing |= columns[c].extend(std::move(w)) >
                               columns[c].target * 0.1 * std::sqrt(static_cast<double>(n)) &&
                           !columns[c].hasEnded();
            }
        }
        for (Column& column : columns)
            if (!column.hasEnded()) column.finish();
    }
}

} // namespace heliodon::compute
