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
