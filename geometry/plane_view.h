// What one projector sees of a flat piece of surface: its picture, without the shadows of solids and without
// what it would light too flatly.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "geometry/shadow_outline.h"

namespace heliodon::geometry {

struct PlaneView {
    bool seen = false; // false: nothing of the piece
    double height = 0; // of the projector over the plane, metres
    // Radius round the foot within which n . d is large enough; infinite where all of the piece lies within.
    double reach = 0;
    glm::dvec2 foot{};
    std::vector<ConvexOutline> shadows;
    // Of the picture, those that the piece crosses: inside where dot(first, p) > second.
    std::vector<std::pair<glm::dvec2, double>> borders;

    bool reaches(glm::dvec2 p) const;
};

// A projector with the solids before it, both of which must outlive this.
struct Beam {
    Beam(const OpticalDevice& projector, std::span<const ConvexSolid> casters);
    const OpticalDevice& projector;
    glm::dvec3 centre;
    std::array<glm::dvec3, 4> borders; // of the picture
    std::span<const ConvexSolid> casters;
    std::vector<std::optional<ImageOutline>> outlines; // per caster
};

// `hull`: convex polygon, counter-clockwise, that the piece of the plane lies in. Shadows that miss the box
// round it are left out.
PlaneView viewOfPlane(const PlaneFrame& plane, std::span<const glm::dvec2> hull, const Beam& beam,
                      double leastCosine);

using Segment = std::array<glm::dvec2, 2>;
// Appends the border of what the view reaches, as far as it lies in the box. The circle where n . d has its
// least value is followed by chords to within 0.2 mm. `limit`: further lines at which the piece ends for the
// projector, of which what lies in the picture and in no shadow is appended too.
void appendOutline(const PlaneView& view, const FlatBox& box, std::span<const Segment> limit,
                   std::vector<Segment>& out);

} // namespace heliodon::geometry
