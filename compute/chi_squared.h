// How far a sum of squares of normal values may lie above its expectation, where few of them make most of it:
// the cube root of chi-squared over its mean is nearly normal, with mean 1 - v and variance v = 2 / (9
// degrees of freedom) (E. B. Wilson, M. M. Hilferty, 1931).
#pragma once

#include <algorithm>
#include <cmath>

namespace heliodon::compute {

// v, of independent values whose variances add up to `sum` > 0 and the squares of these to `squares`; of one
// degree of freedom at least.
inline double chiSquaredSpread(double sum, double squares) {
    return 2.0 / 9 * std::min(1.0, squares / (sum * sum));
}

// The sum over its expectation, `deviations` standard deviations of a normal value up: 2.33 for the 99th
// percentile.
inline double chiSquaredOverMean(double spread, double deviations) {
    return std::pow(1 - spread + deviations * std::sqrt(spread), 3);
}

} // namespace heliodon::compute
