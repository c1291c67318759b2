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

// What a region's cells send light to.
struct Target {
    geometry::Bounds box;
    double least; // length of a cell beside it
};

Target targetOf(const ConvexRegion& region) {
    return {geometry::boundsOf(region.corners),
            kOfOpening * std::sqrt(0.5 * glm::length(geometry::areaVector(region.corners)))};
}

bool hasColour(const geometry::PatchMesh& mesh, uint32_t material) {
    return !mesh.materials[material].isOpening() && mesh.materials[material].reflectance != glm::vec3(0);
}

} // namespace

struct OutsideCells::Plan {
    uint32_t region;
    dvec3 normal, u, v;
    std::vector<const ConvexRegion*> linings; // of an outer side
    std::vector<Target> targets;
};

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

OutsideCells::OutsideCells(const geometry::PatchMesh& mesh, std::span<const ConvexRegion> openings,
                           std::span<const ConvexRegion> walls)
    : regions_(outsideRegions(mesh, 16)), standing_(regions_.size()) {
    std::vector<ConvexRegion> linings;
    const double samePlane = kSamePlane * geometry::boundsOf(mesh.vertices).diagonal();
    if (!openings.empty() && (standing_ > 0 || anyWallBefore(openings, walls, samePlane))) {
        OuterSides sides = outerSides(mesh);
        regions_.insert(regions_.end(), sides.regions.begin(), sides.regions.end());
        linings = std::move(sides.linings);
    }
    roots_.assign(regions_.size(), kNone);
    if (openings.empty()) return;
    const std::vector<Plan> plans = plansOf(mesh, openings, linings);
    double coarser = 1;
    do {
        cutAll(plans, coarser);
        coarser *= kCoarser;
    } while (cells_.size() > std::max(kMostCells, plans.size()));
}

void OutsideCells::blacken() {
    nodes_.clear(), cells_.clear();
    std::ranges::fill(roots_, kNone);
    tooMany_ = true;
}

// Those that look at an opening first, then those that light what reflects on to one.
std::vector<OutsideCells::Plan> OutsideCells::plansOf(const geometry::PatchMesh& mesh,
                                                      std::span<const ConvexRegion> openings,
                                                      std::span<const ConvexRegion> linings) const {
    const double samePlane = kSamePlane * geometry::boundsOf(mesh.vertices).diagonal();
    std::vector<Plan> plans;
    const auto add = [&](size_t r) -> Plan& {
        const dvec3 normal = normalOf(regions_[r]), u = longestSide(regions_[r].corners);
        return plans.emplace_back(static_cast<uint32_t>(r), normal, u, glm::cross(normal, u));
    };
    const auto aimAtOpenings = [&](Plan& plan) {
        const auto isAhead = [&](const ConvexRegion& opening) {
            return std::ranges::any_of(opening.corners, [&](const dvec3& p) {
                return glm::dot(p - regions_[plan.region].corners[0], plan.normal) > 0;
            });
        };
        const bool looksAtNone = std::ranges::none_of(openings, isAhead); // it lights others
        for (const ConvexRegion& opening : openings)
            if (looksAtNone || isAhead(opening)) plan.targets.push_back(targetOf(opening));
    };
    if (!mesh.outside.material.empty())
        for (size_t r = 0; r < standing_; ++r)
            if (hasColour(mesh, regions_[r].group)) aimAtOpenings(add(r));
    std::vector<dvec3> normals;
    for (const ConvexRegion& region : regions_) normals.push_back(normalOf(region));
    // An outer side that one of these and a lining that is not black see one another by.
    const auto addSide = [&](size_t r, std::span<const ConvexRegion> targets) -> Plan* {
        std::vector<const ConvexRegion*> its;
        for (const ConvexRegion& lining : linings)
            if (inPlaneOf(regions_[r], lining, samePlane)) its.push_back(&lining);
        const bool sees = std::ranges::any_of(its, [&](const ConvexRegion* lining) {
            BackView view(*lining, regions_, normals, samePlane);
            return hasColour(mesh, lining->group) &&
                   std::ranges::any_of(targets, [&](const ConvexRegion& other) { return view.sees(other); });
        });
        if (!sees) return nullptr;
        Plan& plan = add(r);
        plan.linings = std::move(its);
        return &plan;
    };
    std::vector<ConvexRegion> glass{openings.begin(), openings.end()}, lit; // as seen from outside
    for (ConvexRegion& opening : glass) std::ranges::reverse(opening.corners);
    std::vector<size_t> others;
    for (size_t r = standing_; r < regions_.size(); ++r)
        if (Plan* plan = addSide(r, glass))
            aimAtOpenings(*plan);
        else
            others.push_back(r);
    for (const Plan& plan : plans) lit.push_back(regions_[plan.region]);
    for (const size_t r : others)
        if (Plan* plan = addSide(r, lit))
            for (const ConvexRegion& other : lit)
                if (lookAtOneAnother(regions_[r], other, samePlane)) plan->targets.push_back(targetOf(other));
    return plans;
}

void OutsideCells::cutAll(std::span<const Plan> plans, double coarser) {
    nodes_.clear(), cells_.clear();
    for (const Plan& plan : plans) {
        roots_[plan.region] = cut(regions_[plan.region].corners, plan, coarser);
        if (cells_.size() > std::max(kMostCells, plans.size())) return;
    }
}

uint32_t OutsideCells::cut(std::vector<dvec3> polygon, const Plan& plan, double coarser) {
    const Extent alongU = extentAlong(polygon, plan.u), alongV = extentAlong(polygon, plan.v);
    const bool isWide = alongU.length() >= alongV.length();
    const Extent& extent = isWide ? alongU : alongV;
    const geometry::Bounds box = geometry::boundsOf(polygon);
    double longest = 1e300;
    for (const Target& target : plan.targets)
        longest = std::min(longest, std::max(target.least, kOfDistance * gap(box, target.box)));
    const auto own = static_cast<uint32_t>(nodes_.size());
    Node& node = nodes_.emplace_back();
    node.normal = isWide ? plan.u : plan.v, node.offset = 0.5 * (extent.low + extent.high);
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
        const dvec3 centre = viewCell(polygon, plan.normal).centre;
        std::vector<MaterialShare> materials{{regions_[plan.region].group, 1}};
        if (isOfRooms(plan.region)) materials = materialsOn(polygon, plan.linings);
        cells_.push_back({std::move(polygon), centre, plan.normal, plan.region, std::move(materials)});
        return own;
    }
    for (const size_t beyond : {0u, 1u}) { // which moves the nodes
        const uint32_t child = cut(std::move(halves[beyond]), plan, coarser);
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
