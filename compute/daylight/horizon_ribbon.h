// Skies with a ribbon of light at the horizon: Perez's gradation 1 + a exp(b / max(z, zFloor)) with a, b > 0,
// as its fit has under a low sun in bright diffuse light. Below zFloor such a sky is up to 1e10 times as
// bright as at the zenith, and above it falls by 1/e within zFloor^2 / b. With a near -1 and b just below 0
// it falls as 1 / z. It is taken apart into a sky that is even near the horizon, which cells of a few degrees
// resolve, and the ribbon, what is brighter than that, whose integral over heights is known.
#pragma once

#include <array>
#include <vector>

#include "compute/daylight/sky.h"

namespace heliodon::daylight {

// Height z above which there is no ribbon, the sine of 14.5 degrees: from there on the gradation takes
// z^2 / b, a cell of sky or more, to fall by 1/e.
inline constexpr double kRibbonTop = 0.25;

// Whether the gradation falls by over this factor within 6 degrees, the height of sky elements, and the sky
// shines at all. Cells of sky are good for less: 0.7 % at the worst sensor, with 1.6.
inline constexpr double kRibbonContrast = 1.8;
bool hasHorizonRibbon(const SkyFormula& formula);

// The sky without its ribbon: below kRibbonTop as bright as there.
Sky withoutRibbon(const Sky& sky);

// Heights z, from low to high, between which, and above which, it is smooth enough for a Gauss rule.
inline std::array<double, 4> horizonRibbonCuts(const SkyFormula& f) {
    return {f.zFloor, 1.1 * f.zFloor, 1.5 * f.zFloor, 4 * f.zFloor};
}

// What the gradation of a sky has that withoutRibbon's does not; times scale and indicatrix it is the
// ribbon's luminance.
class HorizonRibbon {
public:
    explicit HorizonRibbon(const SkyFormula& formula); // one that hasHorizonRibbon; about 5 us

    double gradation(double z) const;
    struct Integral {
        double light = 0;  // of the gradation over z
        double moment = 0; // of the gradation times z
    };
    // From one height to another, each 0 to 1, to about 1e-7. About 100 ns.
    Integral between(double low, double high) const;

private:
    Integral smooth(double low, double high) const; // above the floor, within an e-fold
    size_t knotAbove(double z) const;

    SkyFormula formula_;
    double atTop_;                    // a exp(b / z) at kRibbonTop
    double step_ = 0;                 // of 1 / z, from knot to knot
    std::vector<double> knots_;       // from the floor to the top
    std::vector<Integral> fromKnots_; // from each to the top
};

} // namespace heliodon::daylight
