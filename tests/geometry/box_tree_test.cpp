#include "geometry/box_tree.h"

#include <algorithm>
#include <random>

#include <glm/vec3.hpp>
#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>

using namespace heliodon::geometry;

TEST(BoxTree, finds_what_holds_a_box_as_looking_at_all_does) {
    std::mt19937 random(3);
    std::uniform_int_distribution<int> place(0, 6),
        size(-1, 4); // many in one place, some empty the other way round
    const auto boxOf = [&] {
        const glm::dvec3 low(place(random), place(random), place(random));
        return Bounds{low, low + glm::dvec3(size(random), size(random), size(random))};
    };
    std::vector<Bounds> boxes;
    for (size_t count = 0; count < 70; boxes.push_back(boxOf()), ++count) {
        const BoxTree tree(boxes);
        for (int i = 0; i < 20; ++i) {
            const Bounds held = boxOf();
            std::vector<uint32_t> found, all;
            EXPECT_FALSE(tree.anyHolding(held.low, held.high, [&](uint32_t box) {
                found.push_back(box);
                return false;
            }));
            for (uint32_t box = 0; box < count; ++box)
                if (glm::all(glm::lessThanEqual(boxes[box].low, held.low)) &&
                    glm::all(glm::greaterThanEqual(boxes[box].high, held.high)))
                    all.push_back(box);
            std::ranges::sort(found);
            EXPECT_EQ(found, all);
            EXPECT_EQ(tree.anyHolding(held.low, held.high, [](uint32_t) { return true; }), !all.empty());
        }
    }
}

TEST(BoxTree, follows_a_ray_through_all_boxes_that_it_meets) {
    std::mt19937 random(5);
    std::uniform_int_distribution<int> place(0, 9), turn(-2, 2);
    std::vector<Bounds> boxes;
    for (int k = 0; k < 200; ++k) {
        const glm::dvec3 low(place(random), place(random), place(random));
        boxes.push_back({low, low + glm::dvec3(place(random) / 3, place(random) / 3, place(random) / 3)});
    }
    const BoxTree tree(boxes);
    for (int k = 0; k < 100; ++k) {
        const glm::dvec3 from(place(random), place(random), place(random)),
            way(turn(random), turn(random), turn(random));
        const double reach = place(random);
        std::vector<bool> asked(boxes.size(), false);
        EXPECT_FALSE(tree.anyAlong(from, way, reach, [&](uint32_t box) { return asked[box] = true, false; }));
        for (size_t box = 0; box < boxes.size(); ++box)
            for (int step = 0; step <= 120; ++step) {
                const glm::dvec3 p = from + step / 120.0 * reach * way;
                if (glm::all(glm::lessThan(boxes[box].low, p)) &&
                    glm::all(glm::greaterThan(boxes[box].high, p))) {
                    EXPECT_TRUE(asked[box]) << box;
                }
            }
        EXPECT_TRUE(tree.anyAlong(boxes[7].low - way, way, 1, [](uint32_t box) { return box == 7; }));
    }
}
