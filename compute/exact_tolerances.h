// What kernel `exact` may err in one form factor, so that a row's errors, which add up as squares, stay below
// what is asked. Calibrated on rooms with partitions.
#pragma once

#include <cstdint>

namespace heliodon::compute {

// Of one entry of a scene of so many pieces.
float exactEntryTolerance(double rowError, uint32_t pieces);

// Of one of `perRow` pairs that err: each may have its share.
float exactPairTolerance(double rowError, uint32_t pieces, double perRow);

} // namespace heliodon::compute
