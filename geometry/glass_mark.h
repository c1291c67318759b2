// How much glass a model has and where in it: what a file says of its panes holds while that stays the same.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace heliodon::geometry {

struct GlassMark {
    uint32_t panes = 0; // faces of glass
    // Root mean squares of how far their middles are from the least x, y and z of all faces, of the diagonal
    // of the box round these: in [0, 1], whatever the unit, the origin and the order of the faces.
    glm::dvec3 place{0};
    // Sums, with weights of 0.5 to 1.5 and either sign that follow from a pane's number, of how far their
    // middles are from the middle of that box, of its diagonal: one pane of thousands that moved shows, and
    // so does another order. Marks of older files have none.
    std::optional<glm::dvec3> checksum;

    // To what six decimals of coordinates leave. Where the axes have been swapped or turned round, by the
    // checksums alone.
    bool agrees(const GlassMark& other) const;
};

// Of faces with the corners corners[firstCorner[i] .. firstCorner[i + 1]), those of glass in the order of the
// file.
GlassMark glassMark(std::span<const glm::dvec3> vertices, std::span<const uint32_t> corners,
                    std::span<const uint32_t> firstCorner, std::span<const size_t> glass);

// As it stands in files: PANES X Y Z, then the three checksums or nothing.
constexpr const char* kGlassMarkForm = "PANES X Y Z A B C";
std::vector<double> numbersOf(const GlassMark& mark); // to 1e-7, with checksums
std::optional<GlassMark> glassMark(std::span<const double> numbers);

} // namespace heliodon::geometry
