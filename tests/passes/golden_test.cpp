// Few and small: whole pictures against kept ones, drawn by the software rasteriser. On failure the new
// picture and the difference are left in the test's scratch folder. To renew: HELIODON_RENEW_GOLDEN=1 and
// look at them.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "engine/passes/frame_renderer.h"
#include "engine/passes/image_file.h"
#include "tests/gpu/test_device.h"
#include "tests/passes/sketch_scene.h"

namespace heliodon::passes {
namespace {

const std::filesystem::path kData = HELIODON_TEST_DATA "/passes";

Image8 readPng(const std::filesystem::path& file) {
    const cv::Mat bgr = cv::imread(file.string(), cv::IMREAD_COLOR);
    Image8 picture{bgr.cols, bgr.rows, {}};
    for (int y = 0; y < bgr.rows; ++y)
        for (int x = 0; x < bgr.cols; ++x)
            for (int c = 2; c >= 0; --c) picture.rgb.push_back(bgr.at<cv::Vec3b>(y, x)[c]);
    return picture;
}

void expectLike(const std::string& name, const Image8& picture) {
    const std::filesystem::path kept = kData / (name + ".png");
    if (std::getenv("HELIODON_RENEW_GOLDEN")) writePng(picture, kept);
    const Image8 want = readPng(kept);
    ASSERT_EQ(picture.width, want.width) << kept;
    ASSERT_EQ(picture.height, want.height);
    const nlohmann::json tolerance = nlohmann::json::parse(std::ifstream(kData / "tolerance.json"));
    Image8 difference = want;
    size_t off = 0;
    for (size_t i = 0; i < want.rgb.size(); ++i) {
        const int d = std::abs(int(picture.rgb[i]) - int(want.rgb[i]));
        off += d > tolerance["levels"].get<int>();
        difference.rgb[i] = static_cast<uint8_t>(std::min(255, 8 * d));
    }
    const double share = double(off) / double(want.rgb.size());
    EXPECT_LE(share, tolerance["share_beyond"].get<double>()) << name;
    if (share <= tolerance["share_beyond"].get<double>()) return;
    const std::filesystem::path folder = testing::TempDir();
    writePng(picture, folder / (name + "-new.png"));
    writePng(difference, folder / (name + "-difference.png"));
    ADD_FAILURE() << "see " << folder / (name + "-new.png") << " and -difference.png";
}

compute::Lighting nightOf(compute::Lighting light) {
    light.sunDirection = glm::dvec3(0);
    light.sunNormalIlluminance = glm::vec3(0);
    std::fill(light.exitance.begin(), light.exitance.end(), glm::vec3(0));
    return light;
}

TEST(Golden, preview_of_a_sunlit_room) {
    const test::SketchScene scene = test::sketchScene(6);
    FrameRenderer renderer(test::device(), scene.mesh, scene.occluders, nullptr);
    PreviewOptions options;
    options.width = 256;
    options.height = 192;
    expectLike("preview", renderer.preview(scene.light, options));
    options.tone.map = ToneMap::falseColour;
    expectLike("false-colour", renderer.preview(scene.light, options));
}

TEST(Golden, picture_for_one_projector) {
    geometry::Rig rig = geometry::readRig(HELIODON_SOURCE "/examples/rig.json");
    rig.projectors.resize(2);
    for (geometry::Projector& projector :
         rig.projectors) { // a quarter of the panel's pixels in each direction
        projector.width /= 4;
        projector.height /= 4;
        geometry::Lens& lens = projector.lens;
        lens.fx /= 4, lens.fy /= 4, lens.cx = (lens.cx + 0.5) / 4 - 0.5, lens.cy = (lens.cy + 0.5) / 4 - 0.5;
    }
    const test::SketchScene scene = test::sketchScene(6);
    FrameRenderer renderer(test::device(), scene.mesh, scene.occluders, &rig);
    expectLike("projector", renderer.projectors(scene.light)[1]);
}

TEST(Golden, a_frame_without_sun_is_the_one_whose_sun_shines_on_nothing) {
    // Skipping the sun pass must change nothing: here it is drawn, from below the floor, and adds nothing.
    const test::SketchScene scene = test::sketchScene(6);
    FrameRenderer renderer(test::device(), scene.mesh, scene.occluders, nullptr);
    PreviewOptions options;
    options.width = 160;
    options.height = 120;
    compute::Lighting night = scene.light, below = scene.light;
    night.sunDirection = glm::dvec3(0);
    below.sunDirection = glm::normalize(glm::dvec3(0.1, -1, 0.2));
    EXPECT_EQ(renderer.preview(night, options).rgb, renderer.preview(below, options).rgb);
}

// Nor does what lies inside a wall shine through: the faces between the chords of a round one, say.
TEST(Golden, walls_of_glass_that_overlap_are_as_one) {
    const test::SketchScene scene = test::sketchScene(6);
    geometry::Occluders twice = scene.occluders;
    test::addSolid(twice, scene.occluders.vertices.front(), scene.occluders.vertices[7]);
    test::addSolid(twice, 0.7 * twice.vertices[0] + 0.3 * twice.vertices[7], twice.vertices[7]);
    PreviewOptions options;
    options.width = 256;
    options.height = 192;
    FrameRenderer one(test::device(), scene.mesh, scene.occluders, nullptr),
        overlapping(test::device(), scene.mesh, twice, nullptr);
    EXPECT_EQ(one.preview(scene.light, options).rgb, overlapping.preview(scene.light, options).rgb);
}

// Darkness is not the scale's lowest colour.
TEST(Golden, what_lies_below_the_scale_is_black) {
    const test::SketchScene scene = test::sketchScene(6);
    FrameRenderer renderer(test::device(), scene.mesh, scene.occluders, nullptr);
    PreviewOptions options;
    options.width = 160;
    options.height = 120;
    options.tone.map = ToneMap::falseColour;
    options.tone.legend = false;
    const Image8 picture = renderer.preview(nightOf(scene.light), options);
    int black = 0;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const uint8_t* p = picture.pixel(x, y);
            black += p[0] == 0 && p[1] == 0 && p[2] == 0;
            EXPECT_FALSE(p[0] == 68 && p[1] == 1 && p[2] == 84) << x << ' ' << y; // viridis at 0
        }
    EXPECT_GT(black, 1000);
}

// By night there is no pale sky to be seen, even where the picture has chosen its own white.
TEST(Golden, windows_are_dark_by_night) {
    const test::SketchScene scene = test::sketchScene(6);
    FrameRenderer renderer(test::device(), scene.mesh, scene.occluders, nullptr);
    PreviewOptions options;
    options.width = 160;
    options.height = 120;
    options.azimuthDegrees = 205; // a window faces the eye
    const auto pale = [&](const compute::Lighting& light) {
        const Image8 picture = renderer.preview(light, options);
        int count = 0;
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x)
                count += picture.pixel(x, y)[2] > picture.pixel(x, y)[0] + 15; // bluer than all else
        return count;
    };
    EXPECT_GT(pale(scene.light), 20);
    EXPECT_EQ(pale(nightOf(scene.light)), 0);
}

// Walls are drawn as on glass, over whatever lies behind them: also over nothing, beyond a small table's
// edge.
TEST(Golden, tops_of_walls_show_against_the_background) {
    const test::SketchScene scene = test::sketchScene(6);
    FrameRendererOptions small;
    small.tableRadius = 0.01;
    FrameRenderer renderer(test::device(), scene.mesh, scene.occluders, nullptr, small);
    PreviewOptions options;
    options.width = 256;
    options.height = 192;
    const Image8 drawn = renderer.preview(scene.light, options);
    options.tone.map = ToneMap::falseColour;
    options.tone.legend = false;
    const Image8 opaque = renderer.preview(scene.light, options);
    const uint8_t background[3] = {206, 209, 214}, top[3] = {228, 226, 224}; // sRGB
    int seen = 0, lost = 0, beyond = 0;
    for (int y = 0; y < drawn.height; ++y)
        for (int x = 0; x < drawn.width; ++x) {
            const auto is = [&](const Image8& picture, const uint8_t* colour) {
                return std::equal(colour, colour + 3, picture.pixel(x, y),
                                  [](int a, int b) { return std::abs(a - b) <= 1; });
            };
            beyond += is(opaque, background);
            if (!is(opaque, top)) continue;
            ++seen;
            lost += is(drawn, background);
        }
    EXPECT_GT(beyond, 1000);
    EXPECT_GT(seen, 100);
    EXPECT_EQ(lost, 0);
}

// The top of a partition is a surface of the room and drawn as such: a copy of it among the wall tops would
// show through along its edge, where the corners of both differ.
TEST(Golden, tops_that_the_room_has_itself_are_no_wall_tops) {
    test::SketchScene scene = test::sketchScene(6);
    const auto areaOf = [](const std::vector<DrawCorner>& corners) {
        double area = 0;
        for (size_t i = 0; i < corners.size(); i += 3)
            area += 0.5 * glm::length(glm::cross(corners[i + 1].position - corners[i].position,
                                                 corners[i + 2].position - corners[i].position));
        return area;
    };
    const double walls = areaOf(FrameScene(scene.mesh, scene.occluders, nullptr).tops);
    // One that reaches from the wall, in which its end is hidden, into the room; its top is two by seven.
    test::addSolid(scene.occluders, {-0.21, 0, 0}, {0.05, 0.1, 0.01});
    test::RoomBuilder b;
    b.mesh = std::move(scene.mesh);
    b.wall({-0.2032, 0.1, 0}, {0, 0, 0.01}, {0.2532, 0, 0}, 2, 7, [](int, int) { return test::kWhite; });
    const double hidden = (0.21 - 0.2032) * 0.01;
    EXPECT_NEAR(areaOf(FrameScene(b.mesh, scene.occluders, nullptr).tops), walls + hidden, 1e-7);
}

} // namespace
} // namespace heliodon::passes
