// How much glass a model has and where in it: what a file says of its panes holds while that stays the same.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include <glm/vec3.hpp>

namespace heliodon::geometry {

struct GlassMark {
    uint32_t panes = 0; // faces of glass
    // Root mean squares of how far their middles are from the least x, y and z of all faces, of the diagonal
    // of the box round these: in [0, 1], whatever the unit, the origin and the order of the faces.
    glm::dvec3 place{0};

    // To what six decimals of coordinates leave.
    bool agrees(const GlassMark& other) const;
};

// Of faces with the corners corners[firstCorner[i] .. firstCorner[i + 1]).
GlassMark glassMark(std::span<const glm::dvec3> vertices, std::span<const uint32_t> corners,
                    std::span<const uint32_t> firstCorner, const std::function<bool(size_t)>& isGlass);

} // namespace heliodon::geometry
