// Walls, markers, cards, tokens and arrows that are hard to tell from others and from what is none: each test
// is a class of photographs that was once misread.
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/vision/painted_room.h"
#include "tests/vision/perturb.h"
#include "tests/vision/sketch_score.h"
#include "tests/vision/table_painter.h"
#include "vision/detect.h"
#include "vision/paint_hues.h"
#include "vision/photograph.h"
#include "vision/plan_view.h"

namespace heliodon::vision {
namespace {

using geometry::HeightClass;
using geometry::WindowKind;

// Brighter than the red of a wall whose top leans over the table's edge.
TEST(DetectPieces, a_blue_sleeve_beside_the_table) {
    const geometry::Rig rig = exampleRig();
    geometry::Sketch sketch = room();
    sketch.walls.push_back(wall("w5", {12, -15}, {18.5, -8}, HeightClass::red));
    Photograph photo = paintTable(sketch, rig);
    cover(photo, rig, {{-28, -8}, {-20.5, -8}, {-21.2, 8}, {-28, 8}}, 0, {0.2, 0.3, 0.7});
    expectRead(sketch, photo);
}

TEST(DetectPieces, markers_next_to_a_corner_of_walls_of_one_colour) {
    geometry::Sketch sketch;
    sketch.walls = {wall("w1", {-6, -4}, {6, -4}, HeightClass::blue),
                    wall("w2", {6.3, -3.7}, {6.3, 7}, HeightClass::blue)};
    sketch.windows = {window("win1", "w1", 10.5, 1.6, WindowKind::transom),
                      window("win2", "w2", 1.5, 1.6, WindowKind::transom)};
    const auto found =
        scoreSketch(sketch, detectSketch(paintTable(sketch, exampleRig()), exampleRig()).sketch);
    EXPECT_EQ(found.at("wall").found, 2) << table(found);
    EXPECT_EQ(found.at("window").found, 2) << table(found);
}

// Without white ends, or wider than a wall, nothing is a wall, whatever its colour.
TEST(DetectPieces, what_has_a_paint_on_a_dark_table_and_is_no_wall) {
    const geometry::Rig rig = exampleRig();
    PaintBox paints;
    paints.table = {0.05, 0.035, 0.028};
    Photograph photo = paintTable(room(), rig, paints);
    const Color skin{0.45, 0.2, 0.13}, red{0.4, 0.06, 0.06};
    cover(photo, rig, {{9, -14}, {13, -12}, {12, -9.6}, {8.2, -11}}, 2, skin);
    cover(photo, rig, {{-14, -9}, {-8, -12}, {-7.83, -11.67}, {-13.83, -8.67}}, 10, red);
    expectRead(room(), photo);
}

TEST(DetectPieces, a_hand_that_touches_a_wall) {
    const geometry::Rig rig = exampleRig();
    geometry::Sketch sketch = room();
    geometry::Arc arc;
    arc.id = "a1", arc.center = {0, 2}, arc.radius = 14, arc.a0Deg = 40, arc.a1Deg = 95,
    arc.heightClass = HeightClass::red;
    sketch.arcs = {arc};
    Photograph photo = paintTable(sketch, rig);
    const Color skin{0.6, 0.24, 0.16};
    cover(photo, rig, {{6, 15.2}, {9, 13.6}, {15, 21}, {10, 24}}, 10, skin);
    expectRead(sketch, photo, 0.12);
}

TEST(DetectPieces, tokens_in_a_strongly_compressed_file) {
    geometry::Sketch sketch = room();
    PaintBox paints;
    paints.blue = {0.05, 0.08, 0.28};
    Perturbation how;
    how.jpegQuality = 65;
    expectRead(sketch, perturbed(paintTable(sketch, exampleRig(), paints), how), 0.12);
}

TEST(DetectPieces, walls_cut_from_another_sheet) {
    const geometry::Rig rig = exampleRig();
    for (const double thickness : {0.25, 0.5}) {
        SCOPED_TRACE(thickness);
        geometry::Sketch sketch = room();
        geometry::Arc arc;
        arc.id = "a1", arc.center = {0, 2}, arc.radius = 14, arc.a0Deg = 40, arc.a1Deg = 95,
        arc.heightClass = HeightClass::red, arc.thickness = thickness;
        sketch.arcs = {arc};
        for (auto& w : sketch.walls) w.thickness = thickness;
        const Photograph photo = paintTable(sketch, rig);
        expectRead(sketch, photo);
        const auto result = detectSketch(photo, rig);
        EXPECT_TRUE(warnsOf(result, "in thick"));
        for (const auto& w : result.sketch.walls) EXPECT_NEAR(w.thickness, thickness, 0.02); // half a pixel
    }
}

// As wide as walls' tops look and as red, green and blue, and without anything of a wall's height.
TEST(DetectPieces, pens_and_tape_lie_flat) {
    const geometry::Rig rig = exampleRig();
    for (const Color& table : {PaintBox{}.table, Color{0.4, 0.4, 0.4}, Color{0.5, 0.38, 0.24}}) {
        SCOPED_TRACE(table[1]);
        PaintBox paints;
        paints.table = table;
        Photograph photo = paintTable(room(), rig, paints);
        cover(photo, rig, {{-14, -9}, {-8.5, -12}, {-8.29, -11.62}, {-13.79, -8.62}}, 0, {0.4, 0.06, 0.06});
        cover(photo, rig, {{-3, 8}, {3, 9}, {2.93, 9.41}, {-3.07, 8.41}}, 0, {0.06, 0.12, 0.42});
        cover(photo, rig, {{-12, 1}, {-12, 4}, {-12.4, 4}, {-12.4, 1}}, 0, {0.09, 0.33, 0.12});
        const bool named = warnsOf(detectSketch(photo, rig), "without its white ends");
        EXPECT_TRUE(named || table != PaintBox{}.table); // on others bare ends tell before
        expectRead(room(), photo);
    }
}

// By a step of light, its brightness or its paint: what lies behind one end is as bright, another is hidden.
// A pen beside them has a cap that shines.
TEST(DetectPieces, a_walls_end_that_does_not_stand_out) {
    const geometry::Rig rig = exampleRig();
    PaintBox paints;
    paints.face = paints.table; // no foot is seen
    Photograph photo = paintTable(room(), rig, paints);
    const Color lit{1.4, 1.4, 1.4};
    for (const geometry::Wall& w : room().walls) {
        const glm::dvec2 along = glm::normalize(w.b - w.a), across = 0.2 * glm::dvec2(-along.y, along.x);
        for (const auto& [tip, in] : {std::pair{w.a, 0.5 * along}, {w.b, -0.5 * along}})
            shade(photo, rig, {tip + across, tip - across, tip + in - across, tip + in + across},
                  geometry::heightInches(w.heightClass), lit, 0.5);
    }
    shade(photo, rig, {{-8.6, 3.5}, {-7.62, 3.5}, {-7.62, 5.5}, {-8.6, 5.5}}, 8, lit, 0.5);
    shade(photo, rig, {{-7.18, 3.5}, {-6.2, 3.5}, {-6.2, 5}, {-7.18, 5}}, 8, lit, 0.5);
    cover(photo, rig, {{6.5, 4.9}, {7.3, 4.9}, {7.3, 6.2}, {6.5, 6.2}}, 10, {0.5, 0.4, 0.3});
    cover(photo, rig, {{-3, 8}, {3, 9}, {2.93, 9.41}, {-3.07, 8.41}}, 0, {0.06, 0.12, 0.42});
    cover(photo, rig, {{3, 9}, {3.5, 9.08}, {3.43, 9.5}, {2.93, 9.41}}, 0, {1.2, 1.2, 1.2});
    EXPECT_TRUE(warnsOf(detectSketch(photo, rig), "without its white ends"));
    expectRead(room(), photo);
}

// A rim of two or three pixels, or as blurred, is nowhere as vivid as paint.
TEST(DetectPieces, tokens_that_are_out_of_focus) {
    geometry::Sketch sketch = room();
    sketch.skylights.clear();
    sketch.tokens[0].kind = geometry::TokenKind::floor;
    for (const double blur : {1.6, 2.2}) {
        SCOPED_TRACE(blur);
        Perturbation how;
        how.blurPx = blur;
        expectRead(sketch, perturbed(paintTable(sketch, exampleRig()), how), 0.12);
    }
}

// With a ring that is as bright as a token's beside the table, but of the rim's own colour.
TEST(DetectPieces, a_square_skylight_on_a_black_table_and_an_arrow_along_its_edge) {
    PaintBox paints;
    paints.table = {0.06, 0.06, 0.06};
    geometry::Sketch sketch = room();
    sketch.skylights[0].size = {1.6, 1.55};
    sketch.north = geometry::NorthArrow{{0, -19.9}, 2, {}};
    expectRead(sketch, paintTable(sketch, exampleRig(), paints));
}

TEST(DetectPieces, a_light_blue_sleeve_over_the_tables_edge_is_no_skylight) {
    const geometry::Rig rig = exampleRig();
    Photograph photo = paintTable(room(), rig);
    cover(photo, rig, {{-22.4, -2}, {-18, -2}, {-18, 2}, {-22.4, 2}}, 0, PaintBox{}.sky);
    expectRead(room(), photo);
    EXPECT_TRUE(warnsOf(detectSketch(photo, rig), "light blue like a skylight"));
}

// As seen by a tilted camera: in the picture they touch.
TEST(DetectPieces, a_blue_wall_before_a_skylight) {
    const geometry::Rig rig = exampleRig();
    geometry::Sketch sketch = room();
    sketch.skylights.clear();
    Photograph photo = paintTable(sketch, rig);
    // Beside the top of the second wall, as its colour is.
    cover(photo, rig, {{7.55, 0.5}, {9.4, 0.5}, {9.4, 4}, {7.55, 4}}, 8, PaintBox{}.sky);
    for (const double blur : {0.0, 2.0}) {
        SCOPED_TRACE(blur);
        Perturbation how;
        how.blurPx = blur;
        const Photograph seen = perturbed(photo, how);
        const Score score = scoreSketch(sketch, detectSketch(seen, rig).sketch);
        EXPECT_EQ(score.at("wall").found, 4) << table(score);
        EXPECT_EQ(score.at("wall").extra, 0) << table(score);
        EXPECT_TRUE(warnsOf(detectSketch(seen, rig), "light blue beside a blue wall"));
    }
}

// The light blue is on the wall's top, and what is left out is shade.
TEST(DetectPieces, a_wall_that_is_light_blue_in_part_beside_bluish_shade) {
    const geometry::Rig rig = exampleRig();
    geometry::Sketch sketch = room();
    sketch.windows.clear();
    for (const Color& gain : {Color{0.42, 0.44, 0.7}, Color{0.5, 0.52, 0.8}}) {
        SCOPED_TRACE(gain[0]);
        Photograph photo = paintTable(sketch, rig);
        cover(photo, rig, {{7.21, -2.2}, {7.59, -2.2}, {7.59, 2}, {7.21, 2}}, 8, {0.12, 0.28, 0.45});
        shade(photo, rig, {{7.6, -3}, {8.8, -2.5}, {8.2, 0}, {8.8, 2.5}, {7.6, 3}}, 8, gain);
        const DetectionResult result = detectSketch(photo, rig);
        EXPECT_EQ(scoreSketch(sketch, result.sketch).at("wall").found, 4);
        EXPECT_TRUE(warnsOf(result, "light blue on a wall's top"));
        EXPECT_FALSE(warnsOf(result, "light blue beside a blue wall"));
    }
}

// As its own corner may be cut off by noise: with it the rim makes once more the token that it is by itself.
TEST(DetectPieces, a_speck_beside_a_token) {
    const geometry::Rig rig = exampleRig();
    geometry::Sketch sketch = room();
    sketch.tokens[0].kind = geometry::TokenKind::floor, sketch.tokens[0].angleDeg = 20;
    const Photograph photo = paintTable(sketch, rig);
    for (const double reach : {1.05, 1.15})
        for (const glm::dvec2 way : {glm::dvec2(0.34, -0.94), {0.71, -0.71}}) {
            SCOPED_TRACE(testing::Message() << reach << " " << way.x);
            Photograph specked = photo;
            const glm::dvec2 p = sketch.tokens[0].pos + reach * way;
            constexpr double kHalf = 0.12;
            cover(specked, rig,
                  {p - kHalf, p + glm::dvec2(kHalf, -kHalf), p + kHalf, p + glm::dvec2(-kHalf, kHalf)}, 0.06,
                  PaintBox{}.green);
            EXPECT_EQ(detectSketch(specked, rig).sketch.tokens.size(), 1u);
        }
}

TEST(DetectPieces, a_seam_of_colour_is_no_arrow_however_orange) {
    const geometry::Rig rig = exampleRig();
    const geometry::Sketch stated = room();
    Photograph photo = paintTable(stated, rig);
    cover(photo, rig,
          {{-1.5, 13.95}, {0.7, 13.93}, {0.7, 13.85}, {1.5, 14}, {0.7, 14.15}, {0.7, 14.07}, {-1.5, 14.05}},
          0.03, PaintBox{}.orange);
    expectRead(stated, photo);
}

// Blur widens an arrow's shaft as much as its head.
TEST(DetectPieces, an_arrow_out_of_focus) {
    const geometry::Rig rig = exampleRig();
    geometry::Sketch sketch = room();
    sketch.north.reset();
    Photograph photo = paintTable(sketch, rig);
    cover(photo, rig,
          {{-1.5, -13.81},
           {0.55, -13.81},
           {0.55, -13.71},
           {1.5, -14},
           {0.55, -14.29},
           {0.55, -14.19},
           {-1.5, -14.19}},
          0.03, PaintBox{}.orange);
    Perturbation how;
    how.blurPx = 4;
    const auto north = detectSketch(perturbed(photo, how), rig).sketch.north;
    ASSERT_TRUE(north.has_value());
    EXPECT_LT(glm::distance(north->pos, {0, -14}), 0.1);
    EXPECT_LT(std::abs(std::remainder(north->dirDeg, 360)), 2);
}

// In warm light a face, in the shade or not, is orange along all of a red top.
TEST(DetectPieces, a_wall_with_an_orange_face) {
    const geometry::Rig rig = exampleRig();
    for (const Color& face : {Color{0.1, 0.06, 0.03}, {0.7, 0.45, 0.3}}) {
        Photograph photo = paintTable(room(), rig);
        cover(photo, rig, {{-6.3, 5.59}, {6.2, 5.59}, {6.2, 5.74}, {-6.3, 5.74}}, 10, face);
        expectRead(room(), photo);
    }
}

TEST(DetectPieces, orange_light_of_an_arrows_shape_is_none) {
    const geometry::Rig rig = exampleRig();
    Photograph photo = paintTable(room(), rig);
    shade(photo, rig,
          {{-16, 6}, {-14, 6.3}, {-14, 5.9}, {-13.2, 6.9}, {-14.2, 7.6}, {-14.1, 7.1}, {-15.9, 6.6}}, 0,
          {0.9, 0.45, 0.12}, 9);
    const auto north = detectSketch(photo, rig).sketch.north;
    ASSERT_TRUE(north.has_value());
    EXPECT_LT(glm::distance(north->pos, room().north->pos), 0.1);
}

// Orange by compression, with an end that blur has made broader.
TEST(DetectPieces, a_marker_on_a_wall_is_no_arrow) {
    const geometry::Rig rig = exampleRig();
    geometry::Sketch sketch = room();
    sketch.north.reset();
    Photograph photo = paintTable(sketch, rig);
    cover(photo, rig,
          {{-7.5, -1},
           {-7.3, -1},
           {-7.3, 0.6},
           {-7.18, 0.6},
           {-7.22, 1.4},
           {-7.58, 1.4},
           {-7.62, 0.6},
           {-7.5, 0.6}},
          8, PaintBox{}.orange);
    EXPECT_FALSE(detectSketch(photo, rig).sketch.north.has_value());
}

TEST(DetectPieces, an_arrow_that_points_at_a_marker) {
    const geometry::Rig rig = exampleRig();
    const glm::dvec3 eye = rig.camera.centre() / geometry::kMetresPerInch;
    const glm::dvec2 outer(-2, -5.19); // of the first window's marker, and where on the table it is seen
    const glm::dvec2 there = glm::mix(glm::dvec2(eye.x, -eye.z), outer, eye.y / (eye.y - 10));
    geometry::Sketch sketch = room();
    sketch.north->dirDeg = 90;
    sketch.north->pos = {there.x, there.y - 0.2 - 1.5};
    expectRead(sketch, paintTable(sketch, rig));
}

// Its top leans over the table: the arrow's tail is beside it in the picture, or behind it.
TEST(DetectPieces, an_arrow_that_a_red_wall_touches) {
    const geometry::Rig rig = exampleRig();
    const Photograph photo = paintTable(room(), rig);
    const PlanView view(photo, rig.camera, 2.2);
    const auto behindTop = [&](glm::dvec2 plan) { return view.plan(view.pixel(plan, 10), 0); };
    const glm::dvec2 beforeOne = behindTop({0.4, -5.2}), beforeOther = behindTop({3, 5.6});
    geometry::Sketch sketch = room();
    for (const auto& [middle, dir] :
         {std::pair{beforeOne - glm::dvec2(0, 1.46), 270.0}, {beforeOther + glm::dvec2(0, 1.46), 90.0}}) {
        SCOPED_TRACE(dir);
        sketch.north = geometry::NorthArrow{middle, dir, {}};
        expectRead(sketch, paintTable(sketch, rig));
    }
    sketch.north = geometry::NorthArrow{beforeOther, 90, {}};
    const Photograph half = paintTable(sketch, rig);
    EXPECT_TRUE(warnsOf(detectSketch(half, rig), "orange like the north arrow"));
    sketch.north.reset();
    expectRead(sketch, half);
}

// Paints that one maker has otherwise than another: a magenta nearer to red than to the usual one, a cyan
// like light blue, an orange like the wood of the table; a stretch of a wall beside a marker as broad at one
// end as an arrow's head.
TEST(DetectPieces, other_makers_paints) {
    const geometry::Rig rig = exampleRig();
    PaintBox reddish;
    reddish.red = {0.5, 0.05, 0.045}, reddish.magenta = {0.46, 0.04, 0.15};
    expectRead(room(), paintTable(room(), rig, reddish));

    PaintBox bluish;
    bluish.cyan = bluish.sky = {0.2, 0.42, 0.8};
    geometry::Sketch sketch = room();
    sketch.windows = {window("win1", "w1", 4, 4, WindowKind::standard),
                      window("win2", "w1", 10, 4, WindowKind::standard)};
    expectRead(sketch, paintTable(sketch, rig, bluish));
    bluish.cyan = {0.1, 0.44, 0.72}, bluish.blue = {0.07, 0.1, 0.42};
    sketch.windows = {window("win1", "w2", 4, 2.5, WindowKind::standard)};
    expectRead(sketch, paintTable(sketch, rig, bluish));

    PaintBox onWood;
    onWood.table = {0.15, 0.06, 0.015};
    expectRead(room(), paintTable(room(), rig, onWood));

    sketch = room();
    sketch.north.reset();
    sketch.windows = {window("win1", "w1", 9.3, 2, WindowKind::transom)};
    Photograph photo = paintTable(sketch, rig);
    cover(photo, rig, {{5.9, -5.3}, {6.5, -5.35}, {6.5, -4.65}, {5.9, -4.7}}, 10, PaintBox{}.red);
    EXPECT_FALSE(detectSketch(photo, rig).sketch.north.has_value());
}

// Only what is redder than a usual magenta is taken for one from as far as a red beside it explains.
TEST(PaintTable, violet_moves_no_magenta) {
    const auto tableOf = [](uint16_t hue) { // of a red and of that one
        std::vector<Coloured> pixels;
        for (uint32_t i = 0; i < 400; ++i) pixels.push_back({i, i % 2 == 0 ? hue : uint16_t{3}, 220, 60});
        return PaintTable(pixels, 20, 2);
    };
    EXPECT_EQ(tableOf(303).at(338, 220), Paint::magenta);
    EXPECT_EQ(tableOf(348).at(350, 220), Paint::magenta);
}

// Compression lays a pale seam of the complement beside a wall's paint.
TEST(DetectPieces, a_pale_seam_beside_a_wall_is_no_wall) {
    const geometry::Rig rig = exampleRig();
    PaintBox paints;
    paints.face = {0.17, 0.17, 0.17};
    Photograph photo = paintTable(room(), rig, paints);
    cover(photo, rig, {{4, -2}, {4.37, -2}, {4.37, 1}, {4, 1}}, 4, {0.18, 0.3, 0.19});
    expectRead(room(), photo);
}

// A slat's: wider than the gap between two panels.
TEST(DetectPieces, a_streak_of_light_below_a_marker_is_no_joint) {
    const geometry::Rig rig = exampleRig();
    const glm::dvec3 eye = rig.camera.centre() / geometry::kMetresPerInch;
    // Where on the table the camera sees a place on the face of the first wall.
    const auto behind = [&](double x, double height) {
        const glm::dvec2 face(x, -5 + 0.19);
        return glm::mix(glm::dvec2(eye.x, -eye.z), face, eye.y / (eye.y - height));
    };
    Photograph photo = paintTable(room(), rig);
    shade(photo, rig, {behind(-2.4, 0), behind(-1.7, 0), behind(-1.7, 9.5), behind(-2.4, 9.5)}, 0,
          {1.4, 1.4, 1.4});
    expectRead(room(), photo);
}

// Something dark beside a third of it bends its middle line by more than a straight wall's.
TEST(DetectPieces, a_short_wall_with_a_blot_beside_it_is_no_arc) {
    const geometry::Rig rig = exampleRig();
    geometry::Sketch sketch = room();
    sketch.walls.push_back(wall("w5", {-2, -1}, {0.6, -1}, HeightClass::red));
    Photograph photo = paintTable(sketch, rig);
    cover(photo, rig, {{-1, -0.8125}, {-0.6, -0.8125}, {-0.6, -0.6925}, {-1, -0.6925}}, 10,
          {0.05, 0.05, 0.05});
    expectRead(sketch, photo);
}

// Blur along a red wall's edge beside bluish shade has magenta's hue, and seemed to make the marker wider.
TEST(DetectPieces, a_fringe_of_a_markers_hue_makes_it_no_wider) {
    Photograph photo = paintTable(room(), exampleRig());
    cover(photo, exampleRig(), {{3.9, -5.22}, {4.35, -5.22}, {4.35, -5.13}, {3.9, -5.13}}, 10,
          {0.5, 0.07, 0.29});
    expectRead(room(), photo);
}

// As broad as a wall's top and blue; but what is closed round a hole has no ends.
TEST(DetectPieces, a_roll_of_tape_is_no_curved_wall) {
    PaintBox paints;
    paints.table = {0.04, 0.04, 0.04};
    Photograph photo = paintTable(room(), exampleRig(), paints);
    const auto disc = [](double radius) {
        std::vector<glm::dvec2> out;
        for (int i = 0; i < 48; ++i) {
            const double a = 2 * std::numbers::pi * i / 48;
            out.push_back(glm::dvec2(1, 10) + radius * glm::dvec2(std::cos(a), std::sin(a)));
        }
        return out;
    };
    cover(photo, exampleRig(), disc(1.3), 0.7, {0.06, 0.12, 0.42});
    cover(photo, exampleRig(), disc(0.9), 0.7, {0.04, 0.04, 0.04});
    expectRead(room(), photo);
    EXPECT_TRUE(warnsOf(detectSketch(photo, exampleRig()), "a roll of tape"));
}

// In the picture; what is cut at it falls into straight strips.
TEST(DetectPieces, a_pen_that_touches_a_curved_wall) {
    const geometry::Rig rig = exampleRig();
    geometry::Sketch sketch;
    geometry::Arc arc;
    arc.id = "a1", arc.center = {0, 0}, arc.radius = 7, arc.a0Deg = -70, arc.a1Deg = 75;
    arc.heightClass = HeightClass::red;
    sketch.arcs = {arc};
    sketch.walls = {wall("w1", {-7, -6.5}, {2, -6.5}, HeightClass::blue),
                    wall("w2", {-7, 6.6}, {1.4, 6.6}, HeightClass::blue)};
    Photograph photo = paintTable(sketch, rig);
    cover(photo, rig, {{6.6, -3.4}, {10, -0.4}, {9.9, -0.2}, {6.4, -3.2}}, 10, PaintBox{}.red);
    expectRead(sketch, photo);
}

} // namespace
} // namespace heliodon::vision
