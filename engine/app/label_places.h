// Where short words go beside the marks of a plot, so that none covers another or a mark.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

namespace heliodon::app {

// Pixels, y down.
struct Box {
    glm::dvec2 low, high;

    bool covers(const Box& other) const {
        return low.x < other.high.x && other.low.x < high.x && low.y < other.high.y && other.low.y < high.y;
    }
};

struct Label {
    glm::dvec2 mark; // middle of what it names
    glm::dvec2 size; // of the words
};

// A box for each label, right of its mark where there is room and in rings about it elsewhere: first without
// covering labels and marks or leaving `within`, then off `lines`, then near. Cost: labels^2.
std::vector<Box> placeLabels(std::span<const Label> labels, double markRadius, const Box& within,
                             std::span<const std::array<glm::dvec2, 2>> lines);

} // namespace heliodon::app
