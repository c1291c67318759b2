// Pieces of sketches that tests lay out by hand.
#pragma once

#include <cmath>
#include <numbers>
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

inline glm::dvec2 turned(glm::dvec2 p, double degrees) {
    const double a = degrees * std::numbers::pi / 180;
    return {std::cos(a) * p.x - std::sin(a) * p.y, std::sin(a) * p.x + std::cos(a) * p.y};
}

inline geometry::Sketch turned(geometry::Sketch s, double degrees) { // of straight walls
    for (geometry::Wall& w : s.walls) w.a = turned(w.a, degrees), w.b = turned(w.b, degrees);
    return s;
}

} // namespace heliodon::test
