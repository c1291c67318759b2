// The solid walls of a plan -> the rooms that were meant: outlines of closed air, each edge with what stands
// behind it.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>

#include "geometry/plan_walls.h"

namespace heliodon::geometry {

struct OutlineEdge {
    int piece = -1;    // the wall that stands there; -1: a filled crack or a bridged gap
    bool gap = false;  // bridged: nothing stands there, not even the filling of a crack
    double height = 0; // inches: of the wall that stands there, 0 for none
};

// Air on the left: outlines counter-clockwise, islands clockwise. Edge k runs from point k to point k + 1.
struct OutlineLoop {
    std::vector<glm::dvec2> points;
    std::vector<OutlineEdge> edges;
};

struct RoomPlan {
    std::vector<OutlineLoop> loops; // the outline first
    double area = 0;                // square inches, net of islands
    double widestGap = 0;           // inches: the widest opening that had to be bridged
};

bool contains(const RoomPlan& room, glm::dvec2 p);

struct PlanRooms {
    std::vector<RoomPlan> rooms; // from left to right by their lowest point
    // Per piece, for its right and its left face: stretches of its centre line, in inches from its end a,
    // along which a room's air is there.
    std::vector<std::array<std::vector<std::pair<double, double>>, 2>> seen;
    // Without rooms: the largest space that was none, as it is too open or too narrow; may be empty.
    RoomPlan nearest;
    bool nearestIsNarrow = false;
    std::vector<std::string> outside; // sentences: what is no room, though nearly a lobby
};

PlanRooms findRooms(const PlanWalls& plan);

// Takes out steps under 0.12 in, straight corners and spikes, makes facets even (plan_curves.h) and parts
// outlines that touch in a point.
void cleanOutlines(const PlanWalls& plan, PlanRooms& rooms);

} // namespace heliodon::geometry
