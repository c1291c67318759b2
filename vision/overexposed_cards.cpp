#include "vision/overexposed_cards.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/geometric.hpp>

#include "vision/chroma.h"
#include "vision/components.h"
#include "vision/table_marks.h"

namespace heliodon::vision {
namespace {

// Where two channels are at the end of the scale no hue is left.
std::optional<ClassImage> lostColour(const ClassImage& image, const PlanView& view, double least) {
    constexpr uint8_t kClipped = 250;
    ClassImage out;
    out.x0 = image.x0, out.y0 = image.y0, out.width = image.width, out.height = image.height;
    const Photograph& photo = view.photo();
    size_t lost = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const uint8_t* p =
                &photo.rgb[3 * (static_cast<size_t>(y + image.y0) * static_cast<size_t>(photo.width) +
                                static_cast<size_t>(x + image.x0))];
            if ((p[0] > kClipped) + (p[1] > kClipped) + (p[2] > kClipped) < 2) continue;
            if (out.paint.empty()) out.paint.assign(image.paint.size(), Paint::none);
            out.paint[static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x)] =
                Paint::blue;
            ++lost;
        }
    if (static_cast<double>(lost) < least) return std::nullopt;
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

// Card takes from the red: what is left of it is less than white's.
bool isLightBlue(glm::vec3 overWhite) {
    constexpr float kLeast = 0.1f, kFirst = 160, kLast = 240; // of P'; degrees
    const float hue = hueOf(overWhite);
    return saturationOf(overWhite) > kLeast && hue > kFirst && hue < kLast;
}

} // namespace

void readOverexposedCards(geometry::Sketch& sketch, const ClassImage& image, const WallEvidence& evidence,
                          const PlanView& view, const DetectOptions& options, double radius, Doubts& doubts) {
    constexpr double kNarrowest = 0.6, kStraight = 0.9; // inches; confidence
    const double perInch = view.pixelsPerInch({0, 0}, 0), least = std::pow(kNarrowest * perInch, 2);
    const auto lost = lostColour(image, view, least);
    if (!lost) return;
    for (const Component& region : findComponents(*lost, static_cast<int>(least) + 1)) {
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
        if (seen && isLightBlue(*seen)) {
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
