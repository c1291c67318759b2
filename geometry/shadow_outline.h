// Shadows of convex solids and the border of a projector's picture, on a plane.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <glm/common.hpp>
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

struct FlatBox {
    glm::dvec2 low{1e300}, high{-1e300};
    void grow(glm::dvec2 p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    bool meets(const FlatBox& other) const { // in more than a border
        return low.x < other.high.x && low.y < other.high.y && high.x > other.low.x && high.y > other.low.y;
    }
    bool touches(const FlatBox& other) const {
        return low.x <= other.high.x && low.y <= other.high.y && high.x >= other.low.x &&
               high.y >= other.low.y;
    }
};
inline FlatBox boxOf(std::span<const glm::dvec2> points) {
    FlatBox box;
    for (const glm::dvec2 p : points) box.grow(p);
    return box;
}

struct PlaneFrame {
    glm::dvec3 origin{}, u{}, v{}, normal{};
    glm::dvec2 flat(glm::dvec3 p) const;
    glm::dvec3 inSpace(glm::dvec2 p) const { return origin + p.x * u + p.y * v; }
};

struct ConvexOutline {
    std::vector<glm::dvec2> points; // counter-clockwise
    FlatBox box;
    bool contains(glm::dvec2 p) const; // strictly
};

// The solid in the image plane of a device at distance one, where all of it lies before the device.
struct ImageOutline {
    std::vector<uint32_t> corners;  // those on the outline, counter-clockwise as the device sees them
    std::vector<glm::dvec2> points; // their images
    FlatBox box;
};
std::optional<ImageOutline> imageOutline(const ConvexSolid& solid, const OpticalDevice& device);
// The image of a point that lies before the device by more than a millionth of a metre.
std::optional<glm::dvec2> imageOf(glm::dvec3 p, const OpticalDevice& device);

// What the solid hides of the front of the plane from a light at `light`; empty when nothing of it lies in
// the box. A solid that rises less than `skin` over the plane casts no shadow, so that a wall does not shadow
// its own face. `outline`: the solid's as seen from the light, which saves looking for it; may be null.
ConvexOutline shadowOnPlane(const ConvexSolid& solid, const ImageOutline* outline, glm::dvec3 light,
                            const PlaneFrame& plane, double skin, const FlatBox& within);

// Inward normals of the four planes through the device's centre that bound its picture, from the inside.
std::array<glm::dvec3, 4> pictureBorders(const OpticalDevice& device);

} // namespace heliodon::geometry
