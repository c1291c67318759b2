#include "geometry/sketch.h"

#include <filesystem>
#include <fstream>
#include <functional>

#include <gtest/gtest.h>
#include <unistd.h>

#include "geometry/building.h"
#include "geometry/input_error.h"
#include "tests/documented_file.h"

using namespace heliodon::geometry;
namespace fs = std::filesystem;

namespace {

class SketchFile : public testing::Test {
protected:
    fs::path file = fs::temp_directory_path() / ("heliodon_sketch_" + std::to_string(::getpid()) + ".json");

    void TearDown() override { fs::remove(file); }

    Sketch read(const std::string& text) {
        std::ofstream(file) << text;
        return readSketch(file);
    }

    // The message of the refusal, after the file's name.
    std::string refusal(const std::string& text) {
        try {
            read(text);
        } catch (const InputError& error) {
            const std::string what = error.what();
            EXPECT_TRUE(what.starts_with(file.string())) << what;
            return what.substr(std::min(what.size(), file.string().size() + 1));
        }
        return "accepted";
    }

    std::string withWall(const std::string& wall) {
        return R"({"format": "vh-sketch/1", "walls": [)" + wall + "]}";
    }
};

void expectSameDetection(const Detection& a, const Detection& b) {
    EXPECT_EQ(a.confidence, b.confidence);
    EXPECT_EQ(a.outlinePx, b.outlinePx);
}

} // namespace

TEST_F(SketchFile, without_end_is_refused) {
    fs::create_symlink("/dev/zero", file);
    EXPECT_EQ(refusal(""), " is larger than 64 MiB, expected a sketch (vh-sketch/1)");
}

TEST_F(SketchFile, a_field_that_is_there_twice_is_refused_by_name) {
    EXPECT_EQ(refusal(R"({"format": "vh-sketch/1", "walls": [], "windows": [], "walls": []})"),
              "walls: is there twice, expected it once");
    const std::string wall = R"({"a": [0, 0], "b": [9, 0], "height_class": "red"})";
    EXPECT_EQ(refusal(withWall(wall + R"(, {"a": [0, 0], "b": [9, 0], "a": [1, 0], "height_class": "red"})")),
              "walls[1].a: is there twice, expected it once");
    EXPECT_EQ(refusal(R"({"format": "vh-sketch/1", "table": {"diameter": 42, "diameter": 24}})"),
              "table.diameter: is there twice, expected it once");
}

TEST_F(SketchFile, the_documented_one_is_a_room) {
    const Sketch sketch = read(heliodon::test::documentedFile("vh-sketch/1"));
    EXPECT_TRUE(sketch.unknownFields.empty());
    const ClosureReport report = closeSketch(sketch).report;
    EXPECT_EQ(report.code, "OK") << report.message;
    ASSERT_EQ(report.rooms.size(), 1u);
    // Centre lines 16 x 12 and half a disc of radius 6, less half a wall's thickness all round.
    EXPECT_NEAR(report.rooms[0].floorAreaFt2, 15.8125 * 11.625 + 1.5707963 * 5.8125 * 5.8125, 2);
    EXPECT_EQ(report.windowCount, 1);
    EXPECT_EQ(report.skylightPaneCount, 1);
}

TEST_F(SketchFile, written_and_read_back_is_the_same_sketch) {
    Sketch sketch = readSketch(HELIODON_TEST_DATA "/geometry/sketches/i01_mixed.sketch.json");
    ASSERT_EQ(sketch.walls.size(), 6u);
    sketch.walls[2].detection = {0.1234567890123, {{1.5, 2.25}, {1.0 / 3, 4}, {5, 6}}};
    writeSketch(sketch, file);
    const Sketch again = readSketch(file);
    ASSERT_EQ(again.walls.size(), sketch.walls.size());
    for (size_t i = 0; i < sketch.walls.size(); ++i) {
        EXPECT_EQ(again.walls[i].id, sketch.walls[i].id);
        EXPECT_EQ(again.walls[i].a, sketch.walls[i].a);
        EXPECT_EQ(again.walls[i].b, sketch.walls[i].b);
        EXPECT_EQ(again.walls[i].thickness, sketch.walls[i].thickness);
        EXPECT_EQ(again.walls[i].heightClass, sketch.walls[i].heightClass);
        expectSameDetection(again.walls[i].detection, sketch.walls[i].detection);
    }
    ASSERT_EQ(again.arcs.size(), sketch.arcs.size());
    EXPECT_EQ(again.arcs[0].a1Deg, sketch.arcs[0].a1Deg);
    ASSERT_EQ(again.windows.size(), sketch.windows.size());
    EXPECT_EQ(again.windows[1].kind, sketch.windows[1].kind);
    EXPECT_EQ(again.windows[1].pos, sketch.windows[1].pos);
    ASSERT_EQ(again.skylights.size(), sketch.skylights.size());
    ASSERT_EQ(again.tokens.size(), sketch.tokens.size());
    EXPECT_EQ(again.tokens[0].rgb, sketch.tokens[0].rgb);
    ASSERT_TRUE(again.north.has_value());
    EXPECT_EQ(again.north->dirDeg, sketch.north->dirDeg);
}

TEST_F(SketchFile, bad_fields_are_named_with_what_was_expected) {
    const std::string wall = R"({"a": [0, 0], "b": [1, 0], "height_class": "red")";
    EXPECT_EQ(refusal(withWall(wall + R"(, "thickness": -1})")),
              "walls[0].thickness: is -1, expected a number above 0");
    EXPECT_EQ(refusal(withWall(wall + R"(, "thickness": 0})")),
              "walls[0].thickness: is 0, expected a number above 0");
    EXPECT_EQ(refusal(withWall(wall + "}, " + R"({"a": [0], "b": [1, 0], "height_class": "red"})")),
              "walls[1].a: expected two numbers [x, y]");
    EXPECT_EQ(refusal(withWall(R"({"a": [0, 0], "b": [1, 0], "height_class": "pink"})")),
              "walls[0].height_class: is \"pink\", expected red, blue or green");
    EXPECT_EQ(refusal(withWall(R"({"a": [0, 1e300], "b": [1, 0], "height_class": "red"})")),
              "walls[0].a: is 1e+300, expected a finite number within +-10000");
    EXPECT_EQ(refusal(withWall(wall + R"(, "id": "w"}, )" + wall + R"(, "id": "w"})")),
              "walls[1].id: \"w\" is used twice");
    EXPECT_EQ(refusal(R"({"format": "vh-sketch/1", "arcs": [{"center": [0, 0], "radius": 2, "a0_deg": 90,
              "a1_deg": 80, "height_class": "blue"}]})"),
              "arcs[0].a1_deg: expected more than a0_deg (arcs run counter-clockwise)");
    EXPECT_EQ(refusal(R"({"format": "vh-sketch/1", "windows": [{"wall": "w9", "pos": 1, "width": 1,
              "kind": "picture"}]})"),
              "windows[0].wall: \"w9\" is no wall of this sketch");
    EXPECT_EQ(refusal(R"({"format": "vh-sketch/1", "tokens": [{"kind": "floor", "pos": [0, 0],
              "rgb": [1, 2, 256]}]})"),
              "tokens[0].rgb: expected three numbers, 0 to 255");
    EXPECT_EQ(refusal(R"({"format": "other"})"), "format: is \"other\", expected \"vh-sketch/1\"");
    EXPECT_EQ(refusal("[]"), " expected an object");
    EXPECT_NE(refusal(withWall(R"({"a": [0, 1e999], "b": [1, 0], "height_class": "red"})")), "accepted");
}

TEST_F(SketchFile, other_units_and_scales_are_refused) {
    EXPECT_EQ(refusal(R"({"format": "vh-sketch/1", "units": "cm"})"), "units: is \"cm\", expected \"inch\"");
    EXPECT_EQ(refusal(R"({"format": "vh-sketch/1", "scale": "1in=2ft"})"),
              "scale: is \"1in=2ft\", expected \"1in=1ft\"");
    EXPECT_EQ(refusal(R"({"format": "vh-sketch/1", "table": {"center": [5, 0]}})"),
              "table.center: is not [0, 0], expected the origin there");
    EXPECT_EQ(refusal(R"({"format": "vh-sketch/1", "units": "inch", "scale": "1in=1ft"})"), "accepted");
}

TEST_F(SketchFile, misspelt_fields_are_named) {
    const Sketch sketch = read(
        R"({"format": "vh-sketch/1", "window": [], "widnows": [], "nroth": 1, "expect": {}, "difficulty": 3, "notes": "",
        "table": {"diamter": 100, "center": [0, 0]},
        "walls": [{"a": [0, 0], "b": [5, 0], "height_class": "red", "thicknes": 1},
                  {"a": [0, 0], "b": [0, 5], "height_class": "red", "thickness": 1}],
        "north": {"pos": [0, 0], "dir_deg": 90}})");
    EXPECT_EQ(sketch.unknownFields,
              (std::vector<std::string>{"table.diamter (diameter?)", "walls[0].thicknes (thickness?)",
                                        "window (windows?)", "widnows (windows?)", "nroth (north?)"}));
}

TEST_F(SketchFile, missing_ids_are_given_and_do_not_collide) {
    const std::string bare = R"({"a": [0, 0], "b": [1, 0], "height_class": "red")";
    const Sketch sketch = read(withWall(bare + "}, " + bare + R"(, "id": "w1"}, )" + bare + "}"));
    EXPECT_EQ(sketch.walls[0].id, "w2");
    EXPECT_EQ(sketch.walls[1].id, "w1");
    EXPECT_EQ(sketch.walls[2].id, "w3");
}

TEST_F(SketchFile, cut_short_at_any_byte_is_refused_with_a_line) {
    std::ifstream in(HELIODON_TEST_DATA "/geometry/sketches/p01_rect_tight.json");
    const std::string whole((std::istreambuf_iterator<char>(in)), {});
    const size_t last = whole.rfind('}');
    for (size_t length = 13; length < last; length += 13)
        EXPECT_NE(refusal(whole.substr(0, length)).find("is not JSON here"), std::string::npos) << length;
}

TEST(Sketch, every_public_sketch_reads) {
    size_t count = 0;
    for (const auto& entry : fs::directory_iterator(HELIODON_TEST_DATA "/geometry/sketches")) {
        EXPECT_TRUE(readSketch(entry.path()).unknownFields.empty()) << entry.path();
        ++count;
    }
    EXPECT_GE(count, 18u);
}
