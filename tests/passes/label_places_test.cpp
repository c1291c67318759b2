// Where names go beside outlines and marks.
#include "engine/passes/label_places.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace heliodon::passes {
namespace {

Label quad(glm::dvec2 middle, glm::dvec2 half, glm::dvec2 towards = {0, 0}) {
    const glm::dvec2 mirrored(half.x, -half.y);
    return {{middle - half, middle + mirrored, middle + half, middle - mirrored}, {60, 18}, towards};
}

// As a table with a crowd on it: walls with windows on them, and tokens side by side.
TEST(LabelPlaces, cover_no_outline_and_one_another_not) {
    std::vector<Label> labels{quad({400, 100}, {200, 6}, {0, -30}), quad({300, 100}, {30, 8}, {0, 30}),
                              quad({420, 100}, {30, 8}, {0, 30}),
                              quad({795, 400}, {4, 300}, {30, 0})}; // at the rim
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 3; ++j) labels.push_back(quad({300 + 50 * i, 300 + 45 * j}, {12, 12}));
    Label arc{{}, {60, 18}, {-30, 0}};
    for (const double radius : {150.0, 160.0})
        for (int k = 0; k <= 20; ++k) {
            const double angle = std::numbers::pi * (0.5 + (radius < 155 ? k : 20 - k) / 20.0);
            arc.outline.push_back(glm::dvec2(280, 520) +
                                  radius * glm::dvec2(std::cos(angle), std::sin(angle)));
        }
    labels.push_back(arc);
    const std::vector<Box> boxes = placeLabels(labels, {{0, 0}, {800, 800}}, 4);
    for (size_t i = 0; i < boxes.size(); ++i) {
        EXPECT_GE(std::min(boxes[i].low.x, boxes[i].low.y), 0);
        EXPECT_LE(std::max(boxes[i].high.x, boxes[i].high.y), 800);
        for (size_t j = 0; j < i; ++j) EXPECT_FALSE(boxes[i].covers(boxes[j])) << i << " " << j;
        for (size_t j = 0; j + 1 < labels.size(); ++j) // the arc's box is not what it covers
            EXPECT_FALSE(boxes[i].covers({labels[j].outline[0], labels[j].outline[2]})) << i << " " << j;
    }
    EXPECT_LT(boxes[0].high.y, 100); // above the wall, and its windows' names below
    EXPECT_GT(boxes[1].low.y, 100);
    EXPECT_GT(boxes[2].low.y, 100);
    EXPECT_LT(boxes.back().high.x, 120); // beside the arc, not in its middle
}

// Marks of a plot, in a crowd in which there is room for all words.
TEST(LabelPlaces, words_of_a_crowd_of_marks_cover_nothing) {
    constexpr double kMark = 4;
    const Box within{{0, 0}, {600, 400}};
    std::mt19937 random(3);
    std::uniform_real_distribution<double> x(280, 320), y(170, 230), width(15, 90);
    for (int plot = 0; plot < 20; ++plot) {
        std::vector<Label> labels(18);
        for (Label& label : labels) label = {{{x(random), y(random)}}, {width(random), 11}, {30, 0}};
        const std::vector<Box> boxes = placeLabels(labels, within, kMark);
        for (size_t k = 0; k < boxes.size(); ++k) {
            EXPECT_GE(boxes[k].low.x, 0);
            EXPECT_LE(boxes[k].high.x, 600);
            for (size_t l = 0; l < boxes.size(); ++l) {
                EXPECT_FALSE(k != l && boxes[k].covers(boxes[l])) << plot << ": " << k << ", " << l;
                const glm::dvec2 mark = labels[l].outline[0];
                EXPECT_FALSE(boxes[k].covers({mark - (kMark - 1), mark + (kMark - 1)})); // up to a pixel
            }
        }
    }
}

TEST(LabelPlaces, keep_the_side_that_is_wanted_where_there_is_room_and_off_lines) {
    const Box within{{0, 0}, {600, 400}};
    const Label alone{{{100, 100}}, {40, 11}, {30, 0}}, atBorder{{{590, 100}}, {40, 11}, {30, 0}};
    EXPECT_GT(placeLabels(std::vector{alone}, within, 4)[0].low.x, 103);
    EXPECT_LE(placeLabels(std::vector{atBorder}, within, 4)[0].high.x, 600);
    const std::vector<Line> line{{{{104, 100}, {300, 100}}}}; // where the words would be
    const Box beside = placeLabels(std::vector{alone}, within, 4, line)[0];
    EXPECT_TRUE(beside.high.y < 100 || beside.low.y > 100 || beside.high.x < 104);
    EXPECT_TRUE(placeLabels({}, within, 4).empty());
}

} // namespace
} // namespace heliodon::passes
