#include "compute/exact_clusters.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace heliodon::compute {

using glm::dvec2;
using glm::dvec3;

namespace {

constexpr size_t kFewest = 8; // pieces of one plane worth a flat cluster of their own

dvec3 middleOf(const RadiatingPiece& piece) {
    dvec3 sum{0};
    for (const dvec3& p : piece.corners) sum += p;
    return sum / static_cast<double>(piece.corners.size());
}

// Rectangle along the longest edge of the first piece: walls are meshed along their sides.
std::vector<dvec3> rectangleOf(std::span<const RadiatingPiece> pieces) {
    const RadiatingPiece& first = pieces[0];
    dvec3 u{0};
    for (size_t k = 0; k < first.corners.size(); ++k) {
        const dvec3 edge = first.corners[(k + 1) % first.corners.size()] - first.corners[k];
        if (std::max({std::abs(edge.x), std::abs(edge.y), std::abs(edge.z)}) > 0 &&
            (glm::length(u) == 0 || glm::length(edge) < glm::length(u)))
            u = edge; // the shortest edge lies along a side where squares are halved
    }
    u = glm::normalize(u - glm::dot(u, first.normal) * first.normal);
    const dvec3 v = glm::cross(first.normal, u), origin = first.corners[0];
    dvec2 low{INFINITY}, high{-INFINITY};
    for (const RadiatingPiece& piece : pieces)
        for (const dvec3& p : piece.corners) {
            const dvec2 at{glm::dot(p - origin, u), glm::dot(p - origin, v)};
            low = glm::min(low, at);
            high = glm::max(high, at);
        }
    const auto lifted = [&](double x, double y) { return origin + x * u + y * v; };
    return {lifted(low.x, low.y), lifted(high.x, low.y), lifted(high.x, high.y), lifted(low.x, high.y)};
}

class Clusterer {
public:
    Clusterer(std::span<RadiatingPiece> all, uint32_t firstPiece) : all_(all), firstPiece_(firstPiece) {}

    // Halves across the longest extent until few enough are left.
    void split(std::span<RadiatingPiece> pieces, bool flat) {
        if (pieces.size() > kClusterPieces) {
            dvec3 low{INFINITY}, high{-INFINITY};
            for (const RadiatingPiece& piece : pieces) {
                low = glm::min(low, middleOf(piece));
                high = glm::max(high, middleOf(piece));
            }
            const dvec3 size = high - low;
            const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
            const size_t half = pieces.size() / 2;
            std::nth_element(pieces.begin(), pieces.begin() + static_cast<long>(half), pieces.end(),
                             [axis](const RadiatingPiece& a, const RadiatingPiece& b) {
                                 const double x = middleOf(a)[axis], y = middleOf(b)[axis];
                                 return x < y || (x == y && a.place < b.place);
                             });
            split(pieces.first(half), flat);
            split(pieces.subspan(half), flat);
            return;
        }
        PieceCluster cluster{firstPiece_ + static_cast<uint32_t>(pieces.data() - all_.data()),
                             static_cast<uint32_t>(pieces.size()),
                             pieces[0].room,
                             flat,
                             pieces[0].normal,
                             {}};
        if (flat) cluster.rectangle = rectangleOf(pieces);
        clusters.push_back(std::move(cluster));
    }

    std::vector<PieceCluster> clusters;

private:
    std::span<RadiatingPiece> all_;
    uint32_t firstPiece_;
};

} // namespace

std::vector<PieceCluster> clusterPieces(std::span<RadiatingPiece> pieces, uint32_t firstPiece) {
    std::map<uint32_t, size_t> ofPlane;
    for (const RadiatingPiece& piece : pieces) ++ofPlane[piece.plane];
    // Pieces without a plane to share are clustered by room, behind the others.
    const auto isFlat = [&](const RadiatingPiece& p) {
        return glm::length(p.normal) > 0.5 && ofPlane[p.plane] >= kFewest;
    };
    const auto key = [&](const RadiatingPiece& p) {
        const bool flat = isFlat(p);
        return std::tuple(!flat, flat ? p.plane : 0u, p.room, p.place);
    };
    std::sort(pieces.begin(), pieces.end(),
              [&](const RadiatingPiece& a, const RadiatingPiece& b) { return key(a) < key(b); });
    Clusterer clusterer(pieces, firstPiece);
    for (size_t begin = 0; begin < pieces.size();) {
        const auto group = key(pieces[begin]);
        const auto same = [&](const RadiatingPiece& p) {
            const auto k = key(p);
            return std::get<0>(k) == std::get<0>(group) && std::get<1>(k) == std::get<1>(group) &&
                   std::get<2>(k) == std::get<2>(group);
        };
        size_t end = begin;
        while (end < pieces.size() && same(pieces[end])) ++end;
        clusterer.split(pieces.subspan(begin, end - begin), !std::get<0>(group));
        begin = end;
    }
    return std::move(clusterer.clusters);
}

} // namespace heliodon::compute
