// Direct sun on patches and at points: everything is projected along the sun, then polygons are clipped
// exactly in double precision. The sun is a point; glass counts with its transmittance at the sun's angle. A
// ray towards the sun passes each pane that it leaves by (front to back); that an interior window has two
// faces therefore does not count twice. Opaque patches of every room block, from both sides.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "geometry/patch_mesh.h"

namespace heliodon::compute {

// What does not depend on where the sun stands: glass and opaque matter as few large convex polygons, so that
// the cost of a sun hardly depends on how finely they are meshed. About 10 ms for 2000 patches.
class SunScene {
public:
    explicit SunScene(const geometry::PatchMesh& mesh); // `mesh` must outlive this

private:
    friend class SunPatches;
    struct Region {
        std::vector<glm::dvec3> corners; // counter-clockwise about the normal
        glm::dvec3 normal{0};
        uint32_t material = 0;
        bool interior = false; // glass between two rooms
    };
    void add(const std::vector<uint32_t>& patches, uint32_t material, bool interior,
             std::vector<Region>& regions) const;

    const geometry::PatchMesh* mesh_;
    std::vector<Region> panes_, opaque_;
    std::vector<glm::dvec3> normals_; // of patches
    double scale_ = 1;                // extent of the mesh
};

class SunPatches {
public:
    // `towardsSun` unit, world. About 0.1 ms for 2000 patches; `scene` must outlive this.
    SunPatches(const SunScene& scene, glm::dvec3 towardsSun);
    // Makes its own scene.
    SunPatches(const geometry::PatchMesh& mesh, glm::dvec3 towardsSun);

    // False when no opening faces the sun from outside: every result is zero then.
    bool canEnter() const { return !openings_.empty(); }

    // Per patch and channel: illuminance over the sun's normal illuminance, averaged over the patch: lit
    // fraction times cosine times transmittance. About 1 ms for 2000 patches.
    std::vector<glm::vec3> onPatches() const;

    // The same at a point of the air of room `room` with unit normal.
    glm::vec3 atPoint(glm::dvec3 position, glm::dvec3 normal) const;

private:
    SunPatches(std::shared_ptr<const SunScene> own, glm::dvec3 towardsSun);
    struct Face {                        // seen from the sun
        std::vector<glm::dvec2> outline; // counter-clockwise
        glm::dvec2 low, high;
        const SunScene::Region* region;
        glm::dvec3 transmittance{0}; // at the sun's angle; glazing only
    };
    struct Receiver {
        uint32_t patch;
        std::vector<glm::dvec2> outline; // counter-clockwise
        glm::dvec2 low, high;
        double area;
    };
    struct Piece {
        std::vector<glm::dvec2> outline;
        glm::dvec3 transmittance;
    };
    glm::dvec2 project(glm::dvec3 p) const { return {dot(p, across_), dot(p, up_)}; }
    static double dot(glm::dvec3 a, glm::dvec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    Face face(const SunScene::Region& region, double facing) const;
    // The part of a face in front of a plane, as the sun sees it; empty when there is none.
    std::vector<glm::dvec2> inFrontOf(const Face& face, glm::dvec3 point, glm::dvec3 normal) const;
    glm::dvec3 onPatch(const Receiver& receiver) const;
    double visibleArea(const std::vector<glm::dvec2>& outline, uint32_t receiver) const;

    std::shared_ptr<const SunScene> own_; // when made from a mesh
    const SunScene* scene_;
    const geometry::PatchMesh* mesh_;
    glm::dvec3 sun_, across_, up_;
    std::vector<Face> openings_; // glazing that a ray towards the sun leaves by
    std::vector<Face> opaque_;
};

} // namespace heliodon::compute
