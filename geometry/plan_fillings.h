// What closes the cracks and corners that a drawing leaves open between walls.
#pragma once

#include "geometry/plan_rooms.h"
#include "geometry/plan_walls.h"

namespace heliodon::geometry {

constexpr double kParallelSine = 0.18;   // 10 degrees: walls side by side
constexpr double kNarrowSlot = 1.0;      // inches between walls side by side: less is a crack,
constexpr double kNarrowestNiche = 0.45; // but for a niche so wide

// Adds solids where ends of walls lie within `width` (inches) of one another or of a face, where a corner was
// left open, between walls side by side, and where a curved wall runs by another one.
void fillCracks(PlanWalls& plan, double width);

// Takes the fillings of corners as wide as a door out again where rooms are on both sides: in an outer wall
// they are gaps, within they are doors. True if there were any.
bool openDoorsInCorners(PlanWalls& plan, const std::vector<RoomPlan>& rooms);

// A partition that stops a hair (0.3 in) short of a wall was meant to touch it, one that looks out of its
// other side by a hair to end there.
void reachWalls(PlanWalls& plan);

} // namespace heliodon::geometry
