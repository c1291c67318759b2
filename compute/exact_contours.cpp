#include "compute/exact_contours.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "compute/contour_exchange.h"
#include "compute/parallel.h"
#include "geometry/outline_area.h"

namespace heliodon::compute {

namespace {

// Of the larger one's size: where less lies between two pieces, cells are as many as its inverse square.
constexpr double kFlat = 1.0 / 16;
constexpr double kRounding =
    1e-6; // of such a share what directions err by, 1e-7, is a tenth of the tolerance
// What lies this far apart does not touch, and needs cells as small as the gap.
constexpr double kTouch = 1e-10, kNearly = 1e-3;

double highestOver(const RadiatingPiece& plane, const RadiatingPiece& piece) {
    double highest = 0;
    for (const glm::dvec3& p : piece.corners)
        highest = std::max(highest, glm::dot(plane.normal, p - plane.corners[0]));
    return highest;
}

bool isNarrow(const RadiatingPiece& piece) {
    return glm::length(geometry::areaVector(piece.corners)) < kFlat * piece.size * piece.size;
}

double distanceToEdge(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 edge = b - a;
    const double t =
        glm::dot(p - a, edge) / std::max(glm::dot(edge, edge), std::numeric_limits<double>::min());
    return glm::distance(p, a + std::clamp(t, 0.0, 1.0) * edge);
}

double leastDistance(const RadiatingPiece& corners, const RadiatingPiece& edges) {
    double least = std::numeric_limits<double>::infinity();
    for (const glm::dvec3& p : corners.corners)
        for (size_t k = 0; k < edges.corners.size(); ++k)
            least = std::min(
                least, distanceToEdge(p, edges.corners[k], edges.corners[(k + 1) % edges.corners.size()]));
    return least;
}

bool byContour(const RadiatingPiece& a, const RadiatingPiece& b, double tolerance) {
    const double size = std::max(a.size, b.size), flat = std::min(kFlat, kRounding / tolerance) * size;
    if (glm::distance(a.corners[0], b.corners[0]) > a.size + b.size + flat) return false;
    if (std::min(highestOver(a, b), highestOver(b, a)) < flat) return true;
    const double apart = std::min(leastDistance(a, b), leastDistance(b, a));
    return (isNarrow(a) && isNarrow(b) && apart < flat) || (apart > kTouch * size && apart < kNearly * size);
}

glm::uvec4 sumOf(double factor) {
    const double units = factor * io::kExactOne, whole = std::floor(units);
    return {whole, (units - whole) * io::kExactFraction, 0, 0};
}

} // namespace

std::vector<glm::uvec4> sumsByContours(const ExactScene& scene, std::vector<io::ExactRecord>& records,
                                       double tolerance) {
    const auto chosen = std::stable_partition(records.begin(), records.end(), [&](const io::ExactRecord& r) {
        return r.listed > 0 || !byContour(scene.pieces[r.outer], scene.pieces[r.inner], tolerance);
    });
    std::vector<glm::uvec4> sums(static_cast<size_t>(records.end() - chosen));
    inParallel(sums.size(), [&](size_t k) {
        const RadiatingPiece &outer = scene.pieces[chosen[static_cast<std::ptrdiff_t>(k)].outer],
                             &inner = scene.pieces[chosen[static_cast<std::ptrdiff_t>(k)].inner];
        const double area = 0.5 * glm::length(geometry::areaVector(outer.corners));
        sums[k] = sumOf(contourExchange(outer.corners, inner.corners) / area);
    });
    return sums;
}

} // namespace heliodon::compute
