#include "vision/bright_ends.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "vision/card_white.h"
#include "vision/chroma.h"
#include "vision/median.h"

namespace heliodon::vision {

namespace {

// Medians of all ends of walls.
struct Ends {
    size_t count = 0;
    glm::vec3 overWhite{0}, light{0};
    glm::vec2 colour{0}; // chroma
};

Ends endsOf(const geometry::Sketch& sketch, const WallEvidence& evidence, const PlanView& view) {
    std::array<std::vector<float>, 8> seen; // red, green, blue over white, and as they are; two chromas
    const auto look = [&](const auto& shape) {
        for (const glm::dvec2 end : evidence.endsOf(shape)) {
            const glm::dvec2 p = view.pixel(end, geometry::heightInches(shape.heightClass));
            const glm::vec3 light = view.light(p), over = light / view.white(p);
            const glm::vec2 colour = chroma(light.r, light.g, light.b);
            const std::array<float, 8> values{over.r,  over.g,  over.b,    light.r,
                                              light.g, light.b, colour[0], colour[1]};
            for (size_t i = 0; i < seen.size(); ++i) seen[i].push_back(values[i]);
        }
    };
    for (const auto& wall : sketch.walls) look(wall);
    for (const auto& arc : sketch.arcs) look(arc);
    Ends out;
    out.count = seen[0].size();
    std::array<float, 8> typical{};
    for (size_t i = 0; i < seen.size(); ++i) typical[i] = median(std::move(seen[i]));
    out.overWhite = {typical[0], typical[1], typical[2]}, out.light = {typical[3], typical[4], typical[5]};
    out.colour = {typical[6], typical[7]};
    return out;
}

} // namespace

std::optional<BrightEnds> brightEnds(const geometry::Sketch& sketch, const WallEvidence& evidence,
                                     const ClassImage& image, const PlanView& view, double radius) {
    constexpr float kBrighter = 1.8f;
    const Ends ends = endsOf(sketch, evidence, view);
    const float most = std::max({ends.overWhite.r, ends.overWhite.g, ends.overWhite.b});
    if (ends.count == 0 || most < kBrighter) return std::nullopt;
    if (tableReturns(view, findTable(view, radius, 0), ends.light)) return std::nullopt;
    return BrightEnds{{image.whiteOverTable * ends.overWhite, ends.colour}, most, ends.count};
}

bool endsHaveTablesColour(const geometry::Sketch& sketch, const WallEvidence& evidence,
                          const ClassImage& image, const PlanView& view) {
    constexpr float kOther = 0.2f; // of log chroma: a table of card's chroma shows by its level alone
    const glm::vec3& card = image.whiteOverTable;
    const glm::vec2 cardColour = chroma(card.r, card.g, card.b);
    if (glm::length(cardColour) < kOther || std::min({card.r, card.g, card.b}) > kDarkTable) return false;
    const Ends ends = endsOf(sketch, evidence, view);
    if (ends.count < kEnoughEnds || std::min({ends.overWhite.r, ends.overWhite.g, ends.overWhite.b}) <= 0)
        return false;
    const glm::vec2 overCard = chroma(ends.overWhite.r, ends.overWhite.g, ends.overWhite.b);
    return glm::length(overCard + cardColour) < glm::length(overCard);
}

} // namespace heliodon::vision
