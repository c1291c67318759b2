#include "compute/exact_tolerances.h"

#include <algorithm>
#include <cmath>

namespace heliodon::compute {

namespace {

constexpr double kFewestPerRow = 8; // of fewer pairs each is held to about the row's error

// Estimates of partly hidden pairs lie above their errors, the more so the finer the mesh (measured in twelve
// rooms of 500 to 2088 patches).
double pairCaution(double rowError, uint32_t pieces) {
    return 2.2 * std::clamp(std::pow(rowError / 1e-4, 0.2), 0.5, 1.0) *
           std::clamp(std::pow(pieces / 500.0, 0.2), 1.0, 1.4);
}

} // namespace

// The finer the mesh and the looser the tolerance, the more entries end far below it (calibrated on rooms of
// 672 and 2088 patches with partitions: measured errors stay below what is asked).
float exactEntryTolerance(double rowError, uint32_t pieces) {
    const double share = std::clamp(0.02 * std::sqrt(static_cast<double>(pieces)), 0.2, 1.0) *
                         std::clamp(std::pow(rowError / 1e-4, 0.3), 0.2, 1.0);
    return static_cast<float>(std::max(rowError * share, 1e-7)); // below lies the rounding of float32
}

float exactPairTolerance(double rowError, uint32_t pieces, double perRow) {
    return static_cast<float>(pairCaution(rowError, pieces) * rowError /
                              std::sqrt(std::max(perRow, kFewestPerRow)));
}

} // namespace heliodon::compute
