// From where and through what a picture is drawn. Pictures are first drawn through an ideal pinhole, so that
// straight edges stay straight (shadow volumes need that); a lens is applied afterwards, pixel by pixel.
#pragma once

#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "geometry/rig.h"

namespace heliodon::passes {

struct PixelRect {
    int x = 0, y = 0, width = 0, height = 0;
};

struct View {
    int width = 0, height = 0;   // of the pinhole picture, pixels
    glm::dmat4 clipFromWorld{1}; // Vulkan's clip space, depth reversed and infinite: depth = near / distance
    glm::dvec3 eye{0};

    // Picture drawn at the end, and for each of its pixels (row by row) the pinhole pixel that it shows
    // (integer = pixel centre). Empty: the same pixels, `supersample` x `supersample` of them averaged.
    int outputWidth = 0, outputHeight = 0, supersample = 1;
    std::vector<glm::vec2> warp;

    PixelRect shown; // the part of the output that shows the pinhole picture; the rest stays black
    std::vector<PixelRect> parts; // of `shown`, disjoint: all that is drawn of it
};

// Where triangles, three corners each, lie in the pinhole picture: rectangles of tiles that hold all of them
// and little else. `beside`: pixels added around each.
std::vector<PixelRect> placesOf(const View& view, std::span<const glm::vec3> corners, int tile,
                                double beside);

// Cuts a view with a warp down to what lies near `points`, both of its pictures: nothing else is drawn.
void confine(View& view, const std::vector<glm::dvec3>& points);
// The same for the parts of the output, tile by tile, to what lies near triangles; without any of them nothing
// is shown.
void confineParts(View& view, std::span<const glm::vec3> corners);

// What a camera or projector sees: outputs are its own panel pixels, so that a world point comes out at
// OpticalDevice::pixelFromWorld. `supersample` pinhole pixels per panel pixel in each direction. What is
// nearer than 2 cm is clipped.
View viewOfDevice(const geometry::OpticalDevice& device, int supersample = 1);

struct PerspectiveCamera {
    glm::dvec3 eye{0, 1, 1}, target{0};
    double fovDegrees = 30; // vertical
};

// An ideal camera, y up. Looking straight down is allowed (picture top = -z).
View viewOfCamera(const PerspectiveCamera& camera, int width, int height, int supersample = 1);

// The camera that looks at all `points` from the given direction (azimuth: 0 from +z, 90 from +x; elevation
// above the table), as near as they fit with `margin` left (fraction of the picture).
PerspectiveCamera frameAll(const std::vector<glm::dvec3>& points, double azimuthDegrees,
                           double elevationDegrees, double fovDegrees, double aspect, double margin = 0.04);

} // namespace heliodon::passes
