#include "compute/daylight/horizon_ribbon.h"

#include <algorithm>
#include <cmath>

#include "compute/daylight/quadrature.h"

namespace heliodon::daylight {

namespace {
constexpr auto kGauss4 = gaussLegendre<4>();
constexpr double kRow = 0.1, kLeastFloor = 1e-3; // heights
} // namespace

bool hasHorizonRibbon(const SkyFormula& f) {
    // Where a and b differ in sign it is dark at the horizon.
    if (f.intermediate || f.g1 != 0 || f.a * f.b <= 0 || f.scale <= 0 || f.zFloor < kLeastFloor ||
        f.zFloor >= kRow)
        return false;
    return gradation(f, kRibbonTop) > 0 && gradation(f, 0) > kRibbonContrast * gradation(f, kRow);
}

Sky withoutRibbon(const Sky& sky) {
    Sky even = sky;
    if (hasHorizonRibbon(sky.formula)) even.formula.zFloor = kRibbonTop;
    return even;
}

HorizonRibbon::HorizonRibbon(const SkyFormula& formula)
    : formula_(formula), atTop_(formula.a * std::exp(formula.b / kRibbonTop)) {
    const double first = 1 / formula.zFloor, last = 1 / kRibbonTop;
    const auto count = static_cast<size_t>(std::ceil(std::max(16.0, formula.b * (first - last))));
    step_ = (first - last) / static_cast<double>(count);
    for (size_t k = 0; k <= count; ++k) knots_.push_back(1 / (first - step_ * static_cast<double>(k)));
    fromKnots_.resize(knots_.size());
    for (size_t k = count; k-- > 0;) {
        const Integral part = smooth(knots_[k], knots_[k + 1]);
        fromKnots_[k] = {fromKnots_[k + 1].light + part.light, fromKnots_[k + 1].moment + part.moment};
    }
}

double HorizonRibbon::gradation(double z) const {
    if (z >= kRibbonTop) return 0;
    return formula_.a * std::exp(formula_.b / std::max(z, formula_.zFloor)) - atTop_;
}

HorizonRibbon::Integral HorizonRibbon::smooth(double low, double high) const {
    Integral sum;
    for (const auto& [x, weight] : kGauss4) {
        const double z = low + x * (high - low), share = weight * (high - low) * gradation(z);
        sum.light += share, sum.moment += share * z;
    }
    return sum;
}

// The first that is no lower.
size_t HorizonRibbon::knotAbove(double z) const {
    const double at = std::ceil((1 / formula_.zFloor - 1 / z) / step_);
    return static_cast<size_t>(std::clamp(at, 0.0, static_cast<double>(knots_.size() - 1)));
}

HorizonRibbon::Integral HorizonRibbon::between(double low, double high) const {
    low = std::max(low, 0.0), high = std::min(high, kRibbonTop);
    Integral sum;
    if (low >= high) return sum;
    const auto add = [&](Integral part, double sign = 1) {
        sum.light += sign * part.light, sum.moment += sign * part.moment;
    };
    const double floor = formula_.zFloor;
    if (low < floor) {
        const double end = std::min(high, floor), even = gradation(0);
        add({even * (end - low), 0.5 * even * (end * end - low * low)});
        if (high <= floor) return sum;
        low = floor;
    }
    const size_t first = low > floor ? knotAbove(low) : 0;
    if (high >= kRibbonTop) { // as most openings show it: its upper end is a knot
        if (low > floor) add(smooth(low, knots_[first]));
        add(fromKnots_[first]);
        return sum;
    }
    const size_t last = knotAbove(high);
    if (first == last) { // no knot between them
        add(smooth(low, high));
        return sum;
    }
    if (low > floor) add(smooth(low, knots_[first]));
    add(fromKnots_[first]);
    add(fromKnots_[last - 1], -1);
    add(smooth(knots_[last - 1], high));
    return sum;
}

} // namespace heliodon::daylight
