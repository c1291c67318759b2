// What of other walls stands right before the outer face of a wall: no light comes in there.
#pragma once

#include <string>
#include <vector>

#include "geometry/plan_walls.h"
#include "geometry/used_stretches.h"

namespace heliodon::geometry {

struct WallRun;

constexpr double kIntoCorner = 0.375; // inches: walls reach so far beyond the corner that a room sees

// What walls of the side, and cracks between them, cover.
std::vector<Stretch> coveredStretches(const PlanWalls& plan, int line);

struct FacingWall {
    int line = -1; // the straight side that it belongs to
    Stretch on;    // along the side that it stands before
    double height = 0;
    std::string id;
};

// Straight walls side by side with the run's that touch its outer face along `on`, reach into it or leave a
// crack before it. A filled or bridged hole in the wall of a room is wall, too.
std::vector<FacingWall> wallsBefore(const PlanWalls& plan, const std::vector<WallRun>& runs,
                                    const WallRun& run, Stretch on);

// A wall that no room sees along `wall.on`, with nothing else right before it, is an outer layer of the
// run's: both are one wall, and what is cut into one of them is cut through both.
bool isOuterLayer(const PlanWalls& plan, const std::vector<WallRun>& runs, const WallRun& run,
                  const FacingWall& wall);

// Whether a room has the side, one or the other face of it, along the stretch.
bool isSeen(const PlanWalls& plan, const std::vector<WallRun>& runs, int line, Stretch on);

// Where a stretch of one straight side lies along another one, which runs beside it.
Stretch alongOther(const WallLine& line, Stretch on, const WallLine& other);

} // namespace heliodon::geometry
