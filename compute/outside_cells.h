// What reflects light into a building's windows from outside, what stands there and the outer sides of its
// own rooms, cut into cells that are each taken to be lit evenly.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/convex_regions.h"
#include "compute/outer_sides.h"
#include "compute/outside_plans.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

struct OutsideCell {
    std::vector<glm::dvec3> corners; // convex, world, counter-clockwise seen from the air
    glm::dvec3 centre, normal;
    uint32_t region;
    float unsure;                         // share of its exitance, for being lit unevenly
    std::vector<MaterialShare> materials; // what is missing to one, as glass, is black
};

// What a point gets of a cell: its form factor times the transmittance of panes before it.
struct OutsideShare {
    uint32_t cell;
    glm::vec3 weight; // times the cell's exitance: lux
};
// Sums shares of one cell; in the order of cells.
void mergeShares(std::vector<OutsideShare>& shares);

class OutsideCells {
public:
    static constexpr size_t kMostCells = 2048,
                            kMostOfBoards = 2 * kMostCells; // the latter where there are any

    OutsideCells() = default;
    // Regions are those that stand outside and, after them, the outer sides of rooms, if any of these lies
    // before an opening or anything stands outside. Those of black materials get no cells, nor do outer sides
    // that look neither at an opening nor at what reflects on to one. A cell is halved until it is no longer
    // than a quarter of its distance from the nearest opening, of those that its front looks at, or than an
    // eighth of that opening's root of the area; where it looks at none, what it lights stands for openings
    // if it is an outer side, else all openings; where there would be more than kMostCells, than some times
    // as much. Boards close before one another have up to eight rows of cells across their depth, which get
    // wider only where four times as much does not do. Cells of outer sides are glass or wall, not both, but
    // where windows are so many that 64 times as long ones were too many. `walls`: of all rooms, facing
    // inwards.
    OutsideCells(const geometry::PatchMesh& mesh, std::span<const ConvexRegion> openings,
                 std::span<const ConvexRegion> walls);

    std::span<const ConvexRegion> regions() const { return regions_; }
    std::span<const OutsideCell> cells() const { return cells_; }
    // Takes what stands outside for black, as it is too many (PointScene); of the same mesh and openings.
    void blackenStanding(const geometry::PatchMesh& mesh, std::span<const ConvexRegion> openings);
    bool tooMany() const { return tooMany_; }
    bool reflects(size_t region) const { return roots_[region] != kNone; }
    bool isOfRooms(size_t region) const { return region >= standing_; }
    bool hasOuterSides() const { return regions_.size() > standing_; }
    // Of a region that reflects, the cell that a point of it lies in.
    uint32_t cellAt(size_t region, glm::dvec3 point) const;
    // work(cell, part) for the parts of a convex polygon on it, relative to a point, in its cells; what spans
    // less than `angle` (radians) from there is one part, of the cell that its middle lies in.
    using PartWork = std::function<void(uint32_t cell, std::span<const glm::dvec3> part)>;
    void forParts(size_t region, glm::dvec3 from, std::vector<glm::dvec3> polygon, double angle,
                  const PartWork& work) const {
        forParts(nodes_[roots_[region]], from, std::move(polygon), angle, work);
    }

private:
    static constexpr uint32_t kNone = UINT32_MAX;
    struct Node {
        glm::dvec3 normal{0}; // of the cut
        double offset = 0;
        std::array<uint32_t, 2> child{}; // before the cut, and beyond it
        uint32_t cell = kNone;           // of a leaf
    };
    void forParts(const Node& node, glm::dvec3 from, std::vector<glm::dvec3> polygon, double angle,
                  const PartWork& work) const;
    uint32_t cellBelow(const Node& node, glm::dvec3 point) const;
    void cutAll(const geometry::PatchMesh& mesh, std::span<const ConvexRegion> openings);
    bool cutAll(std::span<const OutsidePlan> plans, double coarser, size_t most);
    uint32_t cut(std::vector<glm::dvec3> polygon, const OutsidePlan& plan, double coarser, size_t most);

    std::vector<ConvexRegion> regions_;
    size_t standing_ = 0; // the first of the regions
    std::vector<ConvexRegion> linings_;
    bool tooMany_ = false;
    std::vector<uint32_t> roots_; // of regions, in nodes_; kNone of black ones
    std::vector<Node> nodes_;
    std::vector<OutsideCell> cells_;
};

} // namespace heliodon::compute
