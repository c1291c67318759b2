// The currency between geometry, light and drawing: closed rooms as planar convex patches with materials and
// roles. Metres, y up. Faces are counter-clockwise seen from the air of the room; normals point into the air.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/blind.h"

namespace heliodon::geometry {

enum class Role : uint8_t {
    projection, // a physical wall or the table shows it
    fillIn,     // ceiling, bridged gap, glass of a skylight: simulated, not shown
    extra       // physical but not in any room: not simulated, drawn black, occludes projectors
};

// Values per linear Rec. 709 channel.
struct Material {
    std::string name;
    glm::vec3 reflectance{0};      // diffuse, [0, 1)
    glm::vec3 transmittance{0};    // visible, at normal incidence, of glazing or a hole; 0 = opaque
    float refractiveIndex = 1.52f; // 1.52: absorbing slab of glass; 1: an open hole
    glm::vec3 exitance{0};         // own emission, lux
    // Of an opening; once drawn, `reflectance` is that of glass and blind together (daylight/window.h).
    Blind blind;

    bool isOpening() const { return transmittance.x > 0 || transmittance.y > 0 || transmittance.z > 0; }
};

constexpr int32_t kNoTwin = -1;
constexpr uint32_t kNoRoom = UINT32_MAX; // of what is in no room

// The physical objects on the table as closed opaque solids: what stands between a projector and a surface.
// Whole walls with their true thickness and height, whether or not a room uses them. Empty for imported
// models, whose own faces stand for them.
struct Occluders {
    std::vector<glm::dvec3> vertices;
    std::vector<uint32_t> triangles; // three indices each, counter-clockwise seen from outside the solid
    std::vector<uint32_t> material;  // per triangle, into the materials of who holds this; empty: all black
};

struct PatchMesh {
    std::vector<glm::dvec3> vertices;
    // Patch i has the corners corners[firstCorner[i] .. firstCorner[i + 1]); usually three, any planar convex
    // polygon is fine.
    std::vector<uint32_t> corners;
    std::vector<uint32_t> firstCorner{0};
    std::vector<uint32_t> material; // per patch, into `materials`
    std::vector<Role> role;         // per patch; never `extra` (extras are in Occluders)
    std::vector<uint32_t> surface;  // per patch: its flat or smoothly curved surface; light is interpolated
                                    // within one surface only
    std::vector<uint32_t> room;     // per patch: connected air volume; rooms do not see one another
    std::vector<int32_t>
        twin; // per patch: the patch of the same glass on the other side of an interior window, else kNoTwin.
              // Twins have equal shape; what falls on one leaves the other (times transmittance)
    std::vector<Material> materials;
    Occluders outside; // as Building::outside

    size_t patchCount() const { return firstCorner.size() - 1; }
    std::span<const uint32_t> patch(size_t i) const {
        return {corners.data() + firstCorner[i], firstCorner[i + 1] - firstCorner[i]};
    }
    void addPatch(std::span<const uint32_t> indices, uint32_t materialIndex, Role r, uint32_t surfaceId,
                  uint32_t roomId);
};

// Corners of a patch, in its order.
std::vector<glm::dvec3> patchCorners(const PatchMesh& mesh, size_t patch);

// Newell's normal with twice the area as its length; unit normal, area and centroid (area-weighted) of a
// planar polygon.
glm::dvec3 patchAreaVector(const PatchMesh& mesh, size_t patch);
double patchArea(const PatchMesh& mesh, size_t patch);
glm::dvec3 patchNormal(const PatchMesh& mesh, size_t patch);
glm::dvec3 patchCentroid(const PatchMesh& mesh, size_t patch);

// Height at which a vertical line crosses a patch that is not upright; NaN beside it. `slack`: twice the area
// by which the line may pass outside of an edge.
double heightAt(const PatchMesh& mesh, size_t patch, double x, double z, double slack);

} // namespace heliodon::geometry
