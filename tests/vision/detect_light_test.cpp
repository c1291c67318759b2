// Tables, lamps and cameras that are not as one would wish: each test is a class of photographs that was once
// misread.
#include <cmath>
#include <cstdint>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/vision/painted_room.h"
#include "tests/vision/perturb.h"
#include "tests/vision/sketch_score.h"
#include "tests/vision/table_painter.h"
#include "vision/detect.h"
#include "vision/photograph.h"
#include "vision/plan_view.h"
#include "vision/table_edge.h"
#include "vision/white_map.h"

namespace heliodon::vision {
namespace {

using geometry::HeightClass;

TEST(DetectLight, shadows_that_only_a_bluish_light_reaches) {
    const geometry::Rig rig = exampleRig();
    Photograph photo = paintTable(room(), rig);
    shade(photo, rig, {{-7.2, -4.8}, {-2, -4.8}, {-2, 5}, {-7.2, 5}}, 0, {0.22, 0.32, 0.5});
    shade(photo, rig, {{8, -3}, {16, -8}, {14, 4}, {8, 3}}, 0, {0.22, 0.32, 0.5});
    expectRead(room(), photo);
}

// Too little of it to tell that light's colour by. It makes one region with the wall's top, in the last as
// wide and straight as a skylight.
TEST(DetectLight, bluish_shade_along_a_blue_wall) {
    const geometry::Rig rig = exampleRig();
    for (const auto& [gain, softPx] : {std::pair{Color{0.3, 0.4, 0.7}, 2.0}, {Color{0.4, 0.54, 0.9}, 6.0}}) {
        SCOPED_TRACE(softPx);
        Photograph photo = paintTable(room(), rig);
        shade(photo, rig, {{7.6, -4.4}, {9.2, -3}, {8.2, 0.5}, {9.2, 3.8}, {7.6, 4.8}}, 8, gain, softPx);
        expectRead(room(), photo, 0.12);
    }
}

TEST(DetectLight, a_lamp_that_changes_colour_over_the_table) {
    Lighting lamps;
    lamps.left = {0.75, 0.6, 0.36}, lamps.right = {0.4, 0.5, 0.6};
    expectRead(room(), paintTable(room(), exampleRig(), {}, lamps));
}

TEST(DetectLight, a_wooden_floor_and_a_wall_at_the_edge) {
    PaintBox paints;
    paints.floor = {0.24, 0.13, 0.06};
    geometry::Sketch sketch = room();
    sketch.walls.push_back(wall("w5", {12, -15}, {18.5, -8}, HeightClass::red));
    expectRead(sketch, paintTable(sketch, exampleRig(), paints));
}

TEST(DetectLight, pale_cyan_and_a_camera_with_overlapping_filters) {
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

TEST(DetectLight, faces_as_dark_as_the_paint_above_them) {
    PaintBox paints;
    paints.face = {0.17, 0.17, 0.17};
    geometry::Sketch sketch = room();
    sketch.walls.push_back(wall("w5", {-3, 1}, {4, 2.6}, HeightClass::green));
    sketch.skylights.clear();
    expectRead(sketch, paintTable(sketch, exampleRig(), paints));
}

// Scaled in an editor: edges are blended in encoded values, which puts a dark strip's outwards; a shaded face
// beside it does so too.
TEST(DetectLight, a_picture_that_was_scaled_after_it_was_taken) {
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
TEST(DetectLight, tables_of_wood_and_grey_ones) {
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
TEST(DetectLight, walls_in_daylight_on_a_white_table_in_their_shadow) {
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

// Daylight from one side and lamps from the other: walls keep one from the table on either side, and tops are
// in both.
static Photograph roomInTwoLights(const PaintBox& paints, double softPx) {
    const geometry::Rig rig = exampleRig();
    const Color lamp{0.4, 0.3, 0.13}, daylight{0.26, 0.32, 0.42};
    Color both{}, lampOnly{}, daylightOnly{};
    for (size_t c = 0; c < 3; ++c) {
        both[c] = lamp[c] + daylight[c];
        lampOnly[c] = lamp[c] / both[c], daylightOnly[c] = daylight[c] / both[c];
    }
    const Lighting lights{both, both};
    geometry::Sketch standing;
    standing.walls = room().walls, standing.windows = room().windows;
    const Photograph walls = paintTable(standing, rig, paints, lights),
                     bare = paintTable({}, rig, paints, lights);
    Photograph photo = paintTable(room(), rig, paints, lights), shaded = photo;
    shade(shaded, rig, {{-7.2, -4.8}, {-1.6, -4.8}, {-2, 5.2}, {-7.2, 5.2}}, 0, lampOnly, softPx);
    shade(shaded, rig, {{-1.6, -4.8}, {7.2, -4.8}, {7.2, 5.2}, {-2, 5.2}}, 0, daylightOnly, softPx);
    shade(shaded, rig, {{-15, -7}, {-7.6, -4.6}, {-7.6, 5}, {-14, 6}}, 0, daylightOnly, softPx);
    shade(shaded, rig, {{7.6, -4.4}, {14, -7}, {15, 6}, {7.6, 4.8}}, 0, lampOnly, softPx);
    for (size_t i = 0; i < photo.rgb.size(); i += 3)
        if (std::equal(&walls.rgb[i], &walls.rgb[i] + 3, &bare.rgb[i]))
            std::copy_n(&shaded.rgb[i], 3, &photo.rgb[i]);
    return photo;
}

TEST(DetectLight, shadows_of_two_lights_of_different_colours) {
    for (const double softPx : {1.0, 8.0}) {
        SCOPED_TRACE(softPx);
        const Photograph picture = roomInTwoLights({}, softPx);
        expectRead(room(), picture);
        if (softPx == 1) {
            EXPECT_TRUE(warnsOf(detectSketch(picture, exampleRig()), "skylights in shadows may be missed"));
        }
    }
}

// Faces that daylight meets squarely and the lamp does not are brighter than the table and bluer, as card is
// on a table of wood; but the walls' ends have the table's colour.
TEST(DetectLight, faces_in_one_of_two_lights_are_no_card_on_a_coloured_table) {
    PaintBox paints;
    paints.face = {0.95, 1.2, 1.5};
    expectRead(room(), roomInTwoLights(paints, 1));
}

// On a black table card is a mixture of both lights as the table is, but no measure of the light on it.
TEST(DetectLight, faces_in_two_lights_are_no_black_table) {
    geometry::Sketch sketch = room();
    sketch.skylights.clear(); // in shadow
    for (const Color& face : {Color{0.8, 0.8, 0.8}, {0.84, 0.76, 0.62}}) {
        PaintBox paints;
        paints.table = {0.05, 0.05, 0.05}, paints.face = face;
        const auto result = detectSketch(roomInTwoLights(paints, 1), exampleRig());
        const Score score = scoreSketch(sketch, result.sketch);
        for (const auto& [kind, k] : score)
            EXPECT_EQ(k.found, k.stated) << kind << " " << face[2] << "\n" << table(score);
    }
}

// Nor is it paint where the lamp alone meets it, however open the table about it is.
TEST(DetectLight, card_in_the_lamps_light_on_a_black_table_is_no_paint) {
    PaintBox paints;
    paints.table = {0.05, 0.05, 0.05}, paints.face = {0.8, 0.8, 0.8};
    Photograph photo = roomInTwoLights(paints, 1);
    const auto without = detectSketch(photo, exampleRig()).warnings;
    cover(photo, exampleRig(), {{-11, 9}, {-8, 9}, {-8, 10.2}, {-11, 10.2}}, 0, {0.66, 0.5, 0.22});
    EXPECT_EQ(detectSketch(photo, exampleRig()).warnings, without);
}

// A spot of warm lamplight is brighter than the white about it in all channels, as no paint is.
TEST(DetectLight, a_spot_of_warm_light_is_no_paint) {
    const geometry::Rig rig = exampleRig();
    Photograph photo = paintTable(room(), rig, {}, {{0.3, 0.3, 0.3}, {0.3, 0.3, 0.3}});
    shade(photo, rig, {{-6, 8}, {-2, 8}, {-2, 11}, {-6, 11}}, 0, {2.6, 1.6, 1.15}, 1);
    EXPECT_EQ(fmt::format("{}", fmt::join(detectSketch(photo, rig).warnings, "\n")), "");
}

// Nor does its colour move that of paints: here yellow would be taken for orange.
TEST(DetectLight, pale_warm_light_beside_an_orange_yellow) {
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
TEST(DetectLight, a_black_table_in_little_light) {
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
TEST(DetectLight, paper_on_a_wooden_table) {
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
TEST(DetectLight, lamps_on_the_ends_of_walls) {
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

// Ray-cast, with grain, joints of planks, soft shadows and light between walls: what of the grain is brighter
// than the table about it is more than all card.
TEST(DetectLight, ray_cast_tables_of_birch_oak_and_walnut) {
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

// Ray-cast, in daylight and a lamp's light: faces in the one are bluer than the white table in both.
TEST(DetectLight, a_white_table_with_bluer_faces_in_two_lights) {
    const geometry::Rig rig = geometry::readRig(HELIODON_TEST_DATA "/vision/two_lights.rig.json");
    const Photograph photo = readPhotograph(HELIODON_TEST_DATA "/vision/two_lights.jpg");
    EXPECT_TRUE(whiteOf(photo, rig).lights);
    EXPECT_FALSE(whiteOf(photo, rig).card);
    geometry::Sketch stated;
    stated.walls = {wall("w1", {-5.05, -8.63}, {11.33, -3.17}, HeightClass::blue),
                    wall("w2", {11.52, -2.81}, {8.85, 5.19}, HeightClass::blue),
                    wall("w3", {8.34, 5.36}, {0.48, 2.74}, HeightClass::blue),
                    wall("w4", {0.04, 3.06}, {-2.23, 9.9}, HeightClass::blue),
                    wall("w5", {-2.78, 10.05}, {-10.37, 7.52}, HeightClass::blue)};
    const Score score = scoreSketch(stated, detectSketch(photo, rig).sketch);
    EXPECT_EQ(score.at("wall").found, 5) << table(score);
    EXPECT_LT(score.at("wall").placeWorst, 0.1) << table(score);
}

// A patch of light adds to every channel and has a colour of its own, as card on a coloured table has. It is
// not taken for card or for a skylight, whether it lies free, across walls or along one.
TEST(DetectLight, daylight_that_falls_on_a_table_under_tungsten_lamps) {
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

// There a step of the file's colours is as large as what parts paint from the table.
TEST(DetectLight, a_dim_wooden_table_in_a_strongly_compressed_file) {
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

// The exposure was set by the table. Faces of walls and tokens' chips are as bright.
TEST(DetectLight, an_overexposed_skylight_on_a_black_table) {
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
TEST(DetectLight, a_skylight_overexposed_in_blue_alone) {
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
TEST(DetectLight, white_paper_overexposed_by_warm_lamps_is_no_skylight) {
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

// Blur and the squares in which a file keeps colours make strips of it, as wide as walls.
TEST(DetectLight, the_floors_colour_that_runs_into_the_tables_edge) {
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
TEST(DetectLight, a_wall_along_the_tables_edge_before_a_black_floor) {
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

} // namespace
} // namespace heliodon::vision
