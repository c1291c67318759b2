// Pieces of sketches that tests lay out by hand.
#pragma once

#include <string>

#include "geometry/sketch.h"

namespace heliodon::test {

inline geometry::Wall wall(const std::string& id, glm::dvec2 a, glm::dvec2 b,
                           geometry::HeightClass height = geometry::HeightClass::red) {
    geometry::Wall w;
    w.id = id;
    w.a = a;
    w.b = b;
    w.heightClass = height;
    return w;
}

inline geometry::WindowMarker window(const std::string& id, const std::string& on, double pos, double width) {
    geometry::WindowMarker w;
    w.id = id;
    w.wall = on;
    w.pos = pos;
    w.width = width;
    return w;
}

} // namespace heliodon::test
