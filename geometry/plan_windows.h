// Window markers -> openings in straight sides: merged over joints, clipped to the wall and to what the rooms
// see of it.
#pragma once

#include <string>
#include <vector>

#include "geometry/plan_rooms.h"
#include "geometry/plan_walls.h"

namespace heliodon::geometry {

// A flat stretch of a room's outline: edges `first` .. `first + count` of a loop, cyclic, on one line.
struct WallRun {
    size_t room = 0, loop = 0, first = 0, count = 0;
    glm::dvec2 from{}, to{};
    int line = -1;         // straight side that the walls behind it belong to
    bool leftFace = false; // it is the face on the left of that line's direction
    int curved = -1;       // else the arc that it is a facet of
};

// A hole in one side of a wall. In an interior wall two of them, on either side, have the same `opening`.
struct WindowHole {
    size_t run = 0;
    double from = 0, to = 0;   // inches along the run
    double sill = 0, head = 0; // inches
    int opening = 0;
    bool twin = false;
    bool backed = true; // a wall stands behind its middle
    std::string id;
    Blind blind;
};

struct PlanWindows {
    std::vector<WindowHole> holes;
    int openings = 0;
    std::vector<PlanNote> notes;
};

std::vector<WallRun> wallRuns(const PlanWalls& plan, const std::vector<RoomPlan>& rooms);

// `ceilings`: inches, per room.
PlanWindows placeWindows(const Sketch& sketch, const PlanWalls& plan, const std::vector<WallRun>& runs,
                         const std::vector<double>& ceilings);

} // namespace heliodon::geometry
