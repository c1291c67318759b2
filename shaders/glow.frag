// Light that varies within triangles: linear between the places of a grid over each (compute/sun_glow.h).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/glow.io.h"

layout(location = 0) in vec3 pointInWorld;
layout(location = 1) in vec3 place; // along two edges of the triangle, 0 to 1, and the number of its grid
layout(set = 0, binding = 0, scalar) readonly buffer Grids { vec3 grids[]; }; // kilolux, kGlowPlaces each

layout(location = 0) out vec4 colour;

vec3 at(int grid, ivec2 node) {
    int beforeRow = node.y * (2 * int(kGlowCells) + 3 - node.y) / 2;
    return grids[grid + beforeRow + node.x];
}

void main() {
    const int cells = int(kGlowCells);
    vec2 scaled = float(cells) * clamp(place.xy, 0.0, 1.0);
    ivec2 cell = min(ivec2(scaled), cells - 1);
    cell.x = min(cell.x, cells - 1 - cell.y);
    vec2 share = scaled - vec2(cell);
    int grid = int(place.z + 0.5) * int(kGlowPlaces);
    // The cell's lower triangle, or seen from its far corner the upper one, which the last cell of a row lacks.
    bool far = share.x + share.y > 1.0 && cell.x + cell.y < cells - 1;
    ivec2 corner = far ? cell + 1 : cell;
    int towards = far ? -1 : 1;
    if (far) share = 1.0 - share;
    vec3 base = at(grid, corner);
    vec3 light = base + share.x * (at(grid, corner + ivec2(towards, 0)) - base) +
                 share.y * (at(grid, corner + ivec2(0, towards)) - base);
    colour = vec4(light, 0);
}
