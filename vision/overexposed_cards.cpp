#include "vision/overexposed_cards.h"

#include <algorithm>
#include <optional>

#include <glm/geometric.hpp>

#include "vision/chroma.h"
#include "vision/components.h"
#include "vision/table_marks.h"

namespace heliodon::vision {
namespace {

constexpr uint8_t kClipped = 250;

const uint8_t* bytesAt(const Photograph& photo, int x, int y) {
    return &photo.rgb[3 *
                      (static_cast<size_t>(y) * static_cast<size_t>(photo.width) + static_cast<size_t>(x))];
}

// Where two channels are at the end of the scale no hue is left, and light-blue card's first is the blue.
bool isLost(const Photograph& photo, int x, int y) {
    const uint8_t* p = bytesAt(photo, x, y);
    return p[2] > kClipped || std::min(p[0], p[1]) > kClipped;
}

// Of half of the card or more.
bool isRedLost(const Photograph& photo, const Component& card) {
    int lost = 0;
    for (const Run& run : card.runs)
        for (int x = run.x0; x < run.x1; ++x) lost += bytesAt(photo, x, run.y)[0] > kClipped;
    return 2 * lost >= card.area;
}

// None where no sample at that distance from others, pixels, is lost.
std::optional<ClassImage> lostColour(const ClassImage& image, const PlanView& view, int spacing) {
    ClassImage out;
    out.x0 = image.x0, out.y0 = image.y0, out.width = image.width, out.height = image.height;
    const auto isLostAt = [&](int x, int y) { return isLost(view.photo(), x + out.x0, y + out.y0); };
    bool any = false;
    for (int y = 0; y < out.height && !any; y += spacing)
        for (int x = 0; x < out.width && !any; x += spacing) any = isLostAt(x, y);
    if (!any) return std::nullopt;
    out.paint.reserve(image.paint.size());
    for (int y = 0; y < out.height; ++y)
        for (int x = 0; x < out.width; ++x) out.paint.push_back(isLostAt(x, y) ? Paint::blue : Paint::none);
    return out;
}

// Anywhere between the table and the top of a wall.
bool isOnAWall(glm::dvec2 pixel, const geometry::Sketch& sketch, const WallEvidence& evidence,
               const PlanView& view) {
    const auto covers = [&](const auto& shape) {
        constexpr double kStep = 0.5; // inches
        for (double height = 0; height <= geometry::heightInches(shape.heightClass); height += kStep)
            if (evidence.distance(shape, view.plan(pixel, height)) < shape.thickness) return true;
        return false;
    };
    return std::any_of(sketch.walls.begin(), sketch.walls.end(), covers) ||
           std::any_of(sketch.arcs.begin(), sketch.arcs.end(), covers);
}

// Card takes from the red, which must be seen; a lost green or blue can only be more. What is brighter than a
// white table in all of them may be light.
bool isLightBlue(glm::vec3 overWhite, bool whiteTable) {
    constexpr float kLeast = 0.1f, kFirst = 160, kLast = 240; // of P'; degrees
    const float hue = hueOf(overWhite);
    return saturationOf(overWhite) > kLeast && hue > kFirst && hue < kLast &&
           !(whiteTable && std::min({overWhite.r, overWhite.g, overWhite.b}) > 1);
}

} // namespace

void readOverexposedCards(geometry::Sketch& sketch, const ClassImage& image, const WallEvidence& evidence,
                          const PlanView& view, const DetectOptions& options, double radius, Doubts& doubts) {
    constexpr double kNarrowest = 0.6, kStraight = 0.9; // inches; confidence
    const double narrowest = kNarrowest * view.pixelsPerInch({0, 0}, 0);
    const auto lost = lostColour(image, view, std::max(1, static_cast<int>(narrowest / 2)));
    if (!lost) return;
    for (const Component& region : findComponents(*lost, static_cast<int>(narrowest * narrowest) + 1)) {
        if (liesWithin(sketch.tokens, region, view, options) ||
            isOnAWall(region.centre, sketch, evidence, view))
            continue;
        const auto card = fitSkylight(region, view, options);
        if (!card || std::min(card->size.x, card->size.y) < kNarrowest ||
            card->detection.confidence < kStraight || glm::length(card->center) > radius ||
            std::any_of(sketch.skylights.begin(), sketch.skylights.end(), [&](const auto& other) {
                return glm::distance(other.center, card->center) < 0.5 * std::min(other.size.x, other.size.y);
            }))
            continue;
        const auto seen = evidence.overWhite(card->center, options.markerThickness);
        if (seen && !isRedLost(view.photo(), region) &&
            isLightBlue(*seen, image.whiteOverTable == glm::vec3(1))) {
            sketch.skylights.push_back(*card);
            doubts.add(region.centre,
                       "read as a skylight, but so overexposed that little of its colour is left");
        } else {
            doubts.add(region.centre,
                       "as large and straight as a skylight, but so overexposed that its colour is "
                       "lost; it is left out");
        }
    }
}

} // namespace heliodon::vision
