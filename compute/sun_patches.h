// Direct sun on patches and at points: everything is projected along the sun, then polygons are clipped
// exactly in double precision. The sun is a point; glass counts with its transmittance at the sun's angle. A
// ray towards the sun passes each pane that it leaves by (front to back); that an interior window has two
// faces therefore does not count twice. Opaque patches of every room block, from both sides.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "geometry/patch_mesh.h"

namespace heliodon::compute {

class SunPatches {
public:
    // `towardsSun` unit, world. O(n); `mesh` must outlive this.
    SunPatches(const geometry::PatchMesh& mesh, glm::dvec3 towardsSun);

    // False when no opening faces the sun from outside: every result is zero then.
    bool canEnter() const { return !openings_.empty(); }

    // Per patch and channel: illuminance over the sun's normal illuminance, averaged over the patch: lit
    // fraction times cosine times transmittance. About 10 ms for 2000 patches.
    std::vector<glm::vec3> onPatches() const;

    // The same at a point of the air of room `room` with unit normal.
    glm::vec3 atPoint(glm::dvec3 position, glm::dvec3 normal) const;

private:
    struct Face {                        // seen from the sun
        std::vector<glm::dvec2> outline; // counter-clockwise
        glm::dvec2 low, high;
        uint32_t patch;
        glm::dvec3 transmittance{0}; // at the sun's angle; glazing only
    };
    struct Piece {
        std::vector<glm::dvec2> outline;
        glm::dvec3 transmittance;
    };
    glm::dvec2 project(glm::dvec3 p) const { return {dot(p, across_), dot(p, up_)}; }
    static double dot(glm::dvec3 a, glm::dvec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    // The part of a patch in front of a plane, as the sun sees it; empty when there is none.
    std::vector<glm::dvec2> inFrontOf(uint32_t patch, glm::dvec3 point, glm::dvec3 normal) const;
    glm::dvec3 onPatch(const Face& receiver) const;
    double visibleArea(const std::vector<glm::dvec2>& outline, uint32_t receiver) const;

    const geometry::PatchMesh* mesh_;
    glm::dvec3 sun_, across_, up_;
    double scale_ = 1;           // extent of the mesh
    std::vector<Face> openings_; // glazing that a ray towards the sun leaves by
    std::vector<Face> opaque_;
    std::vector<Face> receivers_; // patches that face the sun
};

} // namespace heliodon::compute
