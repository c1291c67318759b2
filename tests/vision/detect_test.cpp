#include "vision/detect.h"

#include <cstring>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "geometry/input_error.h"
#include "tests/vision/perturb.h"
#include "tests/vision/sketch_score.h"
#include "tests/vision/table_painter.h"
#include "vision/wall_evidence.h"

namespace heliodon::vision {
namespace {

const std::string kExamples = HELIODON_SOURCE "/examples/";
const std::string kData = HELIODON_TEST_DATA "/vision/", kSketches = HELIODON_TEST_DATA "/geometry/sketches/";

geometry::Rig exampleRig() {
    return geometry::readRig(kExamples + "rig.json");
}
Photograph bright() {
    return readPhotograph(kExamples + "i01_mixed.png");
}
geometry::Sketch brightSketch() {
    return geometry::readSketch(kSketches + "i01_mixed.sketch.json");
}

// Everything that is stated is found, nothing else is, and it lies where it should.
void expectAll(const Score& score, double placeInches, double angleDegrees) {
    for (const auto& [kind, k] : score) {
        EXPECT_EQ(k.found, k.stated) << kind << "\n" << table(score);
        EXPECT_EQ(k.extra, 0) << kind << "\n" << table(score);
        EXPECT_LT(k.placeWorst, placeInches) << kind;
        EXPECT_LT(k.angleWorst, angleDegrees) << kind;
    }
}

// A pixel is 0.04 in at the walls' tops. 0.06 in is the farthest corner of a skylight; walls and windows stay
// below 0.03.
constexpr double kPlace = 0.06;
// Half a pixel over the two inches of the shortest side.
constexpr double kAngle = 0.5;

TEST(Detect, reads_every_kind_of_primitive_from_a_bright_picture) {
    const auto result = detectSketch(bright(), exampleRig());
    const Score score = scoreSketch(brightSketch(), result.sketch);
    expectAll(score, kPlace, 0.3);
    EXPECT_LT(score.at("wall").placeWorst, 0.05);
    EXPECT_LT(score.at("token").colorWorst,
              12); // filters of the synthetic camera mix 2 % of the neighbouring channels
    EXPECT_TRUE(result.warnings.empty());
    for (const auto& wall : result.sketch.walls) {
        EXPECT_GT(wall.detection.confidence, 0.9);
        EXPECT_GE(wall.detection.outlinePx.size(), 4u);
    }
}

TEST(Detect, reads_a_dim_picture_cluttered_by_projector_shadows) {
    const auto result = detectSketch(readPhotograph(kData + "p04_L_dim.png"), exampleRig());
    expectAll(scoreSketch(geometry::readSketch(kSketches + "p04_L.json"), result.sketch), kPlace, 0.3);
}

TEST(Detect, reads_a_harsh_noisy_picture_under_a_warm_cast) {
    const auto result = detectSketch(readPhotograph(kData + "i01_mixed_harsh.jpg"), exampleRig());
    expectAll(scoreSketch(brightSketch(), result.sketch), kPlace, kAngle);
}

TEST(Detect, sees_two_walls_where_a_marker_hides_their_joint) {
    const auto result = detectSketch(readPhotograph(kData + "p10_window_over_joint_good.jpg"), exampleRig());
    // The stripe of light in the joint is 0.25 in wide and lies within the 0.3 in of the gap's edges.
    expectAll(scoreSketch(geometry::readSketch(kSketches + "p10_window_over_joint.json"), result.sketch),
              0.15, 0.3);
}

TEST(Detect, gives_the_same_sketch_every_time) {
    const Photograph photo = bright();
    const geometry::Rig rig = exampleRig();
    const auto first = detectSketch(photo, rig).sketch, second = detectSketch(photo, rig).sketch;
    ASSERT_EQ(first.walls.size(), second.walls.size());
    for (size_t i = 0; i < first.walls.size(); ++i) {
        EXPECT_EQ(first.walls[i].a, second.walls[i].a);
        EXPECT_EQ(first.walls[i].id, second.walls[i].id);
    }
}

TEST(Detect, does_not_depend_on_gamma_cast_or_paint_box) {
    const Photograph photo = bright();
    const geometry::Rig rig = exampleRig();
    Perturbation low, high, warm, cold, turnedBack, turnedOn, compressed;
    low.gamma = 1.8;
    high.gamma = 2.4;
    warm.gain[1] = 0.9, warm.gain[2] = 0.55;
    cold.gain[0] = 0.6, cold.gain[1] = 0.85;
    turnedBack.hueDegrees = -8;
    turnedOn.hueDegrees = 8;
    compressed.jpegQuality = 80, compressed.blurPx = 0.8;
    for (const Perturbation& how : {low, high, warm, cold, turnedBack, turnedOn, compressed}) {
        SCOPED_TRACE(fmt::format("gamma {} gains {} {} {} hue {} jpeg {}", how.gamma, how.gain[0],
                                 how.gain[1], how.gain[2], how.hueDegrees, how.jpegQuality));
        // A wrong gamma moves an edge by about 0.02 in.
        expectAll(scoreSketch(brightSketch(), detectSketch(perturbed(photo, how), rig).sketch), 0.09, kAngle);
    }
}

TEST(Detect, follows_another_lens_and_pose) {
    geometry::Rig rig = exampleRig();
    geometry::Lens lens = rig.camera.lens;
    lens.fx *= 0.85, lens.fy *= 0.85, lens.dist = {-0.25, 0.12, -0.001, 0.0008, 0.01};
    const Photograph photo = rephotographed(bright(), rig, {-5, 4, -110}, lens);
    expectAll(scoreSketch(brightSketch(), detectSketch(photo, rig).sketch), kPlace, kAngle);
}

geometry::Wall wall(const char* id, glm::dvec2 a, glm::dvec2 b, geometry::HeightClass height) {
    geometry::Wall out;
    out.id = id, out.a = a, out.b = b, out.heightClass = height;
    return out;
}

geometry::WindowMarker window(const char* id, const char* on, double pos, double width,
                              geometry::WindowKind kind) {
    geometry::WindowMarker out;
    out.id = id, out.wall = on, out.pos = pos, out.width = width, out.kind = kind;
    return out;
}

geometry::Arc arc(const char* id, glm::dvec2 center, double radius, double a0, double a1,
                  geometry::HeightClass height) {
    geometry::Arc out;
    out.id = id, out.center = center, out.radius = radius, out.a0Deg = a0, out.a1Deg = a1,
    out.heightClass = height;
    return out;
}

TEST(Detect, reads_s_curves_neighbouring_markers_and_a_wall_over_the_edge) {
    using geometry::HeightClass;
    using geometry::WindowKind;
    geometry::Sketch sketch;
    sketch.arcs = {arc("a1", {-6, 4}, 3.5, 10, 170, HeightClass::blue),
                   arc("a2", {1.6, 4}, 3.5, 190, 350, HeightClass::blue),
                   arc("a3", {9, -9}, 14, 95, 118, HeightClass::green)};
    sketch.walls = {wall("w1", {-14, -8}, {-3, -10}, HeightClass::red),
                    wall("w2", {14, 3}, {22.5, 5}, HeightClass::red),
                    wall("w3", {2, -12}, {6, -15}, HeightClass::green)};
    sketch.windows = {window("win1", "w1", 3, 2, WindowKind::standard),
                      window("win2", "w1", 5, 2, WindowKind::transom),
                      window("win3", "w1", 8.2, 1, WindowKind::picture)};
    sketch.skylights = {{"sky1", {-12, 8}, {4, 1.2}, 30, {}}};
    geometry::Token token;
    token.id = "token1", token.kind = geometry::TokenKind::wallSingle, token.pos = {-9, -13},
    token.angleDeg = 20;
    token.rgb = {30, 30, 30};
    sketch.tokens = {token};
    sketch.north = geometry::NorthArrow{{12, 10}, 250, {}};
    const geometry::Rig rig = exampleRig();
    const auto result = detectSketch(paintTable(sketch, rig), rig);
    const Score score = scoreSketch(sketch, result.sketch);
    expectAll(score, kPlace, kAngle);
    EXPECT_LT(score.at("token").colorWorst, 12);
}

// The paint that a marker leaves before the white end is no region of its own.
TEST(Detect, ends_a_wall_by_the_quarter_inch_of_paint_beyond_a_marker) {
    using geometry::HeightClass;
    using geometry::WindowKind;
    const geometry::Rig rig = exampleRig();
    for (const double bare : {0.2, 0.3}) {
        geometry::Sketch sketch;
        sketch.walls = {wall("w1", {-12, -8}, {-2, -8}, HeightClass::blue),
                        wall("w2", {3, -7}, {12, -2}, HeightClass::red),
                        wall("w3", {-4, 9}, {5, 8}, HeightClass::blue)};
        const double first = 0.5 + bare + 0.75;
        sketch.windows = {window("win1", "w1", first, 1.5, WindowKind::standard),
                          window("win2", "w2", first, 1.5, WindowKind::transom),
                          window("win3", "w3", first, 1.5, WindowKind::picture)};
        const Score score = scoreSketch(sketch, detectSketch(paintTable(sketch, rig), rig).sketch);
        expectAll(score, kPlace, kAngle);
    }
}

// A twentieth of an inch of paint is not seen; the edge of the white end is, beyond half an inch.
TEST(Detect, ends_a_wall_by_its_white_end_beyond_a_marker) {
    using geometry::HeightClass;
    using geometry::WindowKind;
    const geometry::Rig rig = exampleRig();
    PaintBox paints;
    paints.table = {0.5, 0.5, 0.49};
    geometry::Sketch sketch;
    sketch.walls = {wall("w1", {-12, -8}, {-2, -8}, HeightClass::blue),
                    wall("w2", {3, -7}, {12, -2}, HeightClass::red),
                    wall("w3", {-4, 9}, {5, 8}, HeightClass::blue)};
    sketch.windows = {window("win1", "w1", 1.3, 1.5, WindowKind::standard),
                      window("win2", "w2", 1.3, 1.5, WindowKind::transom),
                      window("win3", "w3", 1.3, 1.5, WindowKind::picture)};
    expectAll(scoreSketch(sketch, detectSketch(paintTable(sketch, rig, paints), rig).sketch), 0.08, kAngle);
}

TEST(Detect, reads_random_walls_under_random_poses_and_lamps) {
    std::mt19937 random(20);
    auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (int trial = 0; trial < 4; ++trial) {
        geometry::Rig rig = exampleRig();
        geometry::Sketch sketch;
        for (int i = 0; i < 400 && sketch.walls.size() < 9; ++i) {
            const glm::dvec2 a(uniform(-14, 14), uniform(-14, 14));
            const double length = uniform(3, 10), angle = uniform(0, 360);
            const glm::dvec2 b = a + length * score::direction(angle);
            bool clear = glm::length(b) < 18;
            // Three inches apart: tops lean outwards in the picture by up to that and would hide one another.
            for (const auto& other : sketch.walls)
                for (double s = 0; s <= 1; s += 0.05)
                    for (double t = 0; t <= 1; t += 0.05)
                        clear =
                            clear && glm::distance(a + s * (b - a), other.a + t * (other.b - other.a)) > 3.2;
            if (!clear) continue;
            const auto height = static_cast<geometry::HeightClass>(random() % 3);
            const std::string id = fmt::format("w{}", sketch.walls.size() + 1);
            sketch.walls.push_back(wall(id.c_str(), a, b, height));
            if (length > 5)
                sketch.windows.push_back(window(fmt::format("win{}", id).c_str(), id.c_str(),
                                                uniform(2, length - 2), 1.5,
                                                static_cast<geometry::WindowKind>(random() % 3)));
        }
        Lighting lamps;
        for (size_t c = 0; c < 3; ++c) lamps.left[c] = uniform(0.3, 0.9), lamps.right[c] = uniform(0.3, 0.9);
        Photograph photo = paintTable(sketch, rig, {}, lamps);
        geometry::Lens lens = rig.camera.lens;
        photo = rephotographed(photo, rig, {uniform(-4, 4), uniform(-4, 4), uniform(-180, 180)}, lens);
        Perturbation noise;
        noise.electronsAtWhite = 1500, noise.readNoise = 6, noise.seed = static_cast<unsigned>(random());
        const auto result = detectSketch(perturbed(photo, noise), rig);
        SCOPED_TRACE(trial);
        expectAll(scoreSketch(sketch, result.sketch), kPlace, kAngle);
    }
}

TEST(Detect, finds_nothing_where_there_is_nothing) {
    const geometry::Rig rig = exampleRig();
    const size_t bytes = static_cast<size_t>(rig.camera.width) * static_cast<size_t>(rig.camera.height) * 3;
    Photograph photo{rig.camera.width, rig.camera.height, std::vector<uint8_t>(bytes, 0)};
    auto empty = [&](const char* what) {
        const auto result = detectSketch(photo, rig);
        EXPECT_TRUE(result.sketch.walls.empty() && result.sketch.arcs.empty() &&
                    result.sketch.windows.empty())
            << what;
        EXPECT_FALSE(result.warnings.empty()) << what;
    };
    empty("black");
    photo.rgb.assign(bytes, 255);
    empty("white");
    photo.rgb.assign(bytes, 1);
    empty("nearly black");
    for (size_t i = 0; i < bytes; i += 3) photo.rgb[i] = 200;
    empty("all red");
    std::mt19937 random(5);
    for (auto& b : photo.rgb) b = static_cast<uint8_t>(random());
    empty("noise");
    for (auto& b : photo.rgb) b = static_cast<uint8_t>(random() % 4);
    empty("dark noise");
    photo = paintTable({}, rig);
    empty("an empty table");
}

TEST(Detect, does_not_invent_walls_in_coarse_noise_or_stripes) {
    const geometry::Rig rig = exampleRig();
    std::mt19937 random(6);
    for (const int size : {12, 40, 150}) {
        Photograph photo{rig.camera.width, rig.camera.height, {}};
        const int columns = photo.width / size + 1, rows = photo.height / size + 1;
        std::vector<uint8_t> coarse(static_cast<size_t>(columns * rows * 3));
        for (auto& b : coarse) b = static_cast<uint8_t>(random());
        for (int y = 0; y < photo.height; ++y)
            for (int x = 0; x < photo.width; ++x)
                for (int c = 0; c < 3; ++c)
                    photo.rgb.push_back(
                        coarse[static_cast<size_t>(((y / size) * columns + x / size) * 3 + c)]);
        EXPECT_NO_THROW(detectSketch(photo, rig)) << size; // whatever it makes of it, it comes back
    }
}

TEST(Detect, warns_of_what_it_leaves_out) {
    const geometry::Rig rig = exampleRig();
    geometry::Sketch sketch;
    sketch.walls = {wall("w1", {-6, 0}, {6, 0}, geometry::HeightClass::red)};
    PaintBox paints;
    Photograph photo = paintTable(sketch, rig, paints);
    for (int y = 700; y < 760; ++y) // a red pamphlet
        for (int x = 600; x < 700; ++x) {
            const uint8_t red[3] = {170, 60, 60};
            std::memcpy(&photo.rgb[3 * (static_cast<size_t>(y) * static_cast<size_t>(photo.width) +
                                        static_cast<size_t>(x))],
                        red, 3);
        }
    const auto result = detectSketch(photo, rig);
    EXPECT_EQ(result.sketch.walls.size(), 1u);
    ASSERT_EQ(result.warnings.size(), 1u);
    EXPECT_NE(result.warnings[0].find("coloured like a wall"), std::string::npos) << result.warnings[0];
}

TEST(Detect, refuses_a_photograph_of_another_size) {
    const Photograph small{64, 48, std::vector<uint8_t>(64 * 48 * 3, 200)};
    try {
        detectSketch(small, exampleRig());
        FAIL() << "accepted";
    } catch (const geometry::InputError& error) {
        EXPECT_STREQ(error.what(), "photograph: 64 x 48 pixels, but the rig's camera has 1392 x 1032");
    }
    try {
        detectSketch({1032, 1392, std::vector<uint8_t>(1032 * 1392 * 3, 200)}, exampleRig());
        FAIL() << "accepted";
    } catch (const geometry::InputError& error) {
        EXPECT_NE(std::string(error.what()).find("it was turned"), std::string::npos) << error.what();
    }
}

// 3 x 2 pixels, not compressed.
struct Tiff {
    bool highFirst = false, big = false;

    std::string number(uint64_t value, int bytes) const {
        std::string text;
        for (int k = 0; k < bytes; ++k)
            text += static_cast<char>(value >> (8 * (highFirst ? bytes - 1 - k : k)) & 0xFF);
        return text;
    }
    std::string entry(uint64_t tag, int type, uint64_t value) const { // 3: two bytes, 4: four
        const int wide = big ? 8 : 4, bytes = type == 3 ? 2 : 4;
        return number(tag, 2) + number(static_cast<uint64_t>(type), 2) + number(1, wide) +
               number(value, bytes) + std::string(static_cast<size_t>(wide - bytes), '\0');
    }
    std::string of(const std::string& pixels, int orientation) const {
        const uint64_t at = big ? 16 + 8 + 9 * 20 + 8 : 8 + 2 + 9 * 12 + 4;
        return (highFirst ? "MM" : "II") +
               (big ? number(43, 2) + number(8, 2) + number(0, 2) + number(16, 8) + number(9, 8)
                    : number(42, 2) + number(8, 4) + number(9, 2)) +
               entry(256, 3, 3) + entry(257, 3, 2) + entry(258, 3, 8) + entry(259, 3, 1) + entry(262, 3, 2) +
               entry(273, 4, at) + entry(274, 3, static_cast<uint64_t>(orientation)) + entry(277, 3, 3) +
               entry(279, 4, pixels.size()) + number(0, big ? 8 : 4) + pixels;
    }
};

// As the sensor had it, whichever way up the camera believed to be: the rig was calibrated on that.
TEST(Photograph, does_not_follow_the_orientation_that_its_file_states) {
    const std::string file = testing::TempDir() + "heliodon_oriented";
    for (const Tiff& tiff : {Tiff{}, Tiff{.highFirst = true}, Tiff{.big = true}})
        for (const int orientation : {1, 2, 3, 4, 6, 8}) {
            std::ofstream(file, std::ios::binary) << tiff.of("abcdefghijklmnopqr", orientation);
            const Photograph photo = readPhotograph(file);
            EXPECT_EQ(photo.width, 3) << orientation;
            EXPECT_EQ(std::string(photo.rgb.begin(), photo.rgb.end()), "abcdefghijklmnopqr")
                << orientation << tiff.highFirst << tiff.big;
        }
    std::ifstream in(kData + "i01_mixed_harsh.jpg", std::ios::binary);
    std::string jpeg((std::istreambuf_iterator<char>(in)), {});
    using namespace std::string_literals;
    jpeg.insert(2, "\xFF\xE1\0\x22"
                   "Exif\0\0II*\0\x08\0\0\0\1\0"s +
                       Tiff{}.entry(274, 3, 6) + "\0\0\0\0"s);
    std::ofstream(file, std::ios::binary) << jpeg;
    EXPECT_EQ(readPhotograph(file).rgb, readPhotograph(kData + "i01_mixed_harsh.jpg").rgb);
}

TEST(Photograph, names_a_file_that_is_missing_or_no_picture) {
    auto complaint = [](const std::string& file) -> std::string {
        try {
            readPhotograph(file);
        } catch (const geometry::InputError& error) {
            return error.what();
        }
        return "accepted";
    };
    EXPECT_EQ(complaint("/no/such.png"),
              "/no/such.png: no such file, expected a photograph (png, jpg or tif)");
    const std::string text = testing::TempDir() + "heliodon_not_a_picture.png";
    std::ofstream(text) << "hello";
    EXPECT_NE(complaint(text).find("not an image"), std::string::npos);
    // A picture cut short anywhere is refused, or read with what it has; it never brings the program down.
    std::ifstream in(kExamples + "i01_mixed.png", std::ios::binary);
    const std::string whole((std::istreambuf_iterator<char>(in)), {});
    for (const size_t length : {8u, 20u, 33u, 60u, 5000u}) {
        std::ofstream(text, std::ios::binary) << whole.substr(0, length);
        complaint(text);
    }
    std::string damaged = whole;
    damaged[whole.size() / 2] ^= 1;
    std::ofstream(text, std::ios::binary) << damaged;
    EXPECT_NE(complaint(text).find("is damaged"), std::string::npos) << complaint(text);
}

// Among walls of which nearly all have bright ends, a strip with nothing but table at both of its own is a
// pen, whatever the shade along its sides looks like; where several lack theirs, light may be what hides
// them.
TEST(Relief, a_pen_in_light_that_makes_a_foot_of_its_shade) {
    constexpr EndLook bare = EndLook::bare, other = EndLook::other;
    const Relief wall{{0.3f, 0.4f}, 0.2f}, pen{{-0.3f, 0}, 0.2f, 1, 1, {bare, bare}},
        hidden{{-0.3f, 0}, 0.2f, 1, 1, {bare, other}};
    EXPECT_EQ(lieFlat({wall, wall, wall, wall, pen})[4], Lies::flat);
    EXPECT_EQ(lieFlat({wall, wall, wall, wall, hidden})[4], Lies::unsure);
    EXPECT_EQ(lieFlat({wall, wall, pen, pen, pen})[4], Lies::unsure);
}

TEST(Relief, pens_with_one_shining_cap_do_not_make_a_faint_wall_one_of_them) {
    const Relief pen{{0.01f, 0.5f}, 0.01f}, wall{{0.3f, 0.3f}, 0.2f}, faint{{0.12f, 0.3f}, 0.03f};
    const std::vector<Lies> lies = lieFlat({pen, pen, pen, pen, pen, wall, wall, faint});
    for (size_t i = 0; i < lies.size(); ++i) EXPECT_EQ(lies[i], i < 5 ? Lies::flat : Lies::no) << i;
}

TEST(Overlay, draws_over_the_photograph_and_names_what_was_found) {
    const Photograph photo = bright();
    const geometry::Rig rig = exampleRig();
    const Overlay plain = drawOverlay(photo, rig, brightSketch()); // without outlines: nothing to name
    EXPECT_TRUE(plain.tags.empty());
    const geometry::Sketch found = detectSketch(photo, rig).sketch;
    const Overlay drawn = drawOverlay(photo, rig, found);
    EXPECT_EQ(drawn.picture.width, photo.width);
    EXPECT_EQ(drawn.picture.height, photo.height);
    EXPECT_NE(plain.picture.rgb, drawn.picture.rgb);
    EXPECT_EQ(drawn.tags.size(), found.walls.size() + found.arcs.size() + found.windows.size() +
                                     found.skylights.size() + found.tokens.size() + found.north.has_value());
}

} // namespace
} // namespace heliodon::vision
