// Tables, lamps and cameras that are not as one would wish: each test is a class of photographs that was once
// misread.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "geometry/input_error.h"
#include "tests/vision/perturb.h"
#include "tests/vision/sketch_score.h"
#include "tests/vision/table_painter.h"
#include "vision/detect.h"
#include "vision/paint_hues.h"
#include "vision/plan_view.h"
#include "vision/table_edge.h"
#include "vision/white_map.h"

namespace heliodon::vision {
namespace {

using geometry::HeightClass;
using geometry::WindowKind;

geometry::Rig exampleRig() {
    return geometry::readRig(HELIODON_SOURCE "/examples/rig.json");
}

geometry::Wall wall(const char* id, glm::dvec2 a, glm::dvec2 b, HeightClass height) {
    geometry::Wall out;
    out.id = id, out.a = a, out.b = b, out.heightClass = height;
    return out;
}

geometry::WindowMarker window(const char* id, const char* on, double pos, double width, WindowKind kind) {
    geometry::WindowMarker out;
    out.id = id, out.wall = on, out.pos = pos, out.width = width, out.kind = kind;
    return out;
}

// Four walls, three windows, a skylight, a token, an arrow.
geometry::Sketch room() {
    geometry::Sketch s;
    s.walls = {wall("w1", {-7, -5}, {7, -5}, HeightClass::red),
               wall("w2", {7.4, -4.6}, {7.4, 5}, HeightClass::blue),
               wall("w3", {7, 5.4}, {-7, 5.4}, HeightClass::red),
               wall("w4", {-7.4, 5}, {-7.4, -4.6}, HeightClass::blue)};
    s.windows = {window("win1", "w1", 5, 2.5, WindowKind::standard),
                 window("win2", "w1", 10, 2, WindowKind::picture),
                 window("win3", "w2", 4, 2, WindowKind::transom)};
    s.skylights = {{"sky1", {1, 1}, {2.5, 1.5}, 20, {}}};
    geometry::Token token;
    token.id = "token1", token.kind = geometry::TokenKind::wallAll, token.pos = {-4, -1}, token.angleDeg = 15;
    token.rgb = {40, 40, 40};
    s.tokens = {token};
    s.north = geometry::NorthArrow{{0, -14}, 60, {}};
    return s;
}

void expectRead(const geometry::Sketch& stated, const Photograph& photo, double place = 0.08) {
    const auto result = detectSketch(photo, exampleRig());
    const Score score = scoreSketch(stated, result.sketch);
    for (const auto& [kind, k] : score) {
        EXPECT_EQ(k.found, k.stated) << kind << "\n" << table(score);
        EXPECT_EQ(k.extra, 0) << kind << "\n" << table(score);
        EXPECT_LT(k.placeWorst, place) << kind << "\n" << table(score);
    }
}

bool warnsOf(const DetectionResult& result, const char* what) {
    return std::any_of(result.warnings.begin(), result.warnings.end(),
                       [&](const std::string& w) { return w.find(what) != std::string::npos; });
}

TEST(DetectConditions, shadows_that_only_a_bluish_light_reaches) {
    const geometry::Rig rig = exampleRig();
    Photograph photo = paintTable(room(), rig);
    shade(photo, rig, {{-7.2, -4.8}, {-2, -4.8}, {-2, 5}, {-7.2, 5}}, 0, {0.22, 0.32, 0.5});
    shade(photo, rig, {{8, -3}, {16, -8}, {14, 4}, {8, 3}}, 0, {0.22, 0.32, 0.5});
    expectRead(room(), photo);
}

// Too little of it to tell that light's colour by. It makes one region with the wall's top, in the last as
// wide and straight as a skylight.
TEST(DetectConditions, bluish_shade_along_a_blue_wall) {
    const geometry::Rig rig = exampleRig();
    for (const auto& [gain, softPx] : {std::pair{Color{0.3, 0.4, 0.7}, 2.0}, {Color{0.4, 0.54, 0.9}, 6.0}}) {
        SCOPED_TRACE(softPx);
        Photograph photo = paintTable(room(), rig);
        shade(photo, rig, {{7.6, -4.4}, {9.2, -3}, {8.2, 0.5}, {9.2, 3.8}, {7.6, 4.8}}, 8, gain, softPx);
        expectRead(room(), photo, 0.12);
    }
}

TEST(DetectConditions, a_lamp_that_changes_colour_over_the_table) {
    Lighting lamps;
    lamps.left = {0.75, 0.6, 0.36}, lamps.right = {0.4, 0.5, 0.6};
    expectRead(room(), paintTable(room(), exampleRig(), {}, lamps));
}

TEST(DetectConditions, a_wooden_floor_and_a_wall_at_the_edge) {
    PaintBox paints;
    paints.floor = {0.24, 0.13, 0.06};
    geometry::Sketch sketch = room();
    sketch.walls.push_back(wall("w5", {12, -15}, {18.5, -8}, HeightClass::red));
    expectRead(sketch, paintTable(sketch, exampleRig(), paints));
}

// Brighter than the red of a wall whose top leans over the table's edge.
TEST(DetectConditions, a_blue_sleeve_beside_the_table) {
    const geometry::Rig rig = exampleRig();
    geometry::Sketch sketch = room();
    sketch.walls.push_back(wall("w5", {12, -15}, {18.5, -8}, HeightClass::red));
    Photograph photo = paintTable(sketch, rig);
    cover(photo, rig, {{-28, -8}, {-20.5, -8}, {-21.2, 8}, {-28, 8}}, 0, {0.2, 0.3, 0.7});
    expectRead(sketch, photo);
}

TEST(DetectConditions, pale_cyan_and_a_camera_with_overlapping_filters) {
    PaintBox paints;
    paints.cyan = {0.1, 0.5, 0.58}, paints.sky = {0.48, 0.68, 0.85};
    for (const bool withSkylight : {true, false}) {
        SCOPED_TRACE(withSkylight);
        geometry::Sketch sketch = room();
        if (!withSkylight) sketch.skylights.clear();
        Photograph photo = paintTable(sketch, exampleRig(), paints);
        mixChannels(photo, 0.1);
        expectRead(sketch, photo);
    }
}

TEST(DetectConditions, faces_as_dark_as_the_paint_above_them) {
    PaintBox paints;
    paints.face = {0.17, 0.17, 0.17};
    geometry::Sketch sketch = room();
    sketch.walls.push_back(wall("w5", {-3, 1}, {4, 2.6}, HeightClass::green));
    sketch.skylights.clear();
    expectRead(sketch, paintTable(sketch, exampleRig(), paints));
}

TEST(DetectConditions, markers_next_to_a_corner_of_walls_of_one_colour) {
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

// Scaled in an editor: edges are blended in encoded values, which puts a dark strip's outwards; a shaded face
// beside it does so too.
TEST(DetectConditions, a_picture_that_was_scaled_after_it_was_taken) {
    const auto bytes = [](double r, double g, double b) { return Color{r / 255, g / 255, b / 255}; };
    PaintBox paints;
    paints.green = bytes(50, 140, 60), paints.blue = bytes(40, 60, 160), paints.red = bytes(190, 45, 40);
    paints.table = bytes(213, 211, 207);
    geometry::Sketch sketch;
    sketch.walls = {wall("w1", {0.21, -3.33}, {2.56, 0.07}, HeightClass::blue),
                    wall("w2", {-6.59, 0.39}, {-0.97, 2.55}, HeightClass::green),
                    wall("w3", {5.93, 1.71}, {2.03, 3.97}, HeightClass::red),
                    wall("w4", {-1, -6.98}, {2.66, -4.93}, HeightClass::blue),
                    wall("w5", {-2.54, -2.71}, {-1.39, -0.47}, HeightClass::green)};
    for (const double side : {150, 170, 185}) {
        SCOPED_TRACE(side);
        paints.face = bytes(side, 0.99 * side, 0.97 * side);
        Photograph photo = paintTable(sketch, exampleRig(), paints, {{0.83, 0.88, 0.9}, {0.97, 1.03, 1.05}});
        for (uint8_t& value : photo.rgb) // the painter encodes what here is encoded already
            value = static_cast<uint8_t>(std::lround(255 * std::pow(value / 255.0, 2.2)));
        smoothEncoded(photo, 0.8);
        expectRead(sketch, photo);
    }
}

// What white card returns, not what the table does, is what paints are told by.
TEST(DetectConditions, tables_of_wood_and_grey_ones) {
    const std::pair<const char*, Color> tables[]{{"cream", {0.78, 0.72, 0.6}}, {"birch", {0.68, 0.56, 0.42}},
                                                 {"beech", {0.6, 0.44, 0.3}},  {"oak", {0.5, 0.38, 0.24}},
                                                 {"grey", {0.35, 0.35, 0.35}}, {"slate", {0.45, 0.5, 0.55}}};
    // Faces in the light and turned away from it, under lamps of two whites and of one.
    const std::pair<Color, Lighting> rooms[]{{{0.78, 0.78, 0.77}, {}},
                                             {{0.45, 0.45, 0.45}, {{0.5, 0.42, 0.3}, {0.45, 0.4, 0.33}}}};
    for (const auto& [name, colour] : tables)
        for (const auto& [face, lamps] : rooms) {
            SCOPED_TRACE(name);
            PaintBox paints;
            paints.table = colour, paints.face = face;
            expectRead(room(), paintTable(room(), exampleRig(), paints, lamps));
        }
}

// Daylight that comes in low reaches the walls' tops and faces; the table about them, and what lies on it,
// has the lamps alone. There the table shows neither the daylight's colour nor its brightness.
TEST(DetectConditions, walls_in_daylight_on_a_white_table_in_their_shadow) {
    const geometry::Rig rig = exampleRig();
    const Lighting daylight{{0.62, 0.66, 0.7}, {0.6, 0.66, 0.72}};
    geometry::Sketch standing;
    standing.walls = room().walls;
    const Photograph walls = paintTable(standing, rig, {}, daylight),
                     bare = paintTable({}, rig, {}, daylight);
    Photograph photo = paintTable(room(), rig, {}, daylight), shaded = photo;
    shade(shaded, rig, {{-13, -9}, {9, -9}, {9, 12}, {-13, 12}}, 0, {0.36, 0.27, 0.2});
    for (size_t i = 0; i < photo.rgb.size(); i += 3)
        if (std::equal(&walls.rgb[i], &walls.rgb[i] + 3, &bare.rgb[i]))
            std::copy_n(&shaded.rgb[i], 3, &photo.rgb[i]);
    expectRead(room(), photo);
    EXPECT_TRUE(warnsOf(detectSketch(photo, rig), "skylights in shadows may be missed"));
}

// A spot of warm lamplight is brighter than the white about it in all channels, as no paint is.
TEST(DetectConditions, a_spot_of_warm_light_is_no_paint) {
    const geometry::Rig rig = exampleRig();
    Photograph photo = paintTable(room(), rig, {}, {{0.3, 0.3, 0.3}, {0.3, 0.3, 0.3}});
    shade(photo, rig, {{-6, 8}, {-2, 8}, {-2, 11}, {-6, 11}}, 0, {2.6, 1.6, 1.15}, 1);
    EXPECT_EQ(fmt::format("{}", fmt::join(detectSketch(photo, rig).warnings, "\n")), "");
}

// Nor does its colour move that of paints: here yellow would be taken for orange.
TEST(DetectConditions, pale_warm_light_beside_an_orange_yellow) {
    const geometry::Rig rig = exampleRig();
    PaintBox paints;
    paints.yellow = {0.68, 0.42, 0.08};
    geometry::Sketch sketch = room();
    sketch.north.reset();
    Photograph photo = paintTable(sketch, rig, paints);
    shade(photo, rig, {{9, -12}, {13, -12}, {13, -8}, {9, -8}}, 0, {1, 0.8, 0.58});
    expectRead(sketch, photo);
}

// The table's noise has every paint's colour there, and its own says nothing of the light's.
TEST(DetectConditions, a_black_table_in_little_light) {
    PaintBox paints;
    paints.table = {0.035, 0.035, 0.035};
    for (const double electrons : {8000.0, 1500.0}) {
        SCOPED_TRACE(electrons);
        Perturbation dim;
        for (double& gain : dim.gain) gain = 0.25;
        dim.electronsAtWhite = electrons, dim.readNoise = 6;
        expectRead(room(), perturbed(paintTable(room(), exampleRig(), paints), dim), 0.12);
    }
}

// Few paints, and more white paper than walls: the walls' ends show what white is.
TEST(DetectConditions, paper_on_a_wooden_table) {
    PaintBox paints;
    paints.table = {0.5, 0.38, 0.24};
    geometry::Sketch sketch;
    sketch.walls = {wall("w1", {-7, -5}, {7, -5}, HeightClass::red),
                    wall("w2", {7.4, -4.6}, {7.4, 5}, HeightClass::blue)};
    Photograph photo = paintTable(sketch, exampleRig(), paints);
    const Color white{0.84, 0.84, 0.83};
    cover(photo, exampleRig(), {{-14, 3}, {-8, 3}, {-8, 9}, {-14, 9}}, 0, white);
    cover(photo, exampleRig(), {{-4, 9}, {3, 8}, {4, 14}, {-3, 15}}, 0, white);
    expectRead(sketch, photo);
}

// Lamps on nothing but the ends of walls on a white table: what the ends say must lose no wall, and where
// they stay brighter than white that is said.
TEST(DetectConditions, lamps_on_the_ends_of_walls) {
    const geometry::Rig rig = exampleRig();
    const Lighting dim{{0.3, 0.29, 0.27}, {0.26, 0.27, 0.29}};
    const auto seen = [&](size_t walls, const Color& gain) {
        geometry::Sketch sketch = room();
        sketch.walls.resize(walls);
        sketch.windows.clear(), sketch.skylights.clear();
        Photograph photo = paintTable(sketch, rig, {}, dim);
        for (const auto& w : sketch.walls)
            for (const glm::dvec2 end : {w.a, w.b}) {
                std::vector<glm::dvec2> corners;
                for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}})
                    corners.push_back(end + glm::dvec2(x, y));
                shade(photo, rig, corners, geometry::heightInches(w.heightClass), gain, 1);
            }
        return detectSketch(photo, rig);
    };
    const DetectionResult single = seen(1, {1, 2.5, 2.5});
    EXPECT_EQ(single.sketch.walls.size(), 1u);
    EXPECT_TRUE(warnsOf(single, "white ends"));
    for (const Color& gain : {Color{1, 3.5, 3.5}, Color{3.5, 1, 1}, Color{3, 3, 3}}) {
        const DetectionResult two = seen(2, gain);
        EXPECT_EQ(two.sketch.walls.size(), 2u) << gain[0];
    }
}

// Without white ends, or wider than a wall, nothing is a wall, whatever its colour.
TEST(DetectConditions, what_has_a_paint_on_a_dark_table_and_is_no_wall) {
    const geometry::Rig rig = exampleRig();
    PaintBox paints;
    paints.table = {0.05, 0.035, 0.028};
    Photograph photo = paintTable(room(), rig, paints);
    const Color skin{0.45, 0.2, 0.13}, red{0.4, 0.06, 0.06};
    cover(photo, rig, {{9, -14}, {13, -12}, {12, -9.6}, {8.2, -11}}, 2, skin);
    cover(photo, rig, {{-14, -9}, {-8, -12}, {-7.83, -11.67}, {-13.83, -8.67}}, 10, red);
    expectRead(room(), photo);
}

// Ray-cast, with grain, joints of planks, soft shadows and light between walls: what of the grain is brighter
// than the table about it is more than all card.
TEST(DetectConditions, ray_cast_tables_of_birch_oak_and_walnut) {
    for (const char* name : {"table_birch", "table_oak", "table_walnut"}) {
        SCOPED_TRACE(name);
        const std::string stem = std::string(HELIODON_TEST_DATA "/vision/") + name;
        const geometry::Sketch stated = geometry::readSketch(stem + ".sketch.json");
        const auto result =
            detectSketch(readPhotograph(stem + ".jpg"), geometry::readRig(stem + ".rig.json"));
        const Score score = scoreSketch(stated, result.sketch);
        for (const auto& [kind, k] : score) {
            EXPECT_EQ(k.found, k.stated) << kind << "\n" << table(score);
            EXPECT_EQ(k.extra, 0) << kind << "\n" << table(score);
            EXPECT_LT(k.placeWorst, 0.2) << kind << "\n" << table(score); // ends under a marker the most
        }
    }
}

WhiteMap whiteOf(const Photograph& photo, const geometry::Rig& rig) {
    const PlanView view(photo, rig.camera, DetectOptions{}.gamma);
    return findWhite(view, findTable(view, rig.tableRadius / geometry::kMetresPerInch, 0.5));
}

// A patch of light adds to every channel and has a colour of its own, as card on a coloured table has. It is
// not taken for card or for a skylight, whether it lies free, across walls or along one.
TEST(DetectConditions, daylight_that_falls_on_a_table_under_tungsten_lamps) {
    const geometry::Rig rig = exampleRig();
    const Lighting lamps{{0.6, 0.52, 0.42}, {0.56, 0.48, 0.38}};
    const Photograph white = paintTable(room(), rig, {}, lamps);
    PaintBox oak;
    oak.table = {0.5, 0.38, 0.24};
    const Photograph wood = paintTable(room(), rig, oak, lamps);
    ASSERT_TRUE(whiteOf(wood, rig).card);
    const std::vector<glm::dvec2> streaks[]{{{-13, 7}, {-9, 13}, {-7, 12}, {-11, 6.5}},
                                            {{-2, -2}, {3, -3}, {3.3, -1.5}, {-1.7, -0.5}},
                                            {{-9, -8}, {-3, 9}, {-2, 9}, {-8, -8}},
                                            {{-6, -8.5}, {6, -8.5}, {6, -7.5}, {-6, -7.5}}};
    for (const auto& streak : streaks)
        for (const double softPx : {0.8, 8.0})
            for (const Color& gain : {Color{1.12, 1.2, 1.5}, Color{1.2, 1.4, 1.9}}) {
                SCOPED_TRACE(testing::Message() << streak[0].x << " " << softPx << " " << gain[2]);
                Photograph photo = white;
                shade(photo, rig, streak, 0, gain, softPx);
                EXPECT_FALSE(whiteOf(photo, rig).card);
                const Score score = scoreSketch(room(), detectSketch(photo, rig).sketch);
                for (const auto& [kind, k] : score) {
                    EXPECT_EQ(k.found, k.stated) << kind << "\n" << table(score);
                    EXPECT_EQ(k.extra, 0) << kind << "\n" << table(score);
                    EXPECT_LT(k.placeWorst, 0.08) << kind << "\n" << table(score);
                }
                photo = wood;
                shade(photo, rig, streak, 0, gain, softPx);
                EXPECT_TRUE(whiteOf(photo, rig).card);
            }
}

TEST(DetectConditions, a_hand_that_touches_a_wall) {
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

TEST(DetectConditions, tokens_in_a_strongly_compressed_file) {
    geometry::Sketch sketch = room();
    PaintBox paints;
    paints.blue = {0.05, 0.08, 0.28};
    Perturbation how;
    how.jpegQuality = 65;
    expectRead(sketch, perturbed(paintTable(sketch, exampleRig(), paints), how), 0.12);
}

// There a step of the file's colours is as large as what parts paint from the table.
TEST(DetectConditions, a_dim_wooden_table_in_a_strongly_compressed_file) {
    geometry::Sketch sketch;
    sketch.walls = room().walls;
    PaintBox birch;
    birch.table = {0.62, 0.46, 0.3};
    Perturbation how;
    how.electronsAtWhite = 1500, how.readNoise = 6;
    for (const auto& [left, quality] : {std::pair{0.1, 35}, {0.1, 45}, {0.2, 25}}) {
        SCOPED_TRACE(testing::Message() << left << " " << quality);
        how.jpegQuality = quality;
        const Lighting dim{{left, 0.85 * left, 0.6 * left}, {0.02, 0.017, 0.012}};
        const Photograph photo = perturbed(paintTable(sketch, exampleRig(), birch, dim), how);
        const Score score = scoreSketch(sketch, detectSketch(photo, exampleRig()).sketch);
        EXPECT_EQ(score.at("wall").found, 4) << table(score);
        EXPECT_EQ(score.at("wall").extra, 0) << table(score);
    }
}

TEST(DetectConditions, walls_cut_from_another_sheet) {
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
TEST(DetectConditions, pens_and_tape_lie_flat) {
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
TEST(DetectConditions, a_walls_end_that_does_not_stand_out) {
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
TEST(DetectConditions, tokens_that_are_out_of_focus) {
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
TEST(DetectConditions, a_square_skylight_on_a_black_table_and_an_arrow_along_its_edge) {
    PaintBox paints;
    paints.table = {0.06, 0.06, 0.06};
    geometry::Sketch sketch = room();
    sketch.skylights[0].size = {1.6, 1.55};
    sketch.north = geometry::NorthArrow{{0, -19.9}, 2, {}};
    expectRead(sketch, paintTable(sketch, exampleRig(), paints));
}

// The exposure was set by the table. Faces of walls and tokens' chips are as bright.
TEST(DetectConditions, an_overexposed_skylight_on_a_black_table) {
    const geometry::Rig rig = exampleRig();
    geometry::Sketch sketch = room(), without;
    sketch.windows.clear();
    sketch.tokens[0].rgb = {245, 245, 245};
    without = sketch;
    without.skylights.clear();
    PaintBox paints;
    paints.table = {0.06, 0.06, 0.06};
    const auto lamps = [](double e) { return Lighting{{e, 0.95 * e, 0.85 * e}, {0.9 * e, 0.95 * e, e}}; };
    const DetectionResult partly = detectSketch(paintTable(sketch, rig, paints, lamps(1.8)), rig);
    ASSERT_EQ(partly.sketch.skylights.size(), 1u); // of its red something is left
    EXPECT_LT(glm::distance(partly.sketch.skylights[0].center, sketch.skylights[0].center), 0.05);
    EXPECT_TRUE(warnsOf(partly, "little of its colour"));
    EXPECT_TRUE(detectSketch(paintTable(without, rig, paints, lamps(1.8)), rig).sketch.skylights.empty());
    const DetectionResult wholly = detectSketch(paintTable(sketch, rig, paints, lamps(3)), rig);
    const Photograph any;
    const glm::dvec2 there = PlanView(any, rig.camera, 2.2).pixel(sketch.skylights[0].center, 0);
    EXPECT_TRUE(warnsOf(wholly, fmt::format("pixel {:.0f}, ", there.x).c_str()));
    EXPECT_TRUE(warnsOf(wholly, "its colour is lost"));
    EXPECT_FALSE(
        warnsOf(detectSketch(paintTable(without, rig, paints, lamps(3)), rig), "its colour is lost"));
}

// The blue of light-blue card is lost before anything of the table's.
TEST(DetectConditions, a_skylight_overexposed_in_blue_alone) {
    const geometry::Rig rig = exampleRig();
    geometry::Sketch sketch = room();
    sketch.windows.clear();
    PaintBox paints;
    paints.table = {0.36, 0.3, 0.35};
    const Lighting lamps{{1.6, 1.45, 1.75}, {1.6, 1.45, 1.75}};
    const DetectionResult result = detectSketch(paintTable(sketch, rig, paints, lamps), rig);
    ASSERT_EQ(result.sketch.skylights.size(), 1u);
}

// Its red and green are lost: against white by these lamps what is left of them is less than its blue.
TEST(DetectConditions, white_paper_overexposed_by_warm_lamps_is_no_skylight) {
    const geometry::Rig rig = exampleRig();
    geometry::Sketch sketch = room();
    sketch.windows.clear();
    PaintBox paints;
    paints.table = {0.2, 0.2, 0.2};
    const Lighting warm{{1.9, 1.43, 0.83}, {1.9, 1.43, 0.83}};
    EXPECT_EQ(detectSketch(paintTable(sketch, rig, paints, warm), rig).sketch.skylights.size(), 1u);
    paints.sky = {0.84, 0.84, 0.83};
    const DetectionResult result = detectSketch(paintTable(sketch, rig, paints, warm), rig);
    EXPECT_TRUE(result.sketch.skylights.empty());
    EXPECT_TRUE(warnsOf(result, "its colour is lost"));
}

TEST(DetectConditions, a_light_blue_sleeve_over_the_tables_edge_is_no_skylight) {
    const geometry::Rig rig = exampleRig();
    Photograph photo = paintTable(room(), rig);
    cover(photo, rig, {{-22.4, -2}, {-18, -2}, {-18, 2}, {-22.4, 2}}, 0, PaintBox{}.sky);
    expectRead(room(), photo);
    EXPECT_TRUE(warnsOf(detectSketch(photo, rig), "light blue like a skylight"));
}

TEST(DetectConditions, says_that_the_white_round_a_chip_is_overexposed) {
    const geometry::Rig rig = exampleRig();
    Photograph photo = paintTable(room(), rig);
    EXPECT_FALSE(warnsOf(detectSketch(photo, rig), "overexposed"));
    shade(photo, rig, {{-5.2, -2.2}, {-2.8, -2.2}, {-2.8, 0.2}, {-5.2, 0.2}}, 0.06, {2, 2, 2});
    EXPECT_TRUE(warnsOf(detectSketch(photo, rig), "the white round a token's chip is overexposed"));
}

// As seen by a tilted camera: in the picture they touch.
TEST(DetectConditions, a_blue_wall_before_a_skylight) {
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
TEST(DetectConditions, a_wall_that_is_light_blue_in_part_beside_bluish_shade) {
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
TEST(DetectConditions, a_speck_beside_a_token) {
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

TEST(DetectConditions, says_that_the_table_is_not_where_the_rig_has_it) {
    const auto offset = [](const Photograph& photo, const geometry::Rig& rig) {
        return tableOffset(PlanView(photo, rig.camera, 2.2), rig.tableRadius / geometry::kMetresPerInch);
    };
    PaintBox black, alike;
    black.table = {0.06, 0.06, 0.06};
    alike.floor = alike.table;
    for (const PaintBox& paints : {PaintBox{}, black}) {
        const Photograph photo = paintTable(room(), exampleRig(), paints);
        for (const glm::dvec2 moved : {glm::dvec2(0), glm::dvec2(3, -4), glm::dvec2(8, -6),
                                       glm::dvec2(-9, 14), glm::dvec2(-45, 20), glm::dvec2(60, 110)}) {
            SCOPED_TRACE(moved.x);
            geometry::Rig rig = exampleRig();
            rig.camera.lens.cx += moved.x, rig.camera.lens.cy += moved.y;
            const glm::dvec2 middle = PlanView(photo, exampleRig().camera, 2.2).pixel({}, 0),
                             there = PlanView(photo, rig.camera, 2.2).plan(middle, 0);
            const auto seen = offset(photo, rig);
            const double off = glm::length(there);
            EXPECT_EQ(seen.has_value(), off > 0.3);
            EXPECT_LT(glm::distance(seen.value_or(there), there),
                      off < 1 ? 0.01 + 0.07 * off : 0.1 + 0.05 * off);
        }
    }
    geometry::Rig rig = exampleRig();
    const Photograph photo = paintTable(room(), rig, alike);
    rig.camera.lens.cx += 60;
    EXPECT_FALSE(offset(photo, rig)); // of the floor's colour: nothing is said
    EXPECT_TRUE(warnsOf(detectSketch(paintTable(room(), exampleRig()), rig), "table's edge"));
}

TEST(DetectConditions, says_that_the_table_has_another_size) {
    geometry::Rig rig = exampleRig();
    const Photograph photo = paintTable(room(), rig);
    EXPECT_FALSE(warnsOf(detectSketch(photo, rig), "in across"));
    for (const double scale : {0.95, 1.04}) { // of the board that the camera was calibrated with
        rig.camera.translation = scale * exampleRig().camera.translation;
        const double radius = rig.tableRadius / geometry::kMetresPerInch;
        const auto seen = tableRadiusSeen(PlanView(photo, rig.camera, 2.2), radius);
        ASSERT_TRUE(seen);
        EXPECT_NEAR(*seen, scale * radius, 0.15); // the step of radii tried, and half a pixel of the edge
        EXPECT_TRUE(warnsOf(detectSketch(photo, rig), "in across"));
    }
}

Photograph mirrored(Photograph photo) {
    const size_t width = static_cast<size_t>(photo.width);
    for (size_t row = 0; row < static_cast<size_t>(photo.height); ++row)
        for (size_t i = 0; 2 * i < width; ++i)
            for (size_t c = 0; c < 3; ++c)
                std::swap(photo.rgb[3 * (row * width + i) + c],
                          photo.rgb[3 * (row * width + width - 1 - i) + c]);
    return photo;
}

TEST(DetectConditions, says_that_the_picture_was_mirrored) {
    geometry::Rig rig =
        exampleRig(); // its camera, four inches aside, and the table where it was in the picture
    geometry::OpticalDevice& camera = rig.camera;
    const glm::dvec3 aside = camera.deviceFromWorld * glm::dvec3(4 * geometry::kMetresPerInch, 0, 0);
    camera.translation -= aside;
    camera.lens.cx += camera.lens.fx * aside.x / camera.translation.z;
    camera.lens.cy += camera.lens.fy * aside.y / camera.translation.z;
    geometry::Sketch sketch;
    sketch.walls = room().walls;
    for (geometry::Wall& wall : sketch.walls) // oblique: every face shifts
        for (glm::dvec2* end : {&wall.a, &wall.b})
            *end = glm::dvec2(end->x - end->y, end->x + end->y) * std::sqrt(0.5);
    const Photograph photo = paintTable(sketch, rig);
    EXPECT_TRUE(detectSketch(photo, rig).warnings.empty());
    EXPECT_TRUE(warnsOf(detectSketch(mirrored(photo), rig), "mirrored left to right"));
    // The table's edge is at its place, and would not be: what the faces seem to say is chance.
    const Photograph other = mirrored(photo);
    Photograph mixed = photo;
    const PlanView view(photo, camera, 2.2);
    for (size_t i = 0; i < mixed.rgb.size(); ++i) {
        const auto pixel = static_cast<int>(i / 3);
        if (glm::length(view.plan(glm::dvec2(pixel % mixed.width, pixel / mixed.width), 0)) < 18)
            mixed.rgb[i] = other.rgb[i];
    }
    EXPECT_FALSE(warnsOf(detectSketch(mixed, rig), "mirrored"));
    // Its camera is over the table's middle but for 0.2 in: only the table's edge tells.
    const Photograph example = readPhotograph(HELIODON_SOURCE "/examples/i01_mixed.png");
    EXPECT_TRUE(warnsOf(detectSketch(mirrored(example), exampleRig()), "mirrored left to right"));
}

// Blur and the squares in which a file keeps colours make strips of it, as wide as walls.
TEST(DetectConditions, the_floors_colour_that_runs_into_the_tables_edge) {
    geometry::Sketch sketch;
    sketch.walls = {wall("w1", {-5, -3}, {5, -3}, HeightClass::red)};
    PaintBox carpet, cloth;
    carpet.floor = {0.3, 0.05, 0.05}, cloth.floor = {0.05, 0.1, 0.3};
    for (const auto& [paints, share, quality] : {std::tuple{carpet, 0.1, 35}, {cloth, 0.3, 60}}) {
        Lighting lamps;
        for (Color* light : {&lamps.left, &lamps.right})
            for (double& channel : *light) channel *= share;
        Perturbation how;
        how.blurPx = 3, how.jpegQuality = quality;
        const Photograph photo = perturbed(paintTable(sketch, exampleRig(), paints, lamps), how);
        const Score score = scoreSketch(sketch, detectSketch(photo, exampleRig()).sketch);
        EXPECT_EQ(score.at("wall").found, 1) << table(score);
        EXPECT_EQ(score.at("wall").extra + score.at("arc").extra, 0) << table(score);
    }
}

// Black has no hue, not even red, nor has what is darker than a file tells hues.
TEST(DetectConditions, a_wall_along_the_tables_edge_before_a_black_floor) {
    const geometry::Rig rig = exampleRig();
    const double radius = rig.tableRadius / geometry::kMetresPerInch;
    const Photograph any;
    const PlanView view(any, rig.camera, 2.2);
    const glm::dvec2 middle = view.plan(view.pixel({0, radius}, 0), geometry::heightInches(HeightClass::red));
    geometry::Sketch sketch;
    sketch.walls = {wall("w1", middle - glm::dvec2(4, 0), middle + glm::dvec2(4, 0), HeightClass::red),
                    wall("w2", {-5, -3}, {5, -3}, HeightClass::blue)};
    for (const double red : {0.0, 1e-5}) { // bytes of 0 and of 1
        SCOPED_TRACE(red);
        PaintBox paints;
        paints.floor = {red, 0, 0};
        expectRead(sketch, paintTable(sketch, rig, paints));
    }
}

TEST(DetectConditions, says_what_is_found_in_doubt) {
    const geometry::Rig rig = exampleRig();
    geometry::Sketch sketch = room();
    const geometry::Wall& wall = sketch.walls.front();
    Photograph photo = paintTable(sketch, rig);
    const glm::dvec2 along = glm::normalize(wall.b - wall.a), across(-along.y, along.x),
                     half = 0.5 * wall.thickness * across, begin = wall.a + 0.3 * along,
                     end = wall.a + 3.0 * along;
    cover(photo, rig, {begin - half, end - half, end + half, begin + half},
          geometry::heightInches(wall.heightClass), {0.84, 0.84, 0.82});
    EXPECT_TRUE(warnsOf(detectSketch(photo, rig), "go on without paint"));
    geometry::Skylight chip;
    chip.size = {0.7, 0.7};
    sketch.skylights = {chip};
    EXPECT_TRUE(warnsOf(detectSketch(paintTable(sketch, rig), rig), "chip of a token"));
    PaintBox mats;
    mats.sky = {0.03, 0.12, 0.3};
    EXPECT_TRUE(warnsOf(detectSketch(paintTable(room(), rig, mats), rig), "deeper or darker"));
}

TEST(DetectConditions, a_seam_of_colour_is_no_arrow_however_orange) {
    const geometry::Rig rig = exampleRig();
    const geometry::Sketch stated = room();
    Photograph photo = paintTable(stated, rig);
    cover(photo, rig,
          {{-1.5, 13.95}, {0.7, 13.93}, {0.7, 13.85}, {1.5, 14}, {0.7, 14.15}, {0.7, 14.07}, {-1.5, 14.05}},
          0.03, PaintBox{}.orange);
    expectRead(stated, photo);
}

// Blur widens an arrow's shaft as much as its head.
TEST(DetectConditions, an_arrow_out_of_focus) {
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

TEST(DetectConditions, orange_light_of_an_arrows_shape_is_none) {
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
TEST(DetectConditions, a_marker_on_a_wall_is_no_arrow) {
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

TEST(DetectConditions, an_arrow_that_points_at_a_marker) {
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
TEST(DetectConditions, an_arrow_that_a_red_wall_touches) {
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
TEST(DetectConditions, other_makers_paints) {
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
TEST(DetectConditions, a_pale_seam_beside_a_wall_is_no_wall) {
    const geometry::Rig rig = exampleRig();
    PaintBox paints;
    paints.face = {0.17, 0.17, 0.17};
    Photograph photo = paintTable(room(), rig, paints);
    cover(photo, rig, {{4, -2}, {4.37, -2}, {4.37, 1}, {4, 1}}, 4, {0.18, 0.3, 0.19});
    expectRead(room(), photo);
}

// A slat's: wider than the gap between two panels.
TEST(DetectConditions, a_streak_of_light_below_a_marker_is_no_joint) {
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
TEST(DetectConditions, a_short_wall_with_a_blot_beside_it_is_no_arc) {
    const geometry::Rig rig = exampleRig();
    geometry::Sketch sketch = room();
    sketch.walls.push_back(wall("w5", {-2, -1}, {0.6, -1}, HeightClass::red));
    Photograph photo = paintTable(sketch, rig);
    cover(photo, rig, {{-1, -0.8125}, {-0.6, -0.8125}, {-0.6, -0.6925}, {-1, -0.6925}}, 10,
          {0.05, 0.05, 0.05});
    expectRead(sketch, photo);
}

// In the picture; what is cut at it falls into straight strips.
TEST(DetectConditions, a_pen_that_touches_a_curved_wall) {
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

TEST(DetectConditions, says_that_a_walls_top_is_light_blue_in_part) {
    const geometry::Rig rig = exampleRig();
    Photograph photo = paintTable(room(), rig);
    cover(photo, rig, {{7.21, 2.5}, {7.59, 2.5}, {7.59, 3.8}, {7.21, 3.8}}, 8, PaintBox{}.sky);
    const auto warnings = detectSketch(photo, rig).warnings;
    EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& line) {
        return line.find("light blue on a wall's top") != std::string::npos;
    })) << fmt::format("{}", fmt::join(warnings, "\n"));
}

TEST(DetectConditions, says_that_a_window_may_be_none_or_another_kind) {
    const geometry::Rig rig = exampleRig();
    geometry::Sketch sketch = room();
    sketch.walls.push_back(wall("w5", {-3, -3}, {3, -3}, HeightClass::green));
    sketch.windows.push_back(window("win4", "w5", 3, 2, WindowKind::standard));
    EXPECT_TRUE(warnsOf(detectSketch(paintTable(sketch, rig), rig), "on a low wall"));
    sketch = room();
    sketch.windows[1].width = 0.6;
    EXPECT_TRUE(warnsOf(detectSketch(paintTable(sketch, rig), rig), "very narrow"));
    Photograph photo = paintTable(room(), rig);
    cover(photo, rig, {{-3, 5.21}, {-1, 5.21}, {-1, 5.59}, {-3, 5.59}}, 10, PaintBox{}.orange);
    EXPECT_TRUE(warnsOf(detectSketch(photo, rig), "orange on a wall's top"));
}

TEST(DetectConditions, says_that_the_table_is_as_blue_as_skylights) {
    PaintBox paints;
    paints.table = {0.16, 0.27, 0.42};
    EXPECT_TRUE(warnsOf(detectSketch(paintTable(room(), exampleRig(), paints), exampleRig()),
                        "colour of light-blue card"));
    geometry::Sketch sketch = room();
    sketch.skylights[0].size = {5, 0.7};
    EXPECT_TRUE(warnsOf(detectSketch(paintTable(sketch, exampleRig()), exampleRig()), "narrow as a wall"));
}

TEST(DetectConditions, says_that_the_picture_is_too_coarse_or_out_of_focus) {
    geometry::Rig rig = exampleRig();
    Perturbation blurred;
    blurred.blurPx = 2.5;
    EXPECT_TRUE(warnsOf(detectSketch(perturbed(paintTable(room(), rig), blurred), rig), "out of focus"));
    geometry::Lens& lens = rig.camera.lens;
    rig.camera.width /= 2, rig.camera.height /= 2;
    lens.fx /= 2, lens.fy /= 2, lens.cx /= 2, lens.cy /= 2;
    EXPECT_TRUE(warnsOf(detectSketch(paintTable(room(), rig), rig), "pixels wide"));
    // Hardly too few pixels are not told as enough.
    rig = exampleRig();
    const double top = 0.375 * PlanView(paintTable({}, rig), rig.camera, 2.2).pixelsPerInch({0, 0}, 0);
    lens.fx *= 4.47 / top, lens.fy *= 4.47 / top;
    EXPECT_TRUE(warnsOf(detectSketch(paintTable(room(), rig), rig), "is 4.47 pixels wide, expected 4.50"));
}

TEST(DetectConditions, says_where_a_wall_is_hidden_or_cut_off) {
    const geometry::Rig rig = exampleRig();
    Photograph photo = paintTable(room(), rig);
    cover(photo, rig, {{-8, -7}, {-3, -7}, {-3, -3}, {-8, -3}}, 10, {0.05, 0.3, 0.1});
    EXPECT_TRUE(warnsOf(detectSketch(photo, rig), "white end is not seen"));
    // What is said of many places is one line.
    photo = paintTable(room(), rig);
    for (int i = 0; i < 8; ++i)
        cover(photo, rig, {{i - 6, 8}, {i - 5.6, 8}, {i - 5.6, 9.5}, {i - 6, 9.5}}, 0, {0.05, 0.38, 0.5});
    const DetectionResult many = detectSketch(photo, rig);
    EXPECT_TRUE(warnsOf(many, "and 4 more places: a window marker on no wall"));
    // Of walls at the picture's edge only a part is seen.
    geometry::Rig near = rig;
    near.camera.lens.fx *= 1.8, near.camera.lens.fy *= 1.8;
    EXPECT_TRUE(warnsOf(detectSketch(paintTable(room(), near), near), "reaches the picture's edge"));
}

TEST(DetectConditions, says_that_light_or_table_hide_something) {
    const geometry::Rig rig = exampleRig();
    Photograph photo = paintTable(room(), rig);
    EXPECT_TRUE(detectSketch(photo, rig).warnings.empty());
    photo.jpegQuality = 20;
    EXPECT_TRUE(warnsOf(detectSketch(photo, rig), "JPEG quality 20"));
    cover(photo, rig, {{-5, 8}, {5, 8}, {5, 14}, {-5, 14}}, 0, {2, 2, 2});
    EXPECT_TRUE(warnsOf(detectSketch(photo, rig), "overexposed"));
    Lighting tungsten;
    tungsten.left = tungsten.right = {1.4, 0.8, 0.5};
    EXPECT_TRUE(
        warnsOf(detectSketch(paintTable(room(), rig, {}, tungsten), rig), "overexposed in red alone"));
    Perturbation dark;
    dark.electronsAtWhite = 60;
    EXPECT_TRUE(warnsOf(detectSketch(perturbed(paintTable(room(), rig), dark), rig), "noise"));
}

TEST(DetectConditions, says_that_paint_is_pale_or_streaked) {
    const geometry::Rig rig = exampleRig();
    const Photograph photo = paintTable(room(), rig);
    Photograph pale = photo;
    for (size_t i = 0; i + 2 < pale.rgb.size(); i += 3) {
        const double grey = (pale.rgb[i] + pale.rgb[i + 1] + pale.rgb[i + 2]) / 3.0;
        for (size_t c = 0; c < 3; ++c)
            pale.rgb[i + c] = static_cast<uint8_t>(std::lround(grey + 0.3 * (pale.rgb[i + c] - grey)));
    }
    const DetectionResult read = detectSketch(pale, rig);
    EXPECT_EQ(read.sketch.walls.size(), room().walls.size());
    EXPECT_TRUE(warnsOf(read, "paint is pale"));
    // Blotches of three quarters of the red light, on every second square of five pixels.
    Photograph mottled = photo;
    for (size_t i = 0; i + 2 < mottled.rgb.size(); i += 3) {
        const size_t x = i / 3 % static_cast<size_t>(photo.width),
                     y = i / 3 / static_cast<size_t>(photo.width);
        if ((x / 5 + y / 5) % 2 == 0) mottled.rgb[i] = static_cast<uint8_t>(0.87 * mottled.rgb[i]);
    }
    EXPECT_TRUE(warnsOf(detectSketch(mottled, rig), "faintly coloured"));
    Photograph streaked = photo;
    for (int i = -6; i < 6; ++i)
        cover(streaked, rig, {{i, 5.4}, {i + 0.6, 5.4}, {i + 0.6, 5.6}, {i, 5.6}},
              geometry::heightInches(HeightClass::red), {0.84, 0.84, 0.82});
    EXPECT_TRUE(warnsOf(detectSketch(streaked, rig), "streaked"));
    EXPECT_TRUE(detectSketch(photo, rig).warnings.empty());
}

// A PNG may say that its values are light itself.
TEST(Photograph, of_a_stated_gamma) {
    const std::string file = ::testing::TempDir() + "linear.png";
    std::ifstream in(HELIODON_SOURCE "/examples/i01_mixed.png", std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(in), {}};
    std::string chunk("gAMA\x00\x01\x86\xA0", 8); // 100000
    uint32_t check = 0xFFFFFFFF;                  // of PNG's chunks: CRC-32
    for (const char c : chunk) {
        check ^= static_cast<uint8_t>(c);
        for (int bit = 0; bit < 8; ++bit) check = check >> 1 ^ (check & 1 ? 0xEDB88320 : 0);
    }
    for (int shift = 24; shift >= 0; shift -= 8) chunk += static_cast<char>(~check >> shift);
    constexpr size_t kAfterHeader = 33;
    bytes.insert(kAfterHeader, std::string("\x00\x00\x00\x04", 4) + chunk);
    std::ofstream(file, std::ios::binary) << bytes;
    const Photograph usual = readPhotograph(HELIODON_SOURCE "/examples/i01_mixed.png"),
                     linear = readPhotograph(file);
    for (size_t i = 0; i < usual.rgb.size(); i += 10007)
        EXPECT_NEAR(linear.rgb[i], 255 * std::pow(usual.rgb[i] / 255.0, 1 / 2.2), 0.51);
    std::filesystem::remove(file);
}

TEST(Photograph, too_many_pixels_are_refused_before_they_are_decoded) {
    const std::string file = testing::TempDir() + "heliodon_too_large";
    const auto refusal = [&](const std::string& bytes) {
        std::ofstream(file, std::ios::binary) << bytes;
        try {
            readPhotograph(file);
        } catch (const geometry::InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    using namespace std::string_literals;
    const std::string said = "20000 x 30000 pixels";
    EXPECT_NE(refusal("\x89PNG\r\n\x1A\n\0\0\0\x0DIHDR\0\0\x4E\x20\0\0\x75\x30"s).find(said),
              std::string::npos);
    EXPECT_NE(refusal("\xFF\xD8\xFF\xC2\0\x11\x08\x75\x30\x4E\x20\3"s).find(said), std::string::npos);
    EXPECT_NE(
        refusal("II*\0\x08\0\0\0\2\0\0\1\3\0\1\0\0\0\x20\x4E\0\0\1\1\4\0\1\0\0\0\x30\x75\0\0"s).find(said),
        std::string::npos);
    EXPECT_NE(refusal("MM\0*\xFF\xFF\xFF\xFF"s), ""); // a directory beyond the file's end
}

// Decoders paint grey what data does not reach. A JPEG has no checksum: what still makes as many pixels
// passes.
TEST(Photograph, with_less_or_more_data_than_pixels_is_refused_by_name) {
    std::ifstream in(HELIODON_TEST_DATA "/vision/i01_mixed_harsh.jpg", std::ios::binary);
    const std::string whole((std::istreambuf_iterator<char>(in)), {});
    const std::string file = testing::TempDir() + "heliodon_damaged.jpg";
    for (const size_t bytes : {1u, 400u}) {
        std::string damaged = whole;
        const size_t at = whole.size() * (bytes == 1 ? 3 : 7) / 10;
        damaged.replace(at, bytes, bytes, bytes == 1 ? static_cast<char>(whole[at] ^ 0x10) : '\x11');
        std::ofstream(file, std::ios::binary) << damaged;
        try {
            readPhotograph(file);
            ADD_FAILURE() << bytes;
        } catch (const geometry::InputError& error) {
            EXPECT_EQ(std::string(error.what()).rfind(file + ": the picture is damaged: ", 0), 0u)
                << error.what();
        }
    }
}

TEST(Photograph, a_tiff_cut_short_is_told_before_it_is_decoded) {
    std::string whole("II*\0\x08\0\0\0\x09\0", 10);
    constexpr int kSide = 40, kPixels = 8 + 2 + 9 * 12 + 4 + 6; // pixels; bytes before them
    const auto entry = [&](int tag, int type, int count, int value) {
        for (const auto& [number, size] : {std::pair{tag, 2}, {type, 2}, {count, 4}, {value, 4}})
            for (int i = 0; i < size; ++i) whole += static_cast<char>(number >> 8 * i & 0xFF);
    };
    entry(256, 3, 1, kSide), entry(257, 3, 1, kSide), entry(258, 3, 3, kPixels - 6), entry(259, 3, 1, 1);
    entry(262, 3, 1, 2), entry(273, 4, 1, kPixels), entry(277, 3, 1, 3), entry(278, 3, 1, kSide);
    entry(279, 4, 1, 3 * kSide * kSide);
    whole += std::string("\0\0\0\0\x08\0\x08\0\x08\0", 10) + std::string(3 * kSide * kSide, 'x');
    const std::string file = testing::TempDir() + "heliodon_cut_short.tif";
    std::ofstream(file, std::ios::binary) << whole;
    EXPECT_EQ(readPhotograph(file).width, kSide);
    for (const size_t length : {whole.size() - 1, whole.size() / 2, size_t{60}}) {
        std::ofstream(file, std::ios::binary) << whole.substr(0, length);
        try {
            readPhotograph(file);
            ADD_FAILURE() << length;
        } catch (const geometry::InputError& error) {
            EXPECT_NE(std::string(error.what()).find("is cut short"), std::string::npos) << error.what();
        }
    }
}

TEST(Photograph, cut_short_or_grey_is_no_photograph) {
    std::ifstream in(HELIODON_TEST_DATA "/vision/i01_mixed_harsh.jpg", std::ios::binary);
    const std::string whole((std::istreambuf_iterator<char>(in)), {});
    const std::string file = testing::TempDir() + "heliodon_cut_short.jpg";
    std::ofstream(file, std::ios::binary) << whole;
    EXPECT_TRUE(hasColor(readPhotograph(file)));
    EXPECT_NEAR(readPhotograph(file).jpegQuality, 90, 10);
    EXPECT_NEAR(readPhotograph(file).chromaStep, 0.4, 0.3);
    EXPECT_EQ(readPhotograph(HELIODON_SOURCE "/examples/i01_mixed.png").chromaStep, 0);
    for (const double share : {0.3, 0.7, 0.99}) {
        std::ofstream(file, std::ios::binary)
            << whole.substr(0, static_cast<size_t>(share * static_cast<double>(whole.size())));
        EXPECT_THROW(readPhotograph(file), geometry::InputError) << share;
    }
    // What a camera adds behind the picture does not make it less whole.
    std::ofstream(file, std::ios::binary) << whole << std::string(100, 'x');
    EXPECT_NO_THROW(readPhotograph(file));
    // Nor what it pads the data with.
    for (const std::string& padding : {std::string("pad"), std::string(512, '\0')}) {
        std::ofstream(file, std::ios::binary) << whole.substr(0, whole.size() - 2) << padding << "\xFF\xD9";
        EXPECT_NO_THROW(readPhotograph(file));
    }
    EXPECT_FALSE(hasColor({2, 1, {9, 9, 9, 200, 200, 200}}));
}

} // namespace
} // namespace heliodon::vision
