#include "engine/passes/tile_mask.h"

#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace heliodon::passes {
namespace {

TEST(TileMask, rectangles_hold_each_marked_tile_once_and_no_other) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> place(-20, 120);
    for (int round = 0; round < 20; ++round) {
        constexpr int kWidth = 101, kHeight = 75;
        TileMask mask(kWidth, kHeight, 8);
        for (int k = 0; k < round; ++k) {
            const glm::dvec2 low(place(random), place(random));
            mask.mark(low, low + glm::dvec2(k, 2 * k));
        }
        std::vector<int> held(kWidth * kHeight, 0);
        for (const PixelRect& r : mask.rectangles())
            for (int y = r.y; y < r.y + r.height; ++y)
                for (int x = r.x; x < r.x + r.width; ++x) ++held.at(static_cast<size_t>(y * kWidth + x));
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const glm::dvec2 at(x + 0.5, y + 0.5);
                EXPECT_EQ(held[static_cast<size_t>(y * kWidth + x)], mask.touches(at, at) ? 1 : 0);
            }
    }
}

TEST(TileMask, boxes_of_any_numbers) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN(),
                     kFar = std::numeric_limits<double>::infinity();
    TileMask mask(40, 30, 8);
    mask.mark({1e300, 1e300}, {-1e300, -1e300}); // of no places
    mask.mark(glm::dvec2(kNone), glm::dvec2(kNone));
    mask.mark({0, 0}, {kNone, 20});
    EXPECT_TRUE(mask.rectangles().empty());
    EXPECT_FALSE(mask.touches({0, 0}, {40, kNone}));
    mask.mark({-kFar, -1e300}, {kFar, 1e300});
    ASSERT_EQ(mask.rectangles().size(), 1u);
    EXPECT_EQ(mask.rectangles()[0].width * mask.rectangles()[0].height, 40 * 30);
}

} // namespace
} // namespace heliodon::passes
