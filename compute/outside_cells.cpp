#include "compute/outside_cells.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "compute/view_cells.h"
#include "geometry/bounds.h"
#include "geometry/clip_polygon.h"
#include "geometry/extent.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

constexpr double kCoarser = 1.5; // cells, at a time
constexpr double kRowsLast = 4;  // how much coarser cells get along boards before they do across
constexpr double kRounding = 1e-3;
constexpr double kMixed = 64; // as much coarser, there are too many windows for cells round each of them
// Of what a cell sends: what cells and black glass leave; of boards, each time that cells are made coarser
// (docs/accuracy.md).
constexpr double kUnsure = 0.04, kUnsureOfBoards = 0.08, kMostUnsure = 1;

struct Cut {
    dvec3 normal{0};
    double offset = 0;
};

// Of the edges of glass that is part of a polygon, the one that halves it best: light falls on the wall
// beside a window, and a reveal that sees nothing but the glass gets none of it back.
std::optional<Cut> cutAtGlass(std::span<const dvec3> polygon, const OutsidePlan& plan) {
    std::optional<Cut> best;
    double uneven = 0.5 - kRounding;
    for (const ConvexRegion* const& glass : plan.glass) {
        const std::vector<MaterialShare> shares = materialsOn(polygon, {&glass, 1});
        if (shares.empty() || shares[0].share > 1 - kRounding) continue;
        for (size_t k = 0; k < glass->corners.size(); ++k) {
            const dvec3 a = glass->corners[k], b = glass->corners[(k + 1) % glass->corners.size()],
                        normal = glm::normalize(glm::cross(plan.normal, b - a));
            const geometry::Extent extent = geometry::extentAlong(polygon, normal);
            const double offset = glm::dot(normal, a),
                         off = std::abs(offset - 0.5 * (extent.low + extent.high)) / extent.length();
            if (off < uneven) uneven = off, best = Cut{normal, offset};
        }
    }
    return best;
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

OutsideCells::OutsideCells(const geometry::PatchMesh& mesh, std::span<const ConvexRegion> openings,
                           std::span<const ConvexRegion> walls)
    : regions_(outsideRegions(mesh, 16)), standing_(regions_.size()) {
    const double samePlane = kSamePlane * geometry::boundsOf(mesh.vertices).diagonal();
    if (!openings.empty() && (standing_ > 0 || anyWallBefore(openings, walls, samePlane))) {
        OuterSides sides = outerSides(mesh);
        regions_.insert(regions_.end(), sides.regions.begin(), sides.regions.end());
        linings_ = std::move(sides.linings);
    }
    cutAll(mesh, openings);
}

void OutsideCells::blackenStanding(const geometry::PatchMesh& mesh, std::span<const ConvexRegion> openings) {
    tooMany_ = true;
    cutAll(mesh, openings);
}

void OutsideCells::cutAll(const geometry::PatchMesh& mesh, std::span<const ConvexRegion> openings) {
    std::vector<OutsidePlan> plans;
    if (!openings.empty())
        plans = outsidePlans(mesh, {std::span(regions_).first(standing_), regions_, linings_}, openings,
                             tooMany_);
    const bool boards =
        std::ranges::any_of(plans, [](const OutsidePlan& plan) { return plan.board.has_value(); });
    const size_t most = std::max(boards ? kMostOfBoards : kMostCells, plans.size());
    for (double coarser = 1; !cutAll(plans, coarser, most);) coarser *= kCoarser;
}

// False where there are more than `most`.
bool OutsideCells::cutAll(std::span<const OutsidePlan> plans, double coarser, size_t most) {
    nodes_.clear(), cells_.clear();
    roots_.assign(regions_.size(), kNone);
    for (const OutsidePlan& plan : plans) {
        roots_[plan.region] = cut(regions_[plan.region].corners, plan, coarser, most);
        if (cells_.size() > most) return false;
    }
    return true;
}

uint32_t OutsideCells::cut(std::vector<dvec3> polygon, const OutsidePlan& plan, double coarser, size_t most) {
    const geometry::Extent alongU = geometry::extentAlong(polygon, plan.u),
                           alongV = geometry::extentAlong(polygon, plan.v);
    const double longest = coarser * plan.longest(geometry::boundsOf(polygon)),
                 row = plan.board ? std::min(longest, plan.board->row * std::max(1.0, coarser / kRowsLast))
                                  : longest,
                 overU = alongU.length() / (plan.board && plan.board->isSquare ? row : longest),
                 overV = alongV.length() / row;
    const bool isWide = overU >= overV;
    const geometry::Extent& extent = isWide ? alongU : alongV;
    const std::optional<Cut> atGlass = coarser < kMixed ? cutAtGlass(polygon, plan) : std::nullopt;
    const auto own = static_cast<uint32_t>(nodes_.size());
    Node& node = nodes_.emplace_back();
    const Cut at = atGlass.value_or(Cut{isWide ? plan.u : plan.v, 0.5 * (extent.low + extent.high)});
    node.normal = at.normal, node.offset = at.offset;
    std::array<std::vector<dvec3>, 2> halves;
    for (const size_t beyond : {0u, 1u})
        geometry::clip<dvec3>(
            polygon,
            [&, sign = beyond ? 1.0 : -1.0](const dvec3& p) {
                return sign * (glm::dot(p, node.normal) - node.offset);
            },
            halves[beyond]);
    if ((!atGlass && std::max(overU, overV) <= 1 + kRounding) || halves[0].empty() || halves[1].empty() ||
        cells_.size() > most) {
        node.cell = static_cast<uint32_t>(cells_.size());
        const dvec3 centre = viewCell(polygon, plan.normal).centre;
        std::vector<MaterialShare> materials{{regions_[plan.region].group, 1}};
        if (isOfRooms(plan.region)) materials = materialsOn(polygon, plan.linings);
        const double unsure = plan.board ? std::min(kUnsureOfBoards * coarser, kMostUnsure) : kUnsure;
        cells_.push_back({std::move(polygon), centre, plan.normal, plan.region, static_cast<float>(unsure),
                          std::move(materials)});
        return own;
    }
    for (const size_t beyond : {0u, 1u}) { // which moves the nodes
        const uint32_t child = cut(std::move(halves[beyond]), plan, coarser, most);
        nodes_[own].child[beyond] = child;
    }
    return own;
}

uint32_t OutsideCells::cellAt(size_t region, dvec3 point) const {
    return cellBelow(nodes_[roots_[region]], point);
}

uint32_t OutsideCells::cellBelow(const Node& top, dvec3 point) const {
    const Node* node = &top;
    while (node->cell == kNone)
        node = &nodes_[node->child[glm::dot(point, node->normal) >= node->offset ? 1 : 0]];
    return node->cell;
}

void OutsideCells::forParts(const Node& node, dvec3 from, std::vector<dvec3> polygon, double angle,
                            const PartWork& work) const {
    if (node.cell != kNone) {
        work(node.cell, polygon);
        return;
    }
    dvec3 middle(0);
    for (const dvec3& p : polygon) middle += p / double(polygon.size());
    if (std::ranges::all_of(polygon, [&](const dvec3& p) {
            return 2 * glm::length(p - middle) <= angle * glm::length(middle);
        })) {
        work(cellBelow(node, from + middle), polygon);
        return;
    }
    const double offset = node.offset - glm::dot(from, node.normal);
    for (const size_t beyond : {0u, 1u}) {
        std::vector<dvec3> half;
        geometry::clip<dvec3>(
            polygon,
            [&, sign = beyond ? 1.0 : -1.0](const dvec3& p) {
                return sign * (glm::dot(p, node.normal) - offset);
            },
            half);
        if (half.size() >= 3) forParts(nodes_[node.child[beyond]], from, std::move(half), angle, work);
    }
}

} // namespace heliodon::compute
