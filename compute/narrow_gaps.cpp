#include "compute/narrow_gaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "geometry/clip_polygon.h"

namespace heliodon::compute {

namespace {

constexpr double kFlat = 1e-6;        // of distance and radii, as kPairFlat of pair_exchange.glsl
constexpr double kTouching = 1e-9;    // as large a share is the rounding of coordinates: they touch
constexpr double kStraight = 0.99999; // cosine between both normals

double gapBetween(const PatchTree::Node& a, const PatchTree::Node& b) {
    return glm::dot(a.normal, b.centre - a.centre);
}

double crossAlong(const glm::dvec3& normal, const glm::dvec3& a, const glm::dvec3& b) {
    return glm::dot(normal, glm::cross(a, b));
}

struct Overlap {
    double area = 0, border = 0;
};

// Of `a` and of what lies of `b` over it.
Overlap overlapOf(const PatchTree::Leaf& a, const PatchTree::Leaf& b, const glm::dvec3& normal) {
    std::vector<glm::dvec3> part(b.corner.begin(), b.corner.end()), left;
    for (size_t k = 0; k < 3; ++k) {
        const glm::dvec3 from = a.corner[k], along = a.corner[(k + 1) % 3] - from;
        geometry::clip<glm::dvec3>(
            part, [&](const glm::dvec3& p) { return crossAlong(normal, along, p - from); }, left);
        part.swap(left);
    }
    Overlap overlap;
    for (size_t k = 0; k < part.size(); ++k) {
        const glm::dvec3 &p = part[k], &q = part[(k + 1) % part.size()];
        overlap.area -= 0.5 * crossAlong(normal, p - part[0], q - part[0]); // seen from its back
        overlap.border += glm::length(q - p);
    }
    return overlap;
}

} // namespace

bool acrossNarrowGap(const PatchTree::Node& a, const PatchTree::Node& b) {
    if (a.room != b.room || glm::dot(a.normal, b.normal) > -kStraight) return false;
    const glm::dvec3 d = b.centre - a.centre;
    const double size = glm::length(d) + a.radius + b.radius,
                 tilt = glm::length(glm::cross(a.normal, b.normal)), overA = gapBetween(a, b),
                 overB = gapBetween(b, a);
    if (glm::length(d) > a.radius + b.radius || std::min(overA, overB) <= kTouching * size) return false;
    return overA + b.radius * tilt <= kFlat * size || overB + a.radius * tilt <= kFlat * size;
}

std::vector<io::HierarchicalLink> linksAcrossNarrowGaps(const PatchTree& tree,
                                                        std::span<const glm::uvec2> pairs) {
    std::vector<std::pair<double, glm::uvec2>> byGap;
    for (const glm::uvec2& pair : pairs)
        byGap.emplace_back(gapBetween(tree.nodes[pair.x], tree.nodes[pair.y]), pair);
    std::stable_sort(byGap.begin(), byGap.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<double> left;
    for (const PatchTree::Leaf& leaf : tree.leaves) left.push_back(leaf.area);
    std::vector<io::HierarchicalLink> links;
    for (const auto& [gap, pair] : byGap) {
        const PatchTree::Node &a = tree.nodes[pair.x], &b = tree.nodes[pair.y];
        for (uint32_t i = a.firstLeaf; i < a.firstLeaf + a.leafCount; ++i)
            for (uint32_t j = b.firstLeaf; j < b.firstLeaf + b.leafCount; ++j) {
                const PatchTree::Leaf &one = tree.leaves[i], &other = tree.leaves[j];
                const Overlap overlap = overlapOf(one, other, a.normal);
                const double exchange = std::min({overlap.area, left[i], left[j]});
                if (!(exchange > 0)) continue;
                left[i] -= exchange, left[j] -= exchange;
                const auto density = static_cast<float>(exchange / (one.area * other.area));
                const double error = std::min(0.5 * gap * overlap.border, exchange) / (one.area * other.area);
                links.push_back({std::min(one.node, other.node), std::max(one.node, other.node), density, 0,
                                 0, static_cast<float>(error), density, 0});
            }
    }
    return links;
}

} // namespace heliodon::compute
