// The order in which a sketch names its primitives is no part of what it means.
#pragma once

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "geometry/building.h"

namespace heliodon::test {

// Closes the sketch in five other orders of its primitives: the same building each time, bit for bit.
inline void expectSameInAnyOrder(geometry::Sketch sketch) {
    const geometry::Closure first = geometry::closeSketch(sketch);
    std::mt19937 random(7);
    for (int k = 0; k < 5; ++k) {
        std::ranges::shuffle(sketch.walls, random);
        std::ranges::shuffle(sketch.arcs, random);
        std::ranges::shuffle(sketch.windows, random);
        std::ranges::shuffle(sketch.skylights, random);
        std::ranges::shuffle(sketch.tokens, random);
        const geometry::Closure again = geometry::closeSketch(sketch);
        ASSERT_EQ(again.report.message, first.report.message);
        ASSERT_EQ(again.building.has_value(), first.building.has_value());
        if (!first.building) continue;
        ASSERT_EQ(again.building->vertices, first.building->vertices);
        ASSERT_EQ(again.building->faces.size(), first.building->faces.size());
        for (size_t f = 0; f < first.building->faces.size(); ++f)
            ASSERT_EQ(again.building->faces[f].loops, first.building->faces[f].loops);
    }
}

} // namespace heliodon::test
