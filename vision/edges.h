// Sub-pixel edges, measured in plan inches, and the robust fits through them.
#pragma once

#include <optional>
#include <vector>

#include <glm/vec2.hpp>

#include "vision/plan_view.h"

namespace heliodon::vision {

// What an edge is an edge of.
enum class EdgeLook {
    light,
    colour,  // a white face, lit or in shadow, beside the paint is nothing then; noisier
    encoded, // values as a display takes them (about the square root of light)
};

// Looks across an edge that is expected at `at`: from `inside` inches before it to `outside` inches behind it
// along `outward` (unit). `lateral` runs along the edge; the picture is averaged from -lateral to +lateral.
struct EdgeProbe {
    glm::dvec2 at{}, outward{}, lateral{};
    double height = 0; // inches over the table
    double inside = 0.16, outside = 0.2;
    int lateralSamples = 3;
    EdgeLook look = EdgeLook::light;
};

// Where the profile crosses half the way between the two sides' levels, nearest to the expected place, in
// inches along `outward` from `at`. A lens blurs an edge symmetrically in light, so there this is the edge
// itself; a picture that was scaled or smoothed afterwards was so in encoded values, where light puts a dark
// strip's edges up to half a pixel outwards. None without contrast.
std::optional<double> findEdge(const PlanView& view, const EdgeProbe& probe);

struct LineFit {
    double offset = 0, slope = 0; // y = offset + slope x
    double rms = 0;               // of the points kept
    size_t kept = 0;
};

// Least squares, with points that lie further off than `outlier`, then than three robust deviations, rejected
// in turn.
std::optional<LineFit> fitLine(const std::vector<glm::dvec2>& points, double outlier);

struct Pca {
    glm::dvec2 mean{}, axis{1, 0}; // axis: unit, along the largest spread
    double major = 0, minor = 0;   // standard deviations
    double low = 0, high = 0;      // extent along the axis, relative to the mean
};
Pca principalAxes(const std::vector<glm::dvec2>& points);

constexpr glm::dvec2 turnedLeft(glm::dvec2 v) {
    return {-v.y, v.x};
}

} // namespace heliodon::vision
