// The lines from which rooms are made: the edges of the walls and, from ends of walls that touch nothing, the
// lines along which a gap may be bridged.
#pragma once

#include <array>
#include <vector>

#include <glm/vec2.hpp>

#include "geometry/plan_arrangement.h"
#include "geometry/plan_walls.h"

namespace heliodon::geometry {

// What a segment of the arrangement is: an edge of a solid, or a line along which a gap may be bridged.
struct PlanLine {
    int solid = -1, edge = 0; // of the solid
    double weight = 1;        // of a bridge: what an inch costs at its start
    double growth = 0;        // and how that grows along it
    glm::dvec2 start{};
    int alongSide = -1;                // the straight side from piece to piece of which it leads
    std::array<int, 2> facade{-1, -1}; // or between those of pieces that face one another out of line
    int lengthens = -1; // the straight side of the wall that it lengthens to another piece, maybe out of line
};

// What a wall would cover if it were lengthened from a free end to what stands before that.
struct WallAhead {
    glm::dvec2 right{}, left{}, out{}; // corners of the end, the direction in which it points
    double reach = 0;
};

struct PlanLines {
    std::vector<PlanSegment> segments; // their tags are indices into `lines`
    std::vector<PlanLine> lines;
    std::vector<WallAhead> ahead;
};

PlanLines planLines(const PlanWalls& plan);

} // namespace heliodon::geometry
