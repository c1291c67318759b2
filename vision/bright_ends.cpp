#include "vision/bright_ends.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "vision/card_white.h"
#include "vision/chroma.h"
#include "vision/median.h"

namespace heliodon::vision {

std::optional<BrightEnds> brightEnds(const geometry::Sketch& sketch, const WallEvidence& evidence,
                                     const ClassImage& image, const PlanView& view, double radius) {
    constexpr float kBrighter = 1.8f;
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
    const size_t count = seen[0].size();
    if (count == 0) return std::nullopt;
    std::array<float, 8> typical{};
    for (size_t i = 0; i < seen.size(); ++i) typical[i] = median(std::move(seen[i]));
    const float most = std::max({typical[0], typical[1], typical[2]});
    if (most < kBrighter) return std::nullopt;
    if (tableReturns(view, findTable(view, radius, 0), {typical[3], typical[4], typical[5]}))
        return std::nullopt;
    return BrightEnds{
        {image.whiteOverTable * glm::vec3(typical[0], typical[1], typical[2]), {typical[6], typical[7]}},
        most,
        count};
}

} // namespace heliodon::vision
