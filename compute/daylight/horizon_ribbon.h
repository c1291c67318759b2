// Perez's gradation 1 + a exp(b / max(z, zFloor)) with a, b > 0, as its fit has under a low sun in bright
// diffuse light: below zFloor the sky is up to 1e10 times as bright as at the zenith, and above it falls by
// 1/e within zFloor^2 / b.
#pragma once

#include <algorithm>
#include <array>

#include <glm/geometric.hpp>

#include "compute/daylight/quadrature.h"
#include "compute/daylight/sky.h"

namespace heliodon::daylight {

inline bool hasHorizonRibbon(const SkyFormula& f) {
    return !f.intermediate && f.a > 0 && f.b > 0;
}

// Heights z, from low to high, between which it is smooth enough for a Gauss rule, and above which there is
// none.
inline std::array<double, 4> horizonRibbonCuts(const SkyFormula& f) {
    return {f.zFloor, 1.1 * f.zFloor, 1.5 * f.zFloor, 4 * f.zFloor};
}

// Where cells of sky are cut that a sum has one luminance for, as of a sky at a sensor: heights. Below the
// first the ribbon is even, between others it counts by its mean, above the last (the sine of 2 degrees) it
// is smooth.
inline constexpr std::array<double, 3> kSkyCellCuts{0.01, 0.013, 0.03489949670250097};

// The sky's luminance over cells that are cut at kSkyCellCuts, by their middles.
class CellSky {
public:
    explicit CellSky(const Sky& sky) : sky_(&sky) {
        if (!hasHorizonRibbon(sky.formula)) return;
        for (size_t k = 0; k < means_.size(); ++k) {
            const double low = kSkyCellCuts[k], height = kSkyCellCuts[k + 1] - low;
            for (const auto& [x, weight] : kGauss24)
                means_[k] += weight * daylight::gradation(sky.formula, low + height * x);
        }
    }

    double gradation(double z) const {
        if (means_[0] > 0 && z > kSkyCellCuts[0] && z < kSkyCellCuts[2])
            return means_[z < kSkyCellCuts[1] ? 0 : 1];
        return daylight::gradation(sky_->formula, z);
    }
    // cd/m2 of a unit direction.
    double luminance(glm::dvec3 direction) const {
        if (means_[0] <= 0 || direction.y <= 0) return sky_->luminance(direction);
        const double around = indicatrix(sky_->formula, glm::dot(direction, sky_->shapeDirection));
        return sky_->formula.scale * std::max(0.0, gradation(direction.y) * around);
    }

private:
    const Sky* sky_;
    std::array<double, 2> means_{}; // 0: no ribbon
};

} // namespace heliodon::daylight
