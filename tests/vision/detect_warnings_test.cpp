// What detection says of photographs that it reads in doubt.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tests/vision/painted_room.h"
#include "tests/vision/perturb.h"
#include "tests/vision/table_painter.h"
#include "vision/detect.h"
#include "vision/photograph.h"
#include "vision/plan_view.h"
#include "vision/table_edge.h"

namespace heliodon::vision {
namespace {

using geometry::HeightClass;
using geometry::WindowKind;

TEST(DetectWarnings, says_that_the_white_round_a_chip_is_overexposed) {
    const geometry::Rig rig = exampleRig();
    Photograph photo = paintTable(room(), rig);
    EXPECT_FALSE(warnsOf(detectSketch(photo, rig), "overexposed"));
    shade(photo, rig, {{-5.2, -2.2}, {-2.8, -2.2}, {-2.8, 0.2}, {-5.2, 0.2}}, 0.06, {2, 2, 2});
    EXPECT_TRUE(warnsOf(detectSketch(photo, rig), "the white round a token's chip is overexposed"));
}

TEST(DetectWarnings, says_that_the_table_is_not_where_the_rig_has_it) {
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

TEST(DetectWarnings, says_that_the_table_has_another_size) {
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

TEST(DetectWarnings, says_that_the_picture_was_mirrored) {
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

TEST(DetectWarnings, says_what_is_found_in_doubt) {
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

TEST(DetectWarnings, says_that_a_walls_top_is_light_blue_in_part) {
    const geometry::Rig rig = exampleRig();
    Photograph photo = paintTable(room(), rig);
    cover(photo, rig, {{7.21, 2.5}, {7.59, 2.5}, {7.59, 3.8}, {7.21, 3.8}}, 8, PaintBox{}.sky);
    const auto warnings = detectSketch(photo, rig).warnings;
    EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& line) {
        return line.find("light blue on a wall's top") != std::string::npos;
    })) << fmt::format("{}", fmt::join(warnings, "\n"));
}

TEST(DetectWarnings, says_that_a_window_may_be_none_or_another_kind) {
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

TEST(DetectWarnings, says_that_the_table_is_as_blue_as_skylights) {
    PaintBox paints;
    paints.table = {0.16, 0.27, 0.42};
    EXPECT_TRUE(warnsOf(detectSketch(paintTable(room(), exampleRig(), paints), exampleRig()),
                        "colour of light-blue card"));
    geometry::Sketch sketch = room();
    sketch.skylights[0].size = {5, 0.7};
    EXPECT_TRUE(warnsOf(detectSketch(paintTable(sketch, exampleRig()), exampleRig()), "narrow as a wall"));
}

TEST(DetectWarnings, says_that_the_picture_is_too_coarse_or_out_of_focus) {
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

TEST(DetectWarnings, says_where_a_wall_is_hidden_or_cut_off) {
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

TEST(DetectWarnings, says_that_light_or_table_hide_something) {
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

TEST(DetectWarnings, says_that_paint_is_pale_or_streaked) {
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

} // namespace
} // namespace heliodon::vision
