// Radiosity B = E + K F B of diffuse patches, several columns (colour channels, moments) at once.
// K holds each patch's reflectance; a patch of interior glass also gives on what falls on its twin, times
// transmittance. Solved by restarted GMRES (Saad and Schultz, 1986) about the device's gather: a handful of
// passes over F where plain gathering (Jacobi) takes hundreds at high reflectance, and no need of an exactly
// reciprocal F.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "compute/form_factor_operator.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

// Of the largest value: what float32 sums of a pass over F may add to a residual or take from it, and so
// hide. Values of F B are weighted means of at most that. The partial sums of a row grow to its whole, so
// that the last few additions round most, each by at most eps / 2 of it; the earlier ones, of either sign,
// mostly cancel. Taken as four such additions at their worst: an estimate, since all of n could go one way.
constexpr double kGatherRounding = 2 * double{std::numeric_limits<float>::epsilon()};

struct RadiosityOptions {
    double tolerance = 1e-4;  // wanted bound on the error of B - E, relative to its largest value
    uint32_t maxPasses = 400; // passes over F; fewer where rounding of B keeps the tolerance out of reach
};

struct RadiosityReport {
    uint32_t passes = 0; // with those that found slack()
    // Both of the worst column, over the largest light that patches reflect, max (B - E), beside which a
    // lamp's own may be bright; float32's rounding of B itself apart.
    double residual = 0; // max |E + K F B - B|
    // On max |B - exact| for this F: residual over slack(), and what rounding of the gather may hide.
    double bound = 0;
    // The residual over slack() is within the tolerance; else maxPasses ran out or rounding stood in the way.
    bool converged = true;
};

// How patches give light on, the K of B = E + K F B; constant over a set of materials. Layout of columns:
// [column][patch].
struct RadiosityMatter {
    uint32_t patchCount = 0;
    std::vector<std::vector<float>> reflectance;   // per channel, in [0, 1)
    std::vector<std::vector<float>> transmittance; // per channel, diffuse, of interior glass; 0 elsewhere
    std::vector<int32_t> twin;                     // of interior glass, else geometry::kNoTwin

    // out = K illuminance, in one channel. T: float or double, of the sums too.
    template<class T>
    void reflect(uint32_t channel, std::span<const float> illuminance, std::span<T> out) const {
        const auto &rho = reflectance[channel], &tau = transmittance[channel];
        for (size_t i = 0; i < out.size(); ++i) {
            out[i] = T{rho[i]} * illuminance[i];
            if (tau[i] > 0) out[i] += T{tau[i]} * illuminance[static_cast<size_t>(twin[i])];
        }
    }
};

// Of the mesh's materials: channel 0 alone where one stands for three, else all three.
RadiosityMatter radiosityMatter(const geometry::PatchMesh& mesh, uint32_t channels);

class RadiositySolver {
public:
    // `factors` must outlive this. `rowSums`: of F, for the bound; FormFactorOperator::rowSums gives them.
    RadiositySolver(FormFactorOperator& factors, std::vector<float> rowSums);
    void setMatter(RadiosityMatter matter);
    const RadiosityMatter& matter() const { return matter_; }
    const std::vector<float>& rowSums() const { return rowSums_; }

    // By how much at least a largest error shows in the residual: 1 / ||(I - K F)^-1||, from below. Mostly
    // 1 - max_i sum_j (K F)_ij; where rows that sum to more than one spoil that, by a solution of its own (a
    // dozen passes, once for each matter). 1e-6 where no more can be shown.
    double slack(uint32_t channel);

    // emitted: columns x patches; channel[c] says which reflectance column c sees. On return `gathered` is F
    // B, and `radiosity` is B = E + K `gathered`.
    RadiosityReport solve(std::span<const float> emitted, std::span<const uint32_t> channel,
                          std::vector<float>& radiosity, std::vector<float>& gathered,
                          const RadiosityOptions& options = {});

    // The part of it after the first pass: `reflected` = `once` + K F `reflected`, and `gathered` is F of it.
    // `known`: per column, what else is reflected, at its largest, which tolerance and bound may be relative
    // to; `rounding`: by how much `once` may be off.
    RadiosityReport solveReflected(std::span<const float> once, std::span<const uint32_t> channel,
                                   std::span<const double> known, std::span<const double> rounding,
                                   std::vector<float>& reflected, std::vector<float>& gathered,
                                   const RadiosityOptions& options);

    // Where the errors of a solution B = E + K `gathered` lie, per column and patch: at least |B - exact| in
    // `error`, float32's rounding of B itself apart, and of its `gathered` in `ofGathered`. Its residual, as
    // if it were light, is sent round the room, so that dark places have no part in that of bright ones; what
    // lies below 0.01 of the largest residual counts as that much. Some six passes over F; false where
    // nothing can be shown.
    bool findErrors(std::span<const uint32_t> channel, std::span<const float> radiosity,
                    std::span<const float> gathered, std::vector<float>& error,
                    std::vector<float>& ofGathered);

private:
    struct Column;
    // Both add the passes that they take.
    double slack(uint32_t channel, uint32_t& passes);
    double weightedSlack(uint32_t channel, uint32_t& passes);
    // What is wanted of a column: see solveReflected. As it stands, of the residual over the solution.
    struct Goal {
        double slack = 1, known = 0, rounding = 0;
    };
    RadiosityReport solveFor(std::span<const Goal> goals, std::span<const float> light,
                             std::span<const uint32_t> channel, std::vector<float>& solution,
                             std::vector<float>& gathered, const RadiosityOptions& options);

    FormFactorOperator* factors_;
    std::vector<float> rowSums_;
    RadiosityMatter matter_;
    std::vector<double> slack_; // per channel; negative: to be found
};

} // namespace heliodon::compute
