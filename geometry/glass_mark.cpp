#include "geometry/glass_mark.h"

#include <vector>

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "geometry/bounds.h"

namespace heliodon::geometry {

namespace {

// Six decimals of coordinates of a room of 0.2 m, as on the table, leave 5e-6.
constexpr double kRounding = 2e-5;

} // namespace

bool GlassMark::agrees(const GlassMark& other) const {
    return panes == other.panes &&
           glm::all(glm::lessThanEqual(glm::abs(place - other.place), glm::dvec3(kRounding)));
}

GlassMark glassMark(std::span<const glm::dvec3> vertices, std::span<const uint32_t> corners,
                    std::span<const uint32_t> firstCorner, const std::function<bool(size_t)>& isGlass) {
    std::vector<glm::dvec3> drawn, middles;
    for (const uint32_t v : corners) drawn.push_back(vertices[v]);
    for (size_t i = 0; i + 1 < firstCorner.size(); ++i) {
        if (!isGlass(i)) continue;
        glm::dvec3 sum{0};
        for (uint32_t c = firstCorner[i]; c < firstCorner[i + 1]; ++c) sum += drawn[c];
        middles.push_back(sum / static_cast<double>(firstCorner[i + 1] - firstCorner[i]));
    }
    if (middles.empty()) return {};
    const Bounds box = boundsOf(drawn);
    glm::dvec3 squares{0};
    for (const glm::dvec3& middle : middles) squares += (middle - box.low) * (middle - box.low);
    return {static_cast<uint32_t>(middles.size()),
            glm::sqrt(squares / static_cast<double>(middles.size())) / box.diagonal()};
}

} // namespace heliodon::geometry
