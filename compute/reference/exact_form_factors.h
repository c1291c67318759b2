// The oracle of the form-factor kernels: serial, double precision, no code shared with the device. Exchange
// areas A_i F_ij between planar convex polygons, which radiate on their front (counter-clockwise) side.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/patch_mesh.h"

namespace heliodon::compute::reference {

using Polygon = std::vector<glm::dvec3>;

struct Estimate {
    double value = 0;
    double error = 0; // the method's own estimate, not a bound
};

// The part on the side to which `normal` points of the plane through `onPlane`; empty when it has no area.
Polygon clipped(std::span<const glm::dvec3> polygon, const glm::dvec3& onPlane, const glm::dvec3& normal);
// Whether that leaves anything.
bool reachesAbove(std::span<const glm::dvec3> polygon, const glm::dvec3& onPlane, const glm::dvec3& normal);

// Lambert 1760: form factor from a surface element (unit normal) to the part of the polygon above its
// horizon; 0 when the element is not in front of the polygon. Absolute error about 1e-15.
double pointToPolygon(const glm::dvec3& point, const glm::dvec3& normal, std::span<const glm::dvec3> polygon);

// The same to what remains of the polygon behind convex blockers, opaque from both sides: the cone of shadow
// of each is cut away. Blockers in whose plane the point lies do not block.
double visiblePointToPolygon(const glm::dvec3& point, const glm::dvec3& normal,
                             std::span<const glm::dvec3> polygon, std::span<const Polygon> blockers);

// A_i F_ij with nothing between. Each polygon is cut by the other's plane; then the double contour integral
// where they are near, cubature of Lambert's formula over the smaller one where they are apart.
double exchangeUnoccluded(const Polygon& from, const Polygon& to);

// A_i F_ij behind blockers: adaptive cubature over the one farther from the blockers. Stops when the
// estimated error of F_ij is below `tolerance` or after `maxCells` cells.
Estimate exchangeOccluded(const Polygon& from, const Polygon& to, std::span<const Polygon> blockers,
                          double tolerance = 1e-8, size_t maxCells = 20000);

double polygonArea(std::span<const glm::dvec3> polygon);

// A_i F_ij of two patches of a mesh; every patch of the same room blocks.
Estimate exchangeIn(const geometry::PatchMesh& mesh, size_t i, size_t j, double tolerance = 1e-8,
                    size_t maxCells = 20000);

// All F_ij of a small mesh, row-major. Cost about n^2 (1 + n) cells:
// for a few dozen patches.
std::vector<double> exactFormFactors(const geometry::PatchMesh& mesh, double tolerance = 1e-8,
                                     size_t maxCells = 20000);

} // namespace heliodon::compute::reference
