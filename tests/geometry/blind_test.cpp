#include "geometry/blind.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "geometry/building.h"
#include "geometry/input_error.h"
#include "geometry/mesher.h"
#include "geometry/model_file.h"
#include "geometry/sketch.h"

namespace heliodon::geometry {
namespace {

std::filesystem::path temporary(const std::string& name) {
    return std::filesystem::path(testing::TempDir()) / ("blind_test_" + name);
}

// A room of 8 x 6 ft with two windows in one wall.
std::string sketchText(const std::string& first, const std::string& second) {
    return R"({"format":"vh-sketch/1","walls":[
        {"id":"s","a":[-4,-3],"b":[4,-3],"height_class":"red"},{"id":"e","a":[4,-3],"b":[4,3],"height_class":"red"},
        {"id":"n","a":[4,3],"b":[-4,3],"height_class":"red"},{"id":"w","a":[-4,3],"b":[-4,-3],"height_class":"red"}],
        "windows":[{"id":"one","wall":"s","pos":2,"width":2,"kind":"standard")" +
           first + R"(},{"id":"two","wall":"s","pos":6,"width":2,"kind":"standard")" + second + "}]}";
}

Sketch sketchOf(const std::string& first, const std::string& second = "") {
    const auto file = temporary("sketch.json");
    std::ofstream(file) << sketchText(first, second);
    return readSketch(file);
}

Sketch written(const Sketch& sketch) { // and read again
    const auto file = temporary("copy.json");
    writeSketch(sketch, file);
    return readSketch(file);
}

size_t shaded(const Building& building) {
    return static_cast<size_t>(std::ranges::count_if(building.faces, [&](const Face& face) {
        return building.materials[face.material].blind == parseBlind("slats:45");
    }));
}

TEST(Blind, text_and_blind_are_the_same_thing) {
    for (const char* text : {"open", "fabric:0.2,0.5", "slats:45,0.7,0.8", "slats:-30,0.25,1.5"}) {
        EXPECT_EQ(blindText(parseBlind(text)), text);
        EXPECT_EQ(parseBlind(blindText(parseBlind(text))), parseBlind(text));
    }
    EXPECT_EQ(parseBlind("slats:45"), parseBlind("slats:45,0.7,0.8"));
    for (const char* text : {"", "slat:4", "slats", "slats:", "slats:86", "slats:1,2", "fabric:0.5,0.6",
                             "fabric:x", "slats:1,0.5,1,1", "open:1"})
        EXPECT_THROW(parseBlind(text), std::invalid_argument) << text;
}

TEST(Blind, a_sketch_gives_each_window_its_own) {
    const Sketch sketch = sketchOf(R"(,"blinds":"slats:45")");
    EXPECT_EQ(sketch.windows[0].blind, parseBlind("slats:45"));
    EXPECT_EQ(sketch.windows[1].blind, Blind{});
    EXPECT_EQ(written(sketch).windows[0].blind, sketch.windows[0].blind);
    const Closure closure = closeSketch(sketch);
    ASSERT_TRUE(closure.building);
    EXPECT_EQ(closure.report.windowCount, 2);
    EXPECT_EQ(shaded(*closure.building), 1u);
    const std::string both = R"(,"blinds":"slats:45")";
    EXPECT_EQ(shaded(*closeSketch(sketchOf(both, both)).building), 2u);
    try {
        sketchOf("", R"(,"blinds":"slats:100")");
        FAIL() << "not refused";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("windows[1].blinds"), std::string::npos) << error.what();
    }
}

TEST(Blind, a_sketch_gives_each_skylight_its_own) {
    const auto with = [](const std::string& blinds) {
        std::string text = sketchText("", "");
        text.back() = ',';
        text += R"("skylights":[{"id":"a","center":[-2,0],"size":[2,2])" + blinds +
                R"(},{"id":"b","center":[2,0],"size":[2,2]}]})";
        const auto file = temporary("skylights.json");
        std::ofstream(file) << text;
        return readSketch(file);
    };
    const Sketch sketch = with(R"(,"blinds":"slats:45")");
    EXPECT_EQ(sketch.skylights[0].blind, parseBlind("slats:45"));
    EXPECT_EQ(sketch.skylights[1].blind, Blind{});
    EXPECT_EQ(written(sketch).skylights[0].blind, sketch.skylights[0].blind);
    const Closure closure = closeSketch(sketch);
    ASSERT_TRUE(closure.building);
    EXPECT_EQ(closure.report.skylightPaneCount, 2);
    EXPECT_EQ(shaded(*closure.building), 1u);
    EXPECT_EQ(shaded(*closeSketch(with("")).building), 0u);
    EXPECT_THROW(with(R"(,"blinds":"slats:100")"), InputError);
}

TEST(Blind, models_keep_it) {
    const Closure closure = closeSketch(sketchOf(R"(,"blinds":"slats:45")"));
    PatchMesh mesh = meshBuilding(*closure.building, {100});
    for (const char* name : {"room.obj", "room.glb"}) {
        writeModel(mesh, temporary(name));
        EXPECT_GT(shaded(importModel(temporary(name), UpAxis::y)), 0u) << name;
    }
    mesh.materials[0].blind = parseBlind("fabric:0.3"); // of a wall
    for (const char* name : {"wall.obj", "wall.glb"}) {
        writeModel(mesh, temporary(name));
        EXPECT_THROW(importModel(temporary(name), UpAxis::y), InputError) << name;
    }
}

} // namespace
} // namespace heliodon::geometry
