#include "compute/outside_cells.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "compute/view_cells.h"
#include "geometry/bounds.h"
#include "geometry/clip_polygon.h"

namespace heliodon::compute {

using glm::dvec3;

// That a region looks at.
struct OutsideCells::Opening {
    geometry::Bounds box;
    double least; // length of a cell beside it
};

namespace {

constexpr double kOfDistance = 0.25, kOfOpening = 0.125; // the longest cell
constexpr double kCoarser = 1.5;                         // at a time

double gap(const geometry::Bounds& a, const geometry::Bounds& b) {
    return glm::length(glm::max(dvec3(0), glm::max(a.low - b.high, b.low - a.high)));
}

struct Extent {
    double low = 1e300, high = -1e300;
    double length() const { return high - low; }
};

Extent extentAlong(std::span<const dvec3> polygon, dvec3 axis) {
    Extent extent;
    for (const dvec3& p : polygon) {
        const double at = glm::dot(p, axis);
        extent.low = std::min(extent.low, at), extent.high = std::max(extent.high, at);
    }
    return extent;
}

dvec3 longestSide(std::span<const dvec3> polygon) {
    dvec3 longest(0);
    for (size_t k = 0; k < polygon.size(); ++k)
        if (const dvec3 side = polygon[(k + 1) % polygon.size()] - polygon[k];
            glm::length(side) > glm::length(longest))
            longest = side;
    return glm::normalize(longest);
}

} // namespace

void mergeShares(std::vector<OutsideShare>& shares) {
    std::ranges::stable_sort(shares, {}, &OutsideShare::cell);
    size_t kept = 0;
    for (const OutsideShare& share : shares)
        if (kept > 0 && shares[kept - 1].cell == share.cell)
            shares[kept - 1].weight += share.weight;
        else
            shares[kept++] = share;
    shares.resize(kept);
}

OutsideCells::OutsideCells(const geometry::PatchMesh& mesh, std::vector<ConvexRegion> regions,
                           std::span<const ConvexRegion> openings)
    : regions_(std::move(regions)), roots_(regions_.size(), kNone) {
    if (mesh.outside.material.empty() || openings.empty()) return;
    std::vector<size_t> bright;
    for (size_t r = 0; r < regions_.size(); ++r)
        if (mesh.materials[regions_[r].group].reflectance != glm::vec3(0)) bright.push_back(r);
    double coarser = 1;
    do {
        cutAll(openings, bright, coarser);
        coarser *= kCoarser;
    } while (cells_.size() > std::max(kMostCells, bright.size()));
}

void OutsideCells::blacken() {
    nodes_.clear(), cells_.clear();
    std::ranges::fill(roots_, kNone);
    tooMany_ = true;
}

void OutsideCells::cutAll(std::span<const ConvexRegion> openings, std::span<const size_t> bright,
                          double coarser) {
    nodes_.clear(), cells_.clear();
    std::vector<Opening> ahead;
    for (const size_t r : bright) {
        const ConvexRegion& region = regions_[r];
        const dvec3 normal = normalOf(region);
        const auto isAhead = [&](const ConvexRegion& opening) {
            return std::ranges::any_of(
                opening.corners, [&](const dvec3& p) { return glm::dot(p - region.corners[0], normal) > 0; });
        };
        const bool looksAtNone = std::ranges::none_of(openings, isAhead); // it lights others
        ahead.clear();
        for (const ConvexRegion& opening : openings)
            if (looksAtNone || isAhead(opening))
                ahead.push_back(
                    {geometry::boundsOf(opening.corners),
                     kOfOpening * std::sqrt(0.5 * glm::length(geometry::areaVector(opening.corners)))});
        roots_[r] = cut(region.corners, static_cast<uint32_t>(r), ahead, coarser);
        if (cells_.size() > std::max(kMostCells, bright.size())) return;
    }
}

uint32_t OutsideCells::cut(std::vector<dvec3> polygon, uint32_t region, std::span<const Opening> openings,
                           double coarser) {
    const dvec3 normal = normalOf(regions_[region]), u = longestSide(regions_[region].corners),
                v = glm::cross(normal, u);
    const Extent alongU = extentAlong(polygon, u), alongV = extentAlong(polygon, v);
    const bool isWide = alongU.length() >= alongV.length();
    const Extent& extent = isWide ? alongU : alongV;
    const geometry::Bounds box = geometry::boundsOf(polygon);
    double longest = 1e300;
    for (const Opening& opening : openings)
        longest = std::min(longest, std::max(opening.least, kOfDistance * gap(box, opening.box)));
    const auto own = static_cast<uint32_t>(nodes_.size());
    Node& node = nodes_.emplace_back();
    node.normal = isWide ? u : v, node.offset = 0.5 * (extent.low + extent.high);
    std::array<std::vector<dvec3>, 2> halves;
    for (const size_t beyond : {0u, 1u})
        geometry::clip<dvec3>(
            polygon,
            [&, sign = beyond ? 1.0 : -1.0](const dvec3& p) {
                return sign * (glm::dot(p, node.normal) - node.offset);
            },
            halves[beyond]);
    if (extent.length() <= coarser * longest || halves[0].empty() || halves[1].empty() ||
        cells_.size() > kMostCells) {
        node.cell = static_cast<uint32_t>(cells_.size());
        const dvec3 centre = viewCell(polygon, normal).centre;
        cells_.push_back({std::move(polygon), centre, normal, region, regions_[region].group});
        return own;
    }
    for (const size_t beyond : {0u, 1u}) { // which moves the nodes
        const uint32_t child = cut(std::move(halves[beyond]), region, openings, coarser);
        nodes_[own].child[beyond] = child;
    }
    return own;
}

uint32_t OutsideCells::cellAt(size_t region, dvec3 point) const {
    const Node* node = &nodes_[roots_[region]];
    while (node->cell == kNone)
        node = &nodes_[node->child[glm::dot(point, node->normal) >= node->offset ? 1 : 0]];
    return node->cell;
}

} // namespace heliodon::compute
