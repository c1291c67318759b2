// Where short words go beside what they name, so that none covers another or what is named.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

namespace heliodon::passes {

// Pixels, y down.
struct Box {
    glm::dvec2 low{}, high{};

    bool covers(const Box& other) const {
        return low.x < other.high.x && other.low.x < high.x && low.y < other.high.y && other.low.y < high.y;
    }
    bool contains(const Box& other) const {
        return low.x <= other.low.x && low.y <= other.low.y && other.high.x <= high.x &&
               other.high.y <= high.y;
    }
    bool operator==(const Box&) const = default;
};

struct Label {
    std::vector<glm::dvec2> outline; // of what it names: a polygon or a point, not empty
    glm::dvec2 size{};               // of the words
    // The side that is wanted; it may be its length in pixels further away there than crosswise.
    glm::dvec2 towards{};

    bool operator==(const Label&) const = default;
};

using Line = std::array<glm::dvec2, 2>;

// A box for each label, within `within` and as near to its outline's middle as it goes without covering
// another box or coming closer than `clear` to an outline; off `lines` where that takes it little further.
// Where nothing is free, where it covers least. Cost: labels^2 and the pixels of `within`; milliseconds.
std::vector<Box> placeLabels(std::span<const Label> labels, const Box& within, double clear,
                             std::span<const Line> lines = {});

} // namespace heliodon::passes
