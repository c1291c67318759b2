// Perez's gradation 1 + a exp(b / max(z, zFloor)) with a, b > 0, as its fit has under a low sun in bright
// diffuse light: below zFloor the sky is up to 1e10 times as bright as at the zenith, and above it falls by
// 1/e within zFloor^2 / b.
#pragma once

#include <array>

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

} // namespace heliodon::daylight
