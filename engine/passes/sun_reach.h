// What the sun may reach of what is drawn, from above: triangles that face it and lie, seen from it, behind
// panes. Nothing else needs the sun's pass, nor shadows of anything that does not lie before or behind them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/passes/draw_mesh.h"
#include "engine/passes/tile_mask.h"
#include "geometry/patch_mesh.h"

namespace heliodon::passes {

// The plane across the sun's rays. Everything is taken for somewhat larger than it is.
class SunPlane {
public:
    // Over all places of the mesh.
    SunPlane(const geometry::PatchMesh& mesh, glm::dvec3 towardsSun);

    void mark(std::span<const glm::vec3> points);
    bool touches(std::span<const glm::vec3> points) const;

private:
    struct Box {
        glm::dvec2 low, high; // tiles
    };
    Box boxOf(std::span<const glm::vec3> points) const;

    glm::dvec3 across_, up_;
    glm::dvec2 low_{0};
    double perTile_ = 1; // metres
    TileMask mask_;
};

struct SunReach {
    std::vector<uint32_t> corners; // of DrawMesh, three a triangle
    SunPlane plane;                // marked where they lie
};

// `closed`: the sun enters through openings alone.
SunReach sunReach(const geometry::PatchMesh& mesh, const DrawMesh& drawn, glm::dvec3 towardsSun, bool closed);

} // namespace heliodon::passes
