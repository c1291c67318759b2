// What speaks for a wall, where a patch, a hand or the noise of a dark table could have been read as one.
#pragma once

#include <vector>

#include "geometry/sketch.h"
#include "vision/color_classes.h"
#include "vision/plan_view.h"

namespace heliodon::vision {

constexpr double kOverEdge = 3; // inches that a wall may stick out over the table

// Refers to what it is made of. `radius` of the table: inches.
class WallEvidence {
public:
    WallEvidence(const ClassImage& image, const PlanView& view, const DetectOptions& options, double radius)
        : image_(image), view_(view), options_(options), radius_(radius) {}

    using Line = std::vector<glm::dvec2>; // plan

    // Its paint covers it and has something else on either side, and not both ends, which are white card,
    // look like a table of another colour or the floor. None is shorter than its two unpainted ends.
    bool isWall(const geometry::Wall& wall) const;
    bool isWall(const geometry::Arc& arc) const;

    // More than half of it over the table, nothing far from it.
    bool standsOnTable(const geometry::Wall& wall) const;
    bool standsOnTable(const geometry::Arc& arc) const;

    // The middles of the two unpainted ends.
    Line endsOf(const geometry::Wall& wall) const;
    Line endsOf(const geometry::Arc& arc) const;

private:
    template<class Shape> bool isWallWithEnds(const Shape& shape) const;
    bool isWall(const Line& painted, Paint paint, glm::dvec2 end, glm::dvec2 otherEnd) const;
    bool isStripOfPaint(const Line& painted, Paint paint) const;
    bool isBare(glm::dvec2 end, double height) const;
    bool standsOnTable(const Line& centre) const;
    Paint paintSeen(glm::dvec2 plan, double height) const;

    const ClassImage& image_;
    const PlanView& view_;
    const DetectOptions& options_;
    double radius_;
};

} // namespace heliodon::vision
