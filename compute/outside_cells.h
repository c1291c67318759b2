// What stands outside of a building and reflects light into its windows, cut into cells that are each taken
// to be lit evenly.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "compute/convex_regions.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

struct OutsideCell {
    std::vector<glm::dvec3> corners; // convex, world, counter-clockwise seen from the air
    glm::dvec3 centre, normal;
    uint32_t region, material;
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
    OutsideCells() = default;
    // `regions` of outsideRegions, which stay as they are; those of black materials get no cells. A cell is
    // as wide as half its region's distance from the nearest opening, or an eighth of the region where that
    // is wider; coarser where there would be more than 2048.
    OutsideCells(const geometry::PatchMesh& mesh, std::vector<ConvexRegion> regions,
                 std::span<const ConvexRegion> openings);

    std::span<const ConvexRegion> regions() const { return regions_; }
    std::span<const OutsideCell> cells() const { return cells_; }
    bool reflects(size_t region) const { return grids_[region].across > 0; }
    // Of a region that reflects, the cell that a point of it lies in.
    uint32_t cellAt(size_t region, glm::dvec3 point) const;

private:
    struct Grid {                         // over a region, in its own plane
        glm::dvec3 origin{0}, u{0}, v{0}; // scaled: a step is a cell
        uint32_t across = 0, along = 0;
        std::vector<uint32_t> cell;
    };
    void cut(size_t region, Grid& grid);

    std::vector<ConvexRegion> regions_;
    std::vector<Grid> grids_; // of regions
    std::vector<OutsideCell> cells_;
};

} // namespace heliodon::compute
