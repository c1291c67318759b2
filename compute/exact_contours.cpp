#include "compute/exact_contours.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "compute/contour_exchange.h"
#include "compute/parallel.h"
#include "geometry/outline_area.h"

namespace heliodon::compute {

namespace {

// Over the larger one's size: where less lies between two pieces, each needs as many cells as its square.
constexpr double kFlat = 1.0 / 16;

double highestOver(const RadiatingPiece& plane, const RadiatingPiece& piece) {
    double highest = 0;
    for (const glm::dvec3& p : piece.corners)
        highest = std::max(highest, glm::dot(plane.normal, p - plane.corners[0]));
    return highest;
}

bool byContour(const RadiatingPiece& a, const RadiatingPiece& b) {
    const double flat = kFlat * std::max(a.size, b.size);
    return glm::distance(a.corners[0], b.corners[0]) <= a.size + b.size + flat &&
           std::min(highestOver(a, b), highestOver(b, a)) < flat;
}

glm::uvec4 sumOf(double factor) {
    const double units = factor * io::kExactOne, whole = std::floor(units);
    return {whole, (units - whole) * io::kExactFraction, 0, 0};
}

} // namespace

std::vector<glm::uvec4> sumsByContours(const ExactScene& scene, std::vector<io::ExactRecord>& records) {
    const auto chosen = std::stable_partition(records.begin(), records.end(), [&](const io::ExactRecord& r) {
        return r.listed > 0 || !byContour(scene.pieces[r.outer], scene.pieces[r.inner]);
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
