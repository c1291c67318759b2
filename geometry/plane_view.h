// What one projector sees of a flat piece of surface: its picture, without the shadows of solids and without
// what it would light too flatly.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/shadow_outline.h"

namespace heliodon::geometry {

struct PlaneView {
    bool seen = false; // false: nothing of the piece
    double height = 0; // of the projector over the plane, metres
    double reach = 0;  // radius round the foot within which n . d is large enough
    glm::dvec2 foot{};
    std::vector<ConvexOutline> shadows;
    std::vector<std::pair<glm::dvec2, double>> borders; // inside the picture where dot(first, p) > second

    bool reaches(glm::dvec2 p) const;
};

// A solid with the ball round it.
struct ShadowCaster {
    explicit ShadowCaster(ConvexSolid solid);
    ConvexSolid solid;
    glm::dvec3 centre{};
    double radius = 0;
};

// `hull`: convex polygon, counter-clockwise, that the piece of the plane lies in. Shadows that miss it are
// left out.
PlaneView viewOfPlane(const PlaneFrame& plane, std::span<const glm::dvec2> hull, glm::dvec3 projector,
                      const std::array<glm::dvec3, 4>& pictureBorders, double leastCosine,
                      std::span<const ShadowCaster> casters);

using Segment = std::array<glm::dvec2, 2>;
// Appends the border of what the view reaches, as far as it lies in the box from `low` to `high`. The circle
// where n . d has its least value is followed by chords to within 0.2 mm.
void appendOutline(const PlaneView& view, glm::dvec2 low, glm::dvec2 high, std::vector<Segment>& out);

} // namespace heliodon::geometry
