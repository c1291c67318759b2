// Shadows of convex solids and the border of a projector's picture, on a plane.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "geometry/patch_mesh.h"
#include "geometry/rig.h"

namespace heliodon::geometry {

struct ConvexSolid {
    std::vector<glm::dvec3> corners;
    std::vector<std::pair<uint32_t, uint32_t>> edges;
};

// The connected parts of the occluders, each of which must be convex (as those of closeSketch are).
std::vector<ConvexSolid> convexSolids(const Occluders& occluders);

struct PlaneFrame {
    glm::dvec3 origin{}, u{}, v{}, normal{};
    glm::dvec2 flat(glm::dvec3 p) const;
    glm::dvec3 inSpace(glm::dvec2 p) const { return origin + p.x * u + p.y * v; }
};

struct ConvexOutline {
    std::vector<glm::dvec2> points; // counter-clockwise
    glm::dvec2 low{}, high{};
    bool contains(glm::dvec2 p) const; // strictly
};

struct FlatBox {
    glm::dvec2 low{}, high{};
};

// What the solid hides of the front of the plane from a light at `light`; empty when nothing of it lies in
// the box. The part of the
// solid that lies less than `skin` in front of the plane casts none, so that a wall does not shadow its own
// face.
ConvexOutline shadowOnPlane(const ConvexSolid& solid, glm::dvec3 light, const PlaneFrame& plane, double skin,
                            const FlatBox& within);

// Inward normals of the four planes through the device's centre that bound its picture, from the inside.
std::array<glm::dvec3, 4> pictureBorders(const OpticalDevice& device);

} // namespace heliodon::geometry
