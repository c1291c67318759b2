// What speaks for a wall, where a patch, a hand or the noise of a dark table could have been read as one.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "geometry/sketch.h"
#include "vision/color_classes.h"
#include "vision/plan_view.h"

namespace heliodon::vision {

constexpr double kOverEdge = 3; // inches that a wall may stick out over the table

// What is seen of one end: nothing but the white of the table, what is brighter than that and as colourless,
// as card nearer to the lamps is, or anything else, which may hide the end.
enum class EndLook { bare, card, other };

// What a wall shows of its height, as parts of the level of light there. All are near nothing where a pen,
// tape or a cable lies flat. And its paint: what a lens or a file's compression smears beside walls is paler
// than theirs, or interrupted.
struct Relief {
    std::array<float, 2> ends{}; // WallEvidence::endSteps
    std::optional<float> foot;   // step of light where a face meets the table; none: no face is seen
    float saturation = 1;        // WallEvidence::saturationOf
    double painted = 1;          // WallEvidence::paintedShareOf
    std::array<EndLook, 2> looks{};
};

// Of things with the colour and the shape of walls, those that are none: where others show relief, they have
// neither a bright end nor a foot, or lack an end and much of the paint, or lack both ends, which nothing
// hides, where nearly all others have theirs. Unsure: ends that hardly are bright, and no face would be seen
// either, as below the camera, or something there may be another's; or one bright end and vivid paint as far
// as where the other is hidden.
enum class Lies { no, unsure, flat };
std::vector<Lies> lieFlat(const std::vector<Relief>& reliefs);

// Whether a quarter of them show bright ends, or a foot.
bool showRelief(const std::vector<Relief>& reliefs);

// Refers to what it is made of. `radius` of the table: inches.
class WallEvidence {
public:
    WallEvidence(const ClassImage& image, const PlanView& view, const DetectOptions& options, double radius)
        : image_(image), view_(view), options_(options), radius_(radius) {}

    using Line = std::vector<glm::dvec2>; // plan

    // Its paint covers it and has something else on either side, and not both ends, which are white card,
    // look like a table of another colour or the floor. None is shorter than its two unpainted ends. The
    // floor's colour along the table's edge is none.
    bool isWall(const geometry::Wall& wall) const;
    bool isWall(const geometry::Arc& arc) const;

    // More than half of it over the table, nothing far from it.
    bool standsOnTable(const geometry::Wall& wall) const;
    bool standsOnTable(const geometry::Arc& arc) const;

    Relief reliefOf(const geometry::Wall& wall) const;
    Relief reliefOf(const geometry::Arc& arc) const;

    // The middles of the two unpainted ends.
    Line endsOf(const geometry::Wall& wall) const;
    Line endsOf(const geometry::Arc& arc) const;

    // How much brighter each white end is than what is beside it, over the level there.
    std::array<float, 2> endSteps(const geometry::Wall& wall) const;
    std::array<float, 2> endSteps(const geometry::Arc& arc) const;

    // Share of its top between the ends that has any paint; 1 where nothing is between them.
    double paintedShareOf(const geometry::Wall& wall) const;

    // Median of its paint's P' between the ends, 0 to 1; 0 outside the picture.
    float saturationOf(const geometry::Wall& wall) const;
    float saturationOf(const geometry::Arc& arc) const;

    // Where its top is of another shade (light blue, orange), which is no wall's paint but goes with blue or
    // red, along at least half an inch but not most of it: middles of these stretches.
    Line otherShadeOn(const geometry::Wall& wall, Paint shade) const;

    // Mean light at a place over what white returns there; none outside the picture.
    std::optional<glm::vec3> overWhite(glm::dvec2 plan, double height) const;

    // Places a little beyond those of its ends past which a strip goes on, as bright over what is beside it
    // as the ends are.
    Line goesOnTo(const geometry::Wall& wall) const;
    Line goesOnTo(const geometry::Arc& arc) const;

    // Inches in plan from a point to the middle line.
    double distance(const geometry::Wall& wall, glm::dvec2 plan) const;
    double distance(const geometry::Arc& arc, glm::dvec2 plan) const;

private:
    template<class Shape> Line goesOnBeyond(const Shape& shape) const;
    template<class Shape> bool isWallWithEnds(const Shape& shape) const;
    bool isWall(const Line& painted, Paint paint, glm::dvec2 end, glm::dvec2 otherEnd) const;
    bool isStripOfPaint(const Line& painted, Paint paint) const;
    // Half of it is seen where the table's edge is, with the colour that the floor has there: blur mixes it
    // with the table's light, and a file that rounds colours keeps it in squares of 16 pixels.
    bool isRim(const Line& painted, double height) const;
    struct Stretch { // of a face's lower edge
        Line foot;
        glm::dvec2 outward{};
    };
    template<class Shape> std::array<float, 2> stepsOfEnds(const Shape& shape) const;
    template<class Shape> float medianSaturation(const Shape& shape) const;
    template<class Shape> Relief reliefOfShape(const Shape& shape) const;
    template<class Shape> std::vector<Stretch> stretchesOf(const Shape& shape) const;
    std::optional<float> footStep(const Stretch& stretch, double height) const;
    float endStep(glm::dvec2 end, glm::dvec2 outward, double height) const;
    EndLook lookOf(glm::dvec2 end, double height) const;
    float levelAt(glm::dvec2 plan, double height) const;
    bool isBare(glm::dvec2 end, double height) const;
    bool standsOnTable(const Line& centre) const;
    Paint paintSeen(glm::dvec2 plan, double height) const;

    const ClassImage& image_;
    const PlanView& view_;
    const DetectOptions& options_;
    double radius_;
};

} // namespace heliodon::vision
