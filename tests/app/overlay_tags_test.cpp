// Where the names of what was found go.
#include "engine/app/overlay_tags.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace heliodon::app {
namespace {

using vision::OverlayTag;

OverlayTag quad(glm::dvec2 middle, glm::dvec2 half, OverlayTag::Side side = OverlayTag::Side::any) {
    const glm::dvec2 mirrored(half.x, -half.y);
    return {"name", {}, {middle - half, middle + mirrored, middle + half, middle - mirrored}, side, {}};
}

// As a table with a crowd on it: walls with windows on them, and tokens side by side.
TEST(OverlayTags, cover_no_outline_and_one_another_not) {
    std::vector<OverlayTag> tags{quad({400, 100}, {200, 6}, OverlayTag::Side::outer),
                                 quad({300, 100}, {30, 8}, OverlayTag::Side::inner),
                                 quad({420, 100}, {30, 8}, OverlayTag::Side::inner),
                                 quad({795, 400}, {4, 300}, OverlayTag::Side::outer)}; // at the rim
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 3; ++j) tags.push_back(quad({300 + 50 * i, 300 + 45 * j}, {12, 12}));
    OverlayTag arc{"arc", {}, {}, OverlayTag::Side::outer, {}};
    for (const double radius : {150.0, 160.0})
        for (int k = 0; k <= 20; ++k) {
            const double angle = std::numbers::pi * (0.5 + (radius < 155 ? k : 20 - k) / 20.0);
            arc.outlinePx.push_back(glm::dvec2(280, 520) +
                                    radius * glm::dvec2(std::cos(angle), std::sin(angle)));
        }
    tags.push_back(arc);
    const std::vector<glm::dvec2> sizes(tags.size(), {60, 18});
    const std::vector<Box> boxes = placeTags(800, 800, tags, sizes);
    for (size_t i = 0; i < boxes.size(); ++i) {
        EXPECT_GE(std::min(boxes[i].low.x, boxes[i].low.y), 0);
        EXPECT_LE(std::max(boxes[i].high.x, boxes[i].high.y), 800);
        for (size_t j = 0; j < i; ++j) EXPECT_FALSE(boxes[i].covers(boxes[j])) << i << " " << j;
        for (size_t j = 0; j + 1 < tags.size(); ++j) // the arc's box is not what it covers
            EXPECT_FALSE(boxes[i].covers({tags[j].outlinePx[0], tags[j].outlinePx[2]})) << i << " " << j;
    }
    EXPECT_LT(boxes[0].high.y, 100); // above the wall, and its windows' names below
    EXPECT_GT(boxes[1].low.y, 100);
    EXPECT_GT(boxes[2].low.y, 100);
    EXPECT_LT(boxes.back().high.x, 120); // beside the arc, not in its middle
}

} // namespace
} // namespace heliodon::app
