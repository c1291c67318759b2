// The two glasses of an interior window, seen from one another.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "geometry/building.h"

namespace heliodon::geometry {

// Corner k of a loop stands opposite corner (first - k) modulo n of the other glass's loop `loop`.
struct OppositeLoop {
    size_t loop = 0, first = 0;
    size_t corner(size_t k, size_t n) const { return (first + n - k % n) % n; }
};

constexpr double kBackToBack = -0.992; // cosine between the normals of twins: 7 degrees off parallel

// From the middle of the box round one outline to that of the other.
glm::dvec3 shiftBetween(const Building& building, const Face& from, const Face& to);

// Per loop of `face`, where `other` has its mirror image; none when their corners do not correspond within
// `tolerance` (metres). Cost: O(n^2) for n corners.
std::optional<std::vector<OppositeLoop>> oppositeLoops(const Building& building, const Face& face,
                                                       const Face& other, double tolerance);

// Whether all glasses that have a twin are its mirror image and nearly parallel to it.
bool twinsMirror(const Building& building, double tolerance);

} // namespace heliodon::geometry
