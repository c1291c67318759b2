// heliodon calibrate, as a user runs it.
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/picture_file.h"
#include "geometry/rig.h"
#include "tests/app/program.h"
#include "tests/vision/board_painter.h"

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

TEST_F(CalibrateCamera, bad_input_is_named_and_nothing_is_written) {
    paintAll();
    const std::string out = " -o " + in("rig.json");
    const std::vector<std::pair<std::string, std::string>> cases{
        {in("a1.png") + " " + in("c0.png") + out, "at least 3"},
        {in("*.png") + out + " --flat none.png", "none.png"},
        {in("*.png") + out + " --flat d_nothing.png", "d_nothing.png"},
        {in("a1.png") + " " + in("a1.png") + " " + in("a1.png") + out, "parallel"},
        {in("*.png") + out + " --rig " + in("c0.png"), "vh-rig/1"},
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

} // namespace
} // namespace heliodon::test
