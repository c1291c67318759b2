#include "compute/exact_contours.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/geometric.hpp>

#include "compute/contour_exchange.h"
#include "compute/parallel.h"
#include "geometry/outline_area.h"

namespace heliodon::compute {

namespace {

// Of the larger one's size: where less lies between two pieces, cells are as many as its inverse square.
constexpr double kFlat = 1.0 / 16;
// Over the tolerance: across so flat a gap directions, good to 1e-7, err by a tenth of the tolerance.
constexpr double kRounding = 1e-6;
// What lies this far apart does not touch, and needs cells as small as the gap.
constexpr double kTouch = 1e-10, kNearly = 1e-3;
constexpr double kFloatRounding = 1.2e-7; // of a factor, and of its mirror image by both areas
constexpr size_t kShare = 4096;           // records that a core looks at in one go

struct Heights {
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
};

Heights heightsOver(const RadiatingPiece& plane, const RadiatingPiece& piece) {
    Heights heights;
    for (const glm::dvec3& p : piece.corners) {
        const double height = glm::dot(plane.normal, p - plane.corners[0]);
        heights = {std::min(heights.lowest, height), std::max(heights.highest, height)};
    }
    return heights;
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

// Of two edges, and of borders, of which those that cross one another, seen along what is shortest between
// them, are nearest between their ends.
struct Apart {
    double anywhere = std::numeric_limits<double>::infinity(), crossing = anywhere;
};

Apart edgesApart(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
    const glm::dvec3 u = b - a, v = d - c, across = glm::cross(u, v), from = c - a;
    const double square = glm::dot(across, across);
    if (square > 0) {
        const double s = glm::dot(glm::cross(from, v), across) / square,
                     t = glm::dot(glm::cross(from, u), across) / square,
                     distance = std::abs(glm::dot(from, across)) / std::sqrt(square);
        if (s > 0 && s < 1 && t > 0 && t < 1) return {distance, distance};
    }
    return {std::min(std::min(distanceToEdge(a, c, d), distanceToEdge(b, c, d)),
                     std::min(distanceToEdge(c, a, b), distanceToEdge(d, a, b)))};
}

Apart bordersApart(const RadiatingPiece& a, const RadiatingPiece& b) {
    const size_t m = a.corners.size(), n = b.corners.size();
    Apart least;
    for (size_t k = 0; k < m; ++k)
        for (size_t l = 0; l < n; ++l) {
            const Apart one =
                edgesApart(a.corners[k], a.corners[(k + 1) % m], b.corners[l], b.corners[(l + 1) % n]);
            least = {std::min(least.anywhere, one.anywhere), std::min(least.crossing, one.crossing)};
        }
    return least;
}

bool byContour(const RadiatingPiece& a, const RadiatingPiece& b, double tolerance) {
    const double size = std::max(a.size, b.size), flat = std::min(kFlat, kRounding / tolerance) * size,
                 near = std::max(flat, kNearly * size);
    const bool narrow = isNarrow(a) || isNarrow(b), needles = isNarrow(a) && isNarrow(b);
    const double reach = narrow ? kFlat * size : near;
    if (glm::distance(a.corners[0], b.corners[0]) > a.size + b.size + reach) return false;
    const Heights ofA = heightsOver(b, a), ofB = heightsOver(a, b);
    if (std::min(ofA.highest, ofB.highest) < flat) return true;
    if (std::max(ofA.lowest, ofB.lowest) > reach) return false;
    const Apart apart = bordersApart(a, b);
    return (narrow && apart.crossing < kFlat * size) || (needles && apart.anywhere < flat) ||
           (apart.anywhere > kTouch * size && apart.anywhere < kNearly * size);
}

glm::uvec2 fixedPoint(double value) {
    const double units = value * io::kExactOne, whole = std::floor(units);
    return {whole, (units - whole) * io::kExactFraction};
}

glm::uvec4 sumOf(double factor) {
    return {fixedPoint(factor), fixedPoint(factor * kFloatRounding)};
}

// Index of the first that is chosen, after all that are not.
size_t moveToEnd(const ExactScene& scene, std::vector<io::ExactRecord>& records, double tolerance) {
    std::vector<uint8_t> chosen(records.size());
    inParallel((records.size() + kShare - 1) / kShare, [&](size_t share) {
        for (size_t k = share * kShare; k < std::min(records.size(), (share + 1) * kShare); ++k)
            chosen[k] = records[k].listed == 0 &&
                        byContour(scene.pieces[records[k].outer], scene.pieces[records[k].inner], tolerance);
    });
    size_t first = records.size();
    for (size_t k = first; k-- > 0;)
        if (chosen[k]) std::swap(records[k], records[--first]);
    return first;
}

} // namespace

std::vector<glm::uvec4> sumsByContours(const ExactScene& scene, std::vector<io::ExactRecord>& records,
                                       double tolerance) {
    const size_t first = moveToEnd(scene, records, tolerance);
    std::vector<glm::uvec4> sums(records.size() - first);
    inParallel(sums.size(), [&](size_t k) {
        const io::ExactRecord& r = records[first + k];
        sums[k] = sumOf(contourExchange(scene.pieces[r.outer].corners, scene.pieces[r.inner].corners) /
                        scene.area[r.outer]);
    });
    return sums;
}

} // namespace heliodon::compute
