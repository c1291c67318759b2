// When `live` works on a picture, and on how much of it: hands are waited for, noise and lamps change
// nothing, a wall that was moved does.
#include <algorithm>
#include <chrono>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/vision/perturb.h"
#include "tests/vision/table_painter.h"
#include "vision/detect.h"
#include "vision/steady_sketch.h"
#include "vision/table_watch.h"

namespace heliodon::vision {
namespace {

geometry::Rig rig() {
    return geometry::readRig(HELIODON_SOURCE "/examples/rig.json");
}
geometry::Sketch sketch() {
    return geometry::readSketch(HELIODON_TEST_DATA "/geometry/sketches/i01_mixed.sketch.json");
}

// The noise of a small sensor in a dim room.
Photograph noisy(const Photograph& photo, unsigned seed, double brightness = 1) {
    Perturbation how;
    how.electronsAtWhite = 8000;
    how.readNoise = 8;
    how.seed = seed;
    for (double& gain : how.gain) gain = brightness;
    return perturbed(photo, how);
}

Photograph withHand(Photograph photo, int left) {
    for (int y = 300; y < 700; ++y)
        for (int x = std::max(0, left); x < std::min(photo.width, left + 160); ++x) {
            uint8_t* pixel = &photo.rgb[3 * static_cast<size_t>(y * photo.width + x)];
            pixel[0] = 150, pixel[1] = 110, pixel[2] = 90;
        }
    return photo;
}

TableWatch::Time at(double seconds) {
    return TableWatch::Time{} + std::chrono::milliseconds(100'000 + std::lround(1e3 * seconds));
}

using State = TableWatch::State;

TEST(TableWatch, waits_for_the_hand_and_works_on_what_it_left) {
    const Photograph before = paintTable(sketch(), rig());
    geometry::Sketch moved = sketch();
    moved.walls[0].a.y += 0.5, moved.walls[0].b.y += 0.5;
    const Photograph after = paintTable(moved, rig());
    TableWatch watch;
    unsigned seed = 1;
    double time = 0;
    const auto look = [&](const Photograph& photo) {
        return watch.look(noisy(photo, ++seed), at(time += 0.1));
    };
    EXPECT_EQ(look(before), State::moving); // nothing is known yet
    for (int i = 0; i < 4; ++i) look(before);
    EXPECT_EQ(look(before), State::changed);
    watch.worked();
    for (int i = 0; i < 10; ++i) EXPECT_EQ(look(before), State::same);
    for (int i = 0; i < 6; ++i)
        EXPECT_EQ(look(withHand(i < 3 ? before : after, 1200 - 150 * i)), State::moving);
    EXPECT_EQ(look(after), State::moving); // the hand has just gone
    for (int i = 0; i < 4; ++i) look(after);
    EXPECT_EQ(look(after), State::changed);
    watch.worked();
    EXPECT_EQ(look(after), State::same);
}

TEST(TableWatch, a_hand_that_comes_and_goes_leaves_nothing_to_do) {
    const Photograph table = paintTable(sketch(), rig());
    TableWatch watch;
    double time = 0;
    for (int i = 0; i < 6; ++i) watch.look(table, at(time += 0.1));
    watch.worked();
    EXPECT_EQ(watch.look(withHand(table, 600), at(time += 0.1)), State::moving);
    for (int i = 0; i < 5; ++i) watch.look(table, at(time += 0.1));
    EXPECT_EQ(watch.look(table, at(time += 0.1)), State::same);
}

TEST(TableWatch, lamps_that_dim_and_light_of_our_own_are_no_hand) {
    const Photograph table = paintTable(sketch(), rig());
    TableWatch watch;
    double time = 0;
    for (int i = 0; i < 6; ++i) watch.look(noisy(table, 3), at(time += 0.1));
    watch.worked();
    for (int i = 0; i < 10; ++i) // a tenth darker
        EXPECT_EQ(watch.look(noisy(table, 20 + static_cast<unsigned>(i), 1 - 0.01 * i), at(time += 0.1)),
                  State::same);
    // The projectors show a sun patch: while that is new, differences say nothing of the table.
    const Photograph lit = withHand(table, 500);
    watch.lightChanged(at(time + 0.05));
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(watch.look(lit, at(time += 0.1)), State::moving);
        EXPECT_TRUE(watch.lightIsChanging(at(time)));
    }
    EXPECT_EQ(watch.look(lit, at(time += 0.1)), State::changed); // worth a detection, at once
}

TEST(SteadySketch, the_same_table_in_two_noisy_pictures_is_one_sketch) {
    const Photograph table = paintTable(sketch(), rig());
    const geometry::Sketch first = detectSketch(noisy(table, 1), rig()).sketch;
    for (unsigned seed = 2; seed < 6; ++seed) {
        const SteadySketch steady = steadied(first, detectSketch(noisy(table, seed), rig()).sketch);
        EXPECT_TRUE(steady.same()) << seed;
        ASSERT_EQ(steady.sketch.walls.size(), first.walls.size());
        for (size_t i = 0; i < first.walls.size(); ++i) {
            EXPECT_EQ(steady.sketch.walls[i].a, first.walls[i].a);
            EXPECT_EQ(steady.sketch.walls[i].b, first.walls[i].b);
        }
    }
}

TEST(SteadySketch, what_was_changed_differs_and_nothing_else) {
    const geometry::Sketch before = sketch();
    geometry::Sketch fresh = before;
    for (auto& wall : fresh.walls)
        wall.a += glm::dvec2(0.02, -0.03), wall.b += glm::dvec2(-0.03, 0.01); // noise
    fresh.walls[1].a.x += 1;
    std::swap(fresh.walls[0], fresh.walls[2]); // another order
    const SteadySketch steady = steadied(before, fresh);
    EXPECT_FALSE(steady.sameGeometry);
    EXPECT_TRUE(steady.sameMaterials && steady.sameNorth);
    EXPECT_EQ(steady.sketch.walls[0].a, before.walls[2].a);
    EXPECT_EQ(steady.sketch.walls[2].a, before.walls[0].a);
    EXPECT_EQ(steady.sketch.walls[1].a, fresh.walls[1].a);
}

TEST(SteadySketch, tokens_and_arrow_are_no_geometry) {
    const geometry::Sketch before = sketch();
    ASSERT_FALSE(before.tokens.empty());
    ASSERT_TRUE(before.north);
    geometry::Sketch painted = before;
    painted.tokens[0].rgb[0] = painted.tokens[0].rgb[0] > 128 ? 40 : 220;
    EXPECT_TRUE(steadied(before, painted).sameGeometry);
    EXPECT_FALSE(steadied(before, painted).sameMaterials);
    geometry::Sketch turned = before;
    turned.north->dirDeg += 359.7; // across the full turn: a third of a degree
    EXPECT_TRUE(steadied(before, turned).same());
    turned.north->dirDeg += 5;
    EXPECT_TRUE(steadied(before, turned).sameGeometry && steadied(before, turned).sameMaterials);
    EXPECT_FALSE(steadied(before, turned).sameNorth);
}

} // namespace
} // namespace heliodon::vision
