#include "vision/wall_evidence.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "vision/edges.h"
#include "vision/pieces.h"

namespace heliodon::vision {
namespace {

Paint paintOf(geometry::HeightClass height) {
    return height == geometry::HeightClass::red    ? Paint::red
           : height == geometry::HeightClass::blue ? Paint::blue
                                                   : Paint::green;
}

// `from`, `to`: shares of the length.
std::vector<glm::dvec2> along(const geometry::Wall& wall, double from, double to, int steps) {
    std::vector<glm::dvec2> out;
    for (int i = 0; i <= steps; ++i) out.push_back(glm::mix(wall.a, wall.b, from + (to - from) * i / steps));
    return out;
}
std::vector<glm::dvec2> along(const geometry::Arc& arc, double from, double to, int steps) {
    std::vector<glm::dvec2> out;
    for (int i = 0; i <= steps; ++i) {
        const double share = from + (to - from) * i / steps;
        const double a = glm::radians(arc.a0Deg + share * (arc.a1Deg - arc.a0Deg));
        out.push_back(arc.center + arc.radius * glm::dvec2(std::cos(a), std::sin(a)));
    }
    return out;
}

double lengthOf(const geometry::Wall& wall) {
    return glm::distance(wall.a, wall.b);
}
double lengthOf(const geometry::Arc& arc) {
    return arc.radius * glm::radians(arc.a1Deg - arc.a0Deg);
}

// Of all but the ends, every quarter of an inch.
template<class Shape> std::vector<glm::dvec2> paintedLine(const Shape& shape, double unpainted) {
    const double length = lengthOf(shape), end = unpainted / length;
    return along(shape, end, 1 - end, static_cast<int>(4 * length) + 2);
}

template<class Shape> std::vector<glm::dvec2> middlesOfEnds(const Shape& shape, double unpainted) {
    const double in = 0.5 * unpainted / lengthOf(shape);
    return along(shape, in, 1 - in, 1);
}

} // namespace

WallEvidence::Line WallEvidence::endsOf(const geometry::Wall& wall) const {
    return middlesOfEnds(wall, options_.unpaintedEnd);
}
WallEvidence::Line WallEvidence::endsOf(const geometry::Arc& arc) const {
    return middlesOfEnds(arc, options_.unpaintedEnd);
}

bool WallEvidence::isWall(const geometry::Wall& wall) const {
    return isWallWithEnds(wall);
}
bool WallEvidence::isWall(const geometry::Arc& arc) const {
    return isWallWithEnds(arc);
}
template<class Shape> bool WallEvidence::isWallWithEnds(const Shape& shape) const {
    if (lengthOf(shape) <= 2 * options_.unpaintedEnd) return false; // nothing between its ends
    const Line ends = endsOf(shape);
    return isWall(paintedLine(shape, options_.unpaintedEnd), paintOf(shape.heightClass), ends[0], ends[1]);
}
bool WallEvidence::isWall(const Line& painted, Paint paint, glm::dvec2 end, glm::dvec2 otherEnd) const {
    return isStripOfPaint(painted, paint) &&
           !(isBare(end, heightOf(paint)) && isBare(otherEnd, heightOf(paint)));
}

bool WallEvidence::isStripOfPaint(const Line& painted, Paint paint) const {
    constexpr double kCovered = 0.5, kBeside = 0.2; // share of places
    const double height = heightOf(paint), half = 0.5 * options_.wallThickness;
    // Beyond what blur reaches.
    const double out = half + std::max(0.8 * half, 2.2 / view_.pixelsPerInch(painted.front(), height));
    int covered = 0, on = 0, same = 0, beside = 0;
    for (size_t i = 1; i + 1 < painted.size(); ++i) {
        const glm::dvec2 across = turnedLeft(glm::normalize(painted[i + 1] - painted[i - 1]));
        for (const double off : {-out, out})
            same += paintSeen(painted[i] + off * across, height) == paint, ++beside;
        for (const double off : {-0.5 * half, 0.0, 0.5 * half}) {
            const Paint there = paintSeen(painted[i] + off * across, height);
            covered += there == paint || isMarker(there), ++on;
        }
    }
    return same < kBeside * beside && covered >= kCovered * on;
}

bool WallEvidence::isBare(glm::dvec2 end, double height) const {
    constexpr float kFloor = 0.35f; // of white
    constexpr double kReach = 0.1;  // inches
    glm::vec3 sum(0);
    for (const double x : {-kReach, 0.0, kReach})
        for (const double y : {-kReach, 0.0, kReach}) {
            const glm::dvec2 p = view_.pixel(end + glm::dvec2(x, y), height);
            sum += view_.light(p) / view_.white(p) / 9.0f;
        }
    const float seen = std::max({sum.r, sum.g, sum.b}), table = 1 / image_.whiteOverTable.g;
    const bool overTable = glm::length(view_.plan(view_.pixel(end, height), 0)) < radius_;
    if (!overTable) return seen < kFloor;
    return table < 1 && seen < 0.8f * std::sqrt(table); // nearer to the table than to card
}

Paint WallEvidence::paintSeen(glm::dvec2 plan, double height) const {
    return image_.groupAt(view_.pixel(plan, height));
}

bool WallEvidence::standsOnTable(const geometry::Wall& wall) const {
    return standsOnTable(along(wall, 0, 1, 10));
}
bool WallEvidence::standsOnTable(const geometry::Arc& arc) const {
    return standsOnTable(along(arc, 0, 1, 10));
}
bool WallEvidence::standsOnTable(const Line& centre) const {
    size_t on = 0;
    for (const glm::dvec2& p : centre) {
        if (glm::length(p) > radius_ + kOverEdge) return false;
        on += glm::length(p) < radius_;
    }
    return 2 * on > centre.size();
}

} // namespace heliodon::vision
