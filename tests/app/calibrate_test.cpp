// heliodon calibrate, as a user runs it.
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/picture_file.h"
#include "geometry/rig_edit.h"
#include "tests/app/program.h"
#include "tests/vision/board_painter.h"
#include "tests/vision/pattern_painter.h"

namespace heliodon::test {
namespace {

using nlohmann::json;

const geometry::Lens kLens{720, 722, 405, 296, 0, {-0.18, 0.09, 0.0006, -0.0004, 0}};
constexpr int kWidth = 800, kHeight = 600;

class CalibrateCamera : public InFolder {
protected:
    void paint(const std::string& name, const vision::Pose& pose) {
        const auto photo = vision::paintBoard(vision::makeTarget(), kLens, kWidth, kHeight, pose);
        geometry::writePngFile(in(name), photo.width, photo.height, photo.rgb.data());
    }
    // Named so that the flat one is neither first nor last.
    void paintAll() {
        paint("a1.png", vision::boardPose(25, 10, 20, {0.1, 0, 1.9}));
        paint("b_flat.png", vision::boardPose(2, 70, 3, {0.02, 0.01, 1.6}));
        for (int i = 0; i < 4; ++i)
            paint(fmt::format("c{}.png", i),
                  vision::boardPose(20 + 5 * i, 90 * i + 30, 50 * i,
                                    {0.2 - 0.1 * i, 0.05 * i - 0.1, 1.8 + 0.1 * i}));
        const std::vector<uint8_t> nothing(static_cast<size_t>(kWidth) * kHeight * 3, 90);
        geometry::writePngFile(in("d_nothing.png"), kWidth, kHeight, nothing.data());
    }
};

TEST_F(CalibrateCamera, puts_the_camera_into_the_rig_and_says_what_was_left_out) {
    paintAll();
    writeText(in("old.json"), R"({"format": "vh-rig/1", "site": {"latitude_deg": 10, "longitude_deg": 20},
        "projectors": [{"id": "left", "width": 640, "height": 480, "K": [[700, 0, 300], [0, 700, 50], [0, 0, 1]],
        "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "t": [0, 0, 2], "lumens": 1234, "colour": "grey"}]})");
    const Outcome run = heliodon("calibrate camera " + in("*.png") + " --rig " + in("old.json") + " -o " +
                                 in("rig.json") + " --overlay " + in("found") + " --report " + in("r.json"));
    ASSERT_EQ(run.exitCode, 0) << run.output;
    EXPECT_NE(run.output.find("d_nothing.png"), std::string::npos) << run.output;

    const geometry::Rig rig = geometry::readRig(in("rig.json"));
    EXPECT_NEAR(rig.camera.lens.fx, kLens.fx, 0.5); // six views of 800 x 600 pixels
    EXPECT_NEAR(rig.camera.lens.cy, kLens.cy, 0.5);
    ASSERT_EQ(rig.projectors.size(), 1u);
    EXPECT_EQ(rig.projectors[0].lumens, 1234);
    ASSERT_TRUE(rig.site);
    EXPECT_EQ(rig.site->latitudeDeg, 10);
    EXPECT_EQ(json::parse(readText(in("rig.json")))["projectors"][0]["colour"], "grey");
    // The world is the board of b_flat.png.
    const auto pixel = rig.camera.pixelFromWorld({0.3, 0, 0.2});
    ASSERT_TRUE(pixel);
    EXPECT_LT(glm::distance(*pixel,
                            vision::seen(kLens, vision::boardPose(2, 70, 3, {0.02, 0.01, 1.6}), {0.3, 0.2})),
              0.2);

    const json report = json::parse(readText(in("r.json")));
    EXPECT_EQ(report["flat"], "b_flat.png");
    EXPECT_EQ(report["views"].size(), 7u);
    EXPECT_EQ(report["views"][6]["used"], false);
    EXPECT_EQ(report["views"][1]["marks"], 212);
    EXPECT_LT(report["held_out_rms_px"].get<double>(), 0.1);
    EXPECT_TRUE(std::filesystem::exists(in("found/b_flat.png")));
}

TEST_F(CalibrateCamera, of_the_fewest_pictures_none_is_held_out) {
    paintAll();
    const Outcome run = heliodon("calibrate camera " + in("a1.png") + " " + in("b_flat.png") + " " +
                                 in("c0.png") + " -o " + in("rig.json") + " --report " + in("r.json"));
    ASSERT_EQ(run.exitCode, 0) << run.output;
    EXPECT_NE(run.output.find("too few to hold one out"), std::string::npos) << run.output;
    const json report = json::parse(readText(in("r.json")));
    EXPECT_TRUE(report["held_out_rms_px"].is_null());
    ASSERT_EQ(report["views"].size(), 3u);
    for (const json& view : report["views"]) EXPECT_TRUE(view["held_out_rms_px"].is_null());
}

TEST_F(CalibrateCamera, bad_input_is_named_and_nothing_is_written) {
    paintAll();
    const std::string out = " -o " + in("rig.json");
    const std::vector<std::pair<std::string, std::string>> cases{
        {in("a1.png") + " " + in("c0.png") + out, "at least 3"},
        {in("*.png") + out + " --flat none.png", "none.png"},
        {in("*.png") + out + " --flat d_nothing.png", "d_nothing.png"},
        {in("a1.png") + " " + in("a1.png") + " " + in("a1.png") + out, "where a1.png does"},
        {in("*.png") + out + " --rig " + in("c0.png"), "vh-rig/1"},
        {in("*.png") + out + " --overlay " + in("./"), "is read"}, // the photographs
        {in("none.png") + out, "none.png"}};
    for (const auto& [arguments, word] : cases) {
        const Outcome run = heliodon("calibrate camera --quiet " + arguments);
        EXPECT_EQ(run.exitCode, 2) << run.output;
        EXPECT_NE(run.output.find(word), std::string::npos) << run.output;
        EXPECT_FALSE(std::filesystem::exists(in("rig.json")));
    }
    const Outcome step = heliodon("calibrate lens");
    EXPECT_EQ(step.exitCode, 2);
    EXPECT_NE(step.output.find("camera"), std::string::npos) << step.output;
}

class CalibrateProjector : public InFolder {
protected:
    vision::PatternScene scene;

    void SetUp() override {
        InFolder::SetUp();
        scene.camera = vision::deviceLooking({0, 1.5, 0}, {0, 0, 0}, {0, 0, -1}, kLens, kWidth, kHeight);
        scene.patterns = {512, 384, 16};
        scene.projector = vision::deviceLooking({0.8, 1.1, -0.8}, {-0.2, 0, 0.2}, {0, 1, 0},
                                                {720, 722, 260, 10, 0, {}}, 512, 384);
        geometry::RigFile("").write(in("rig.json"), {{}, scene.camera, {}});
    }

    // The camera's pictures of the patterns on plane_0 to plane_2, 6 cm apart, in the folder `name`.
    void capture(const std::string& name) {
        for (int k = 0; k < 3; ++k) {
            scene.height = 0.06 * k;
            const vision::PatternPainter painter(scene);
            const std::string plane = in(fmt::format("{}/plane_{}", name, k));
            std::filesystem::create_directories(plane);
            for (const std::string& pattern : scene.patterns.names()) {
                const vision::GreyPicture picture = painter(pattern);
                std::vector<uint8_t> rgb;
                for (const float value : picture.values)
                    rgb.insert(rgb.end(), 3, static_cast<uint8_t>(std::lround(255 * value)));
                geometry::writePngFile(plane + "/" + pattern + ".png", kWidth, kHeight, rgb.data());
            }
        }
    }
};

TEST_F(CalibrateProjector, misspelt_fields_of_descriptions_are_named) {
    std::filesystem::create_directories(folder / "left/plane_0");
    writeText(folder / "left/patterns.json", R"({"widht": 512, "height": 384, "taken": "today"})");
    const std::string command =
        "calibrate projector " + in("left") + " --rig " + in("rig.json") + " -o " + in("new.json");
    const std::string said = heliodon(command).output;
    EXPECT_NE(said.find("left/patterns.json: widht (width?) is no part of"), std::string::npos) << said;
    EXPECT_EQ(said.find("taken"), std::string::npos) << said;
    writeText(folder / "left/projector.json", R"({"id": 5})");
    const Outcome named = heliodon(command);
    EXPECT_EQ(named.exitCode, 2);
    EXPECT_NE(named.output.find("left/projector.json:id: expected a text"), std::string::npos)
        << named.output;
}

TEST_F(CalibrateProjector, patterns_are_written_seen_and_understood) {
    ASSERT_EQ(heliodon("calibrate patterns --size 512x384 -o " + in("east")).exitCode, 0);
    const auto sent = geometry::pictureIn(geometry::bytesOf(in("east/x_bit4.png")));
    ASSERT_TRUE(sent);
    EXPECT_EQ(sent->rgb, vision::drawPattern(scene.patterns, "x_bit4").rgb);
    capture("east");
    const Outcome run =
        heliodon("calibrate projector " + in("east") + " --spacing 0.06 --rig " + in("rig.json") + " -o " +
                 in("rig.json") + " --overlay " + in("found") + " --report " + in("r.json"));
    ASSERT_EQ(run.exitCode, 0) << run.output;
    const geometry::Rig rig = geometry::readRig(in("rig.json"));
    ASSERT_EQ(rig.projectors.size(), 1u);
    EXPECT_EQ(rig.projectors[0].id, "east");
    EXPECT_EQ(rig.projectors[0].width, 512);
    EXPECT_EQ(rig.camera.lens.fx, kLens.fx);
    for (const double x : {-0.2, 0.2}) {
        const glm::dvec3 at(x, 0.1, -x);
        EXPECT_LT(glm::distance(rig.projectors[0].pixelFromWorld(at).value(),
                                scene.projector.pixelFromWorld(at).value()),
                  0.2);
    }
    const json report = json::parse(readText(in("r.json")))["projectors"][0];
    EXPECT_EQ(report["planes"].size(), 3u);
    EXPECT_LT(report["mean_mm"].get<double>(), 0.4);
    EXPECT_GT(report["planes"][0]["corners_used"].get<int>(), 50);
    EXPECT_TRUE(std::filesystem::exists(in("found/east-plane_1.png")));
    const Outcome drawnOver =
        heliodon("calibrate projector " + in("east") + " --rig " + in("rig.json") + " -o " + in("rig.json") +
                 " --overlay " + in("found") + " --report " + in("found/east-plane_1.png"));
    EXPECT_EQ(drawnOver.exitCode, 2) << drawnOver.output;
    EXPECT_NE(drawnOver.output.find("is the name of a result"), std::string::npos) << drawnOver.output;

    // Once more in its place: one projector, with what else was said of it.
    json edited = json::parse(readText(in("rig.json")));
    edited["projectors"][0]["lumens"] = 2500;
    writeText(in("rig.json"), edited.dump());
    std::filesystem::remove(in("east/plane_1/y_bit2_inv.png"));
    const std::string again = "calibrate projector " + in("east") + " --rig " + in("rig.json") + " -o ";
    const Outcome missing = heliodon(again + in("out.json"));
    EXPECT_EQ(missing.exitCode, 2);
    EXPECT_NE(missing.output.find("plane_1/y_bit2_inv.png"), std::string::npos) << missing.output;
    EXPECT_FALSE(std::filesystem::exists(in("out.json")));
    std::filesystem::remove_all(in("east/plane_1"));
    ASSERT_EQ(heliodon(again + in("out.json") + " --heights 0,0.12").exitCode, 0);
    const geometry::Rig once = geometry::readRig(in("out.json"));
    ASSERT_EQ(once.projectors.size(), 1u);
    EXPECT_EQ(once.projectors[0].lumens, 2500);
    // Under another name, and twice.
    const Outcome renamed = heliodon(again + in("x.json") + " --heights 0,0.12 --id west");
    EXPECT_NE(renamed.output.find("west comes out where the rig has east"), std::string::npos)
        << renamed.output;
    // What is wrong with the output is said before any picture is looked at.
    const Outcome nowhere = heliodon(again + in("none/x.json") + " --report " + in("r.json"));
    EXPECT_EQ(nowhere.exitCode, 2);
    EXPECT_NE(nowhere.output.find("none/x.json"), std::string::npos) << nowhere.output;
    EXPECT_FALSE(json::parse(readText(in("r.json"))).contains("projectors"));
    EXPECT_EQ(heliodon(again + in("x.json") + " --heights 0").exitCode, 2);
    EXPECT_EQ(heliodon(again + in("x.json") + " --id a,b").exitCode, 2);
    EXPECT_EQ(
        heliodon("calibrate projector " + in("found") + " --rig " + in("rig.json") + " -o " + in("x.json"))
            .exitCode,
        2);
}

} // namespace
} // namespace heliodon::test
