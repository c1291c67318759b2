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
    double tolerance = 1e-4;  // wanted bound on the error of B, relative to the largest B of the column
    uint32_t maxPasses = 400; // passes over F; fewer where rounding of B keeps the tolerance out of reach
};

struct RadiosityReport {
    uint32_t passes = 0; // with those that found slack()
    double residual = 0; // max |E + K F B - B| / max B, worst column
    // On max |B - exact| / max B for this F: residual over slack(), and what rounding of the gather may hide.
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

    // emitted: columns x patches; channel[c] says which reflectance column c sees. On return `radiosity` is B
    // and `gathered` is F B. `radiosity` may hold a first guess (same size) or be empty.
    RadiosityReport solve(std::span<const float> emitted, std::span<const uint32_t> channel,
                          std::vector<float>& radiosity, std::vector<float>& gathered,
                          const RadiosityOptions& options = {});

    // Where the errors of a solution lie, per column and patch: at least |B - exact| in `error`, and of its
    // `gathered` in `ofGathered`. Its residual, as if it were light, is sent round the room, so that dark
    // places have no part in that of bright ones; what lies below 0.01 of the largest residual counts as that
    // much. Some six passes over F; false where nothing can be shown.
    bool findErrors(std::span<const float> emitted, std::span<const uint32_t> channel,
                    std::span<const float> radiosity, std::span<const float> gathered,
                    std::vector<float>& error, std::vector<float>& ofGathered);

private:
    struct Column;
    // Both add the passes that they take.
    double slack(uint32_t channel, uint32_t& passes);
    double weightedSlack(uint32_t channel, uint32_t& passes);
    // slack: of each column.
    RadiosityReport solveWith(std::span<const double> slack, std::span<const float> emitted,
                              std::span<const uint32_t> channel, std::vector<float>& radiosity,
                              std::vector<float>& gathered, const RadiosityOptions& options);

    FormFactorOperator* factors_;
    std::vector<float> rowSums_;
    RadiosityMatter matter_;
    std::vector<double> slack_; // per channel; negative: to be found
};

} // namespace heliodon::compute
