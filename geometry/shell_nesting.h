// Which of several closed shells bound rooms, and which are solids that stand in their air.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/patch_mesh.h"
#include "geometry/ray_triangle.h"

namespace heliodon::geometry {

struct ShellNesting {
    std::vector<uint32_t> room; // per shell: the room that it bounds or stands in; kNoRoom: see below
    std::vector<bool> inverted; // per shell: its triangles look away from the air
    uint32_t rooms = 0;
    uint32_t solidsThatLookIn = 0; // drawn as the shell of the room is that they stand in
    uint32_t bodies = 0;           // that stand outside: counted as rooms, in `room`, after `rooms`
};

// The outermost shell bounds a room, a shell within it is a solid that stands in the room's air, and so on
// inwards. But an outermost shell that is more than half filled by those within it is the outside of walls
// that have a thickness, unless it looks inwards and all of those outwards; and so is one that looks
// outwards, an eighth or more filled by shells that look inwards: it bounds no room, those within it do. Nor
// does a shell with nothing in it and without glass that looks outwards, where rooms that look inwards have
// some: a neighbour, the ground. Each shell is closed, its triangles look to one side; shells do not cross.
// Cost: shells times triangles.
ShellNesting nestShells(const std::vector<std::vector<ShellTriangle>>& shells,
                        const std::vector<bool>& hasGlass);

// Of what closed triangles enclose, negative where they look out of it.
double volumeWithin(const std::vector<ShellTriangle>& shell);

// How many times a ray from p along kOddWay passes through the shell: odd for points inside.
int crossings(const std::vector<ShellTriangle>& shell, glm::dvec3 p);

} // namespace heliodon::geometry
