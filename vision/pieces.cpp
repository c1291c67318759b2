#include "vision/pieces.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "geometry/sketch.h"
#include "vision/wall_evidence.h"
#include "vision/wall_fit.h"

namespace heliodon::vision {

std::vector<glm::dvec2> planPoints(const Component& component, const PlanView& view, double height) {
    std::vector<glm::dvec2> points;
    points.reserve(static_cast<size_t>(component.area));
    const int step = component.area > 1500 ? 2 : 1;
    for (const Run& run : component.runs) {
        for (int x = run.x0; x < run.x1 - 1; x += step)
            points.push_back(view.plan(glm::dvec2(x, run.y), height));
        points.push_back(view.plan(glm::dvec2(run.x1 - 1, run.y), height));
    }
    return points;
}

double stripSpread(const PlanView& view, glm::dvec2 plan, double height, const DetectOptions& options) {
    return (options.wallThickness + 1.5 / view.pixelsPerInch(plan, height)) / std::sqrt(12.0);
}

geometry::HeightClass heightClassOf(Paint wallPaint) {
    using geometry::HeightClass;
    return wallPaint == Paint::red    ? HeightClass::red
           : wallPaint == Paint::blue ? HeightClass::blue
                                      : HeightClass::green;
}

double heightOf(Paint wallPaint) {
    return geometry::heightInches(heightClassOf(wallPaint));
}

int smallestArea(const PlanView& view) {
    const double perInch = view.pixelsPerInch(glm::dvec2(0), 0);
    return std::max(4, static_cast<int>(kSmallestRegion * perInch * perInch));
}

bool canStandOnTable(const Component& region, const PlanView& view, double radius) {
    constexpr double kHigh = 10; // inches, of markers, which may stand on any wall
    const double height = isWallPaint(region.group) ? heightOf(region.group) : kHigh;
    return glm::length(view.plan(region.centre, height)) < radius + kOverEdge;
}

} // namespace heliodon::vision
