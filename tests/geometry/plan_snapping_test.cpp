// What coincides but for rounding coincides after snapping, and everything else stays.
#include "geometry/plan_snapping.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

using namespace heliodon::geometry;

namespace {

constexpr double kNear = 1e-9;

glm::dvec2 turned(glm::dvec2 p, double angle) {
    return {std::cos(angle) * p.x - std::sin(angle) * p.y, std::sin(angle) * p.x + std::cos(angle) * p.y};
}

} // namespace

TEST(PlanSnapping, lines_that_overlap_part_nothing_however_they_lie) {
    for (double angle = 0; angle < 6.3; angle += 0.1) {
        std::vector<PlanSegment> segments;
        const auto add = [&](double from, double to, double y) {
            segments.push_back(
                {turned({from, y}, angle), turned({to, y}, angle), static_cast<int32_t>(segments.size())});
        };
        add(0, 7, 1.0 / 3);
        add(5, -2, 1.0 / 3);
        add(4, 9, 1.0 / 3);
        const PlanArrangement map = arrange(snapped(segments, kNear));
        EXPECT_EQ(map.points.size(), 6u) << angle;
        EXPECT_EQ(map.edgeCount(), 5u) << angle;
        EXPECT_EQ(map.cellCount, 1u) << angle;
    }
}

TEST(PlanSnapping, ends_that_are_one_but_for_rounding_are_one) {
    const auto out = snapped({{{0, 0}, {1, 0}, 0}, {{1 + 1e-10, -1e-10}, {1, 1}, 1}}, kNear);
    ASSERT_EQ(out.size(), 2u);
    EXPECT_EQ(out[0].b, glm::dvec2(1, 0));
    EXPECT_EQ(out[1].a, out[0].b);
    EXPECT_EQ(out[1].b, glm::dvec2(1, 1));
}

TEST(PlanSnapping, a_line_runs_through_the_end_that_it_passes) {
    const auto out = snapped({{{0, 0}, {2, 0}, 5}, {{1, 1e-10}, {1, 1}, 6}}, kNear);
    ASSERT_EQ(out.size(), 3u);
    EXPECT_EQ(out[0].tag, 5);
    EXPECT_EQ(out[0].b, glm::dvec2(1, 1e-10));
    EXPECT_EQ(out[1].tag, 5);
    EXPECT_EQ(out[1].a, out[0].b);
    EXPECT_EQ(out[1].b, glm::dvec2(2, 0));
}

TEST(PlanSnapping, what_is_apart_stays) {
    const std::vector<PlanSegment> segments{
        {{0, 0}, {2, 0}, 0}, {{1, 1e-8}, {1, 1}, 1}, {{-1, -1}, {3, 1}, 2}, {{2 + 1e-8, 0}, {4, 0}, 3}};
    const auto out = snapped(segments, kNear);
    ASSERT_EQ(out.size(), segments.size());
    for (size_t k = 0; k < out.size(); ++k) {
        EXPECT_EQ(out[k].a, segments[k].a);
        EXPECT_EQ(out[k].b, segments[k].b);
    }
}
