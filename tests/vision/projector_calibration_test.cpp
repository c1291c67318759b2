#include "vision/projector_calibration.h"

#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include "tests/vision/pattern_painter.h"

namespace heliodon::vision {
namespace {

// A camera straight above, and a projector at 45 degrees whose lens is shifted so far that its principal
// point lies above its picture.
PatternScene usualScene() {
    PatternScene scene;
    scene.camera = deviceLooking({0.02, 1.5, -0.03}, {0, 0, 0}, {0.03, 0, -1},
                                 {560, 561, 322, 236, 0, {-0.18, 0.09, 0.0006, -0.0004, 0}}, 640, 480);
    scene.patterns = {640, 480, 16};
    scene.projector =
        deviceLooking({-0.8, 1.1, -0.8}, {0.25, 0, 0.25}, {0, 1, 0}, {900, 898, 330, -40, 0, {}}, 640, 480);
    return scene;
}

std::vector<ProjectorPlane> decode(PatternScene scene, const std::vector<double>& heights) {
    std::vector<ProjectorPlane> planes;
    for (const double height : heights) {
        scene.height = height;
        const PatternPainter painter(scene);
        planes.push_back({height, decodePatterns(scene.patterns, std::cref(painter)).corners});
    }
    return planes;
}

ProjectorCalibration calibrate(const PatternScene& scene, const std::vector<ProjectorPlane>& planes) {
    return calibrateProjector(scene.camera, scene.projector.width, scene.projector.height, planes);
}

const std::vector<double> kHeights{0, 0.05, 0.1, 0.15};

// How far the true and the found projector put points of the volume apart, projector pixels.
double worstMiss(const geometry::OpticalDevice& found, const geometry::OpticalDevice& truth) {
    double worst = 0;
    for (const double x : {-0.3, 0.0, 0.3})
        for (const double y : {0.0, 0.1, 0.2})
            for (const double z : {-0.3, 0.0, 0.3})
                worst = std::max(worst, glm::distance(found.pixelFromWorld({x, y, z}).value(),
                                                      truth.pixelFromWorld({x, y, z}).value()));
    return worst;
}

TEST(GrayCode, neighbouring_cells_differ_in_one_bit_and_names_are_complete) {
    const PatternSet set{1024, 768, 16};
    EXPECT_EQ(set.names().size(), 28u); // 2 + 2 (6 + 6) + 2
    std::vector<Photograph> bits;
    for (const std::string& name : set.names())
        if (name.find("bit") != std::string::npos && !name.ends_with("_inv"))
            bits.push_back(drawPattern(set, name));
    ASSERT_EQ(bits.size(), 12u);
    const auto at = [](const Photograph& p, int x, int y) {
        return p.rgb[3 * static_cast<size_t>(y * p.width + x)];
    };
    for (int x = 16; x < 1024; x += 16) {
        int differ = 0;
        for (const Photograph& bit : bits) differ += at(bit, x, 100) != at(bit, x - 1, 100);
        EXPECT_EQ(differ, 1) << x;
    }
    const Photograph checkers = drawPattern(set, "xor_lsb"), inverse = drawPattern(set, "xor_lsb_inv");
    for (int y = 0; y < 768; y += 5)
        for (int x = 0; x < 1024; x += 7) {
            const int column = x / 16, row = y / 16;
            EXPECT_EQ(at(checkers, x, y) != 0, (((column + 1) / 2 + (row + 1) / 2) % 2) != 0);
            EXPECT_NE(at(checkers, x, y), at(inverse, x, y));
        }
}

// Ambient and black level add to white and black alike.
TEST(GrayCode, contrast_is_white_less_black_where_the_projector_shines) {
    PatternScene scene = usualScene();
    scene.height = 0.1;
    scene.gamma = 1;
    const auto contrast = [&] {
        const PatternPainter painter(scene);
        const GreyPicture white = painter("white"), black = painter("black");
        float most = 0;
        for (size_t i = 0; i < white.values.size(); ++i)
            most = std::max(most, white.values[i] - black.values[i]);
        const double seen = decodePatterns(scene.patterns, std::cref(painter)).contrast;
        EXPECT_GT(seen, 0.3f * most);
        EXPECT_LE(seen, most);
        return seen;
    };
    const double usual = contrast();
    scene.exposure /= 4;
    EXPECT_NEAR(contrast(), usual / 4, 0.1 * usual / 4);
}

TEST(GrayCode, every_corner_found_is_where_the_projector_put_it) {
    PatternScene scene = usualScene();
    scene.height = 0.1;
    for (const double noise : {0.0, 0.01}) {
        scene.noise = noise;
        scene.gamma = noise > 0 ? 2.2 : 1;
        const PatternPainter painter(scene);
        const DecodedPatterns decoded = decodePatterns(scene.patterns, std::cref(painter));
        EXPECT_GT(decoded.corners.size(), 100u);
        EXPECT_GT(decoded.decodedShare, 0.7);
        double squares = 0;
        size_t inside = 0;
        for (const PatternCorner& corner : decoded.corners) {
            const auto at = scene.projector.worldOnPlane(corner.projector, scene.height);
            ASSERT_TRUE(at);
            // A square from the board's edge: there half a corner may be missing.
            if (std::max(std::abs(at->x), std::abs(at->z)) > 0.45) continue;
            const double off = glm::distance(scene.camera.pixelFromWorld(*at).value(), corner.camera);
            squares += off * off, ++inside;
            EXPECT_LT(off, 0.3);
        }
        // 2 x 2 cells are 20 to 40 camera pixels; the samples of the painter lie a third of a pixel apart.
        EXPECT_LT(std::sqrt(squares / static_cast<double>(inside)), 0.05) << noise;
    }
}

TEST(GrayCode, codes_finer_than_the_camera_resolves_are_read_by_coarser_cells) {
    PatternScene scene = usualScene();
    scene.height = 0.1, scene.noise = 0.008, scene.gamma = 2.2;
    for (const int cell : {1, 2}) {
        scene.patterns.cell = cell;
        const PatternPainter painter(scene);
        const DecodedPatterns decoded = decodePatterns(scene.patterns, std::cref(painter));
        EXPECT_GT(decoded.cell, cell);
        EXPECT_EQ(decoded.cell & (decoded.cell - 1), 0);
        EXPECT_GT(decoded.corners.size(), 500u) << cell;
        std::vector<double> off;
        for (const PatternCorner& corner : decoded.corners) {
            const auto at = scene.projector.worldOnPlane(corner.projector, scene.height);
            ASSERT_TRUE(at);
            if (std::max(std::abs(at->x), std::abs(at->z)) > 0.45) continue;
            off.push_back(glm::distance(scene.camera.pixelFromWorld(*at).value(), corner.camera));
        }
        std::ranges::sort(off);
        EXPECT_LT(off[off.size() / 2], 0.05) << cell; // as of cells that are shown so large
        EXPECT_LT(off[off.size() * 99 / 100], 0.3) << cell;
    }
    scene.patterns.cell = 1;
    const auto result = calibrate(scene, decode(scene, {0, 0.12}));
    EXPECT_LT(worstMiss(result.projector, scene.projector), 0.5);
}

TEST(GrayCode, pictures_of_other_patterns_are_in_doubt) {
    PatternScene scene = usualScene();
    scene.height = 0.1, scene.noise = 0.005;
    const PatternPainter painter(scene);
    EXPECT_TRUE(decodePatterns(scene.patterns, std::cref(painter)).doubts.empty());
    const auto doubtsWith = [&](const std::string& one, const std::string& other) {
        const auto decoded = decodePatterns(scene.patterns, [&](const std::string& name) {
            return painter(name == one ? other : name == other ? one : name);
        });
        std::string all;
        for (const std::string& doubt : decoded.doubts) all += doubt + "\n";
        return all;
    };
    EXPECT_NE(doubtsWith("x_bit3", "x_bit2").find("x_bit3 and its inverse"), std::string::npos)
        << doubtsWith("x_bit3", "x_bit2");
    const auto exchanged = decodePatterns(scene.patterns, [&](const std::string& name) {
        std::string shown = name;
        if (name.starts_with("y_bit2") || name.starts_with("y_bit1")) shown[5] = name[5] == '2' ? '1' : '2';
        return painter(shown);
    });
    ASSERT_FALSE(exchanged.doubts.empty());
    EXPECT_NE(exchanged.doubts.front().find("y_bit2 has more stripes than y_bit1"), std::string::npos)
        << exchanged.doubts.front();
}

TEST(CalibrateProjector, finds_a_principal_point_above_the_picture_and_no_distortion_where_there_is_none) {
    const PatternScene scene = usualScene();
    const auto result = calibrate(scene, decode(scene, kHeights));
    EXPECT_LT(worstMiss(result.projector, scene.projector), 0.1);
    EXPECT_LT(result.rms, 0.06);
    EXPECT_LT(result.heldOutRms.value(), 0.08);
    EXPECT_LT(result.meanMm + result.deviationMm, 0.4); // the paper's mean; here there is no noise
    EXPECT_NEAR(result.projector.lens.cy, -40, std::max(1.0, 4 * result.sigma.cy));
    EXPECT_NEAR(result.projector.lens.fx, 900, std::max(0.5, 4 * result.sigma.fx));
    EXPECT_LT(glm::distance(result.projector.centre(), scene.projector.centre()), 0.002);
    EXPECT_LT(std::abs(result.projector.lens.dist[0]), 0.005);
}

TEST(CalibrateProjector, noise_gamma_distortion_and_light_beside_the_board_do_not_mislead_it) {
    PatternScene scene = usualScene();
    scene.projector.lens.dist = {-0.05, 0.02, 0, 0, 0};
    scene.noise = 0.008, scene.gamma = 2.2, scene.ambient = 0.05;
    scene.boardHalf = 0.42, scene.tableWhite = 0.8; // corners on the table, at heights that are not theirs
    const auto planes = decode(scene, kHeights);
    const auto result = calibrate(scene, planes);
    EXPECT_LT(worstMiss(result.projector, scene.projector), 0.25);
    EXPECT_NEAR(result.projector.lens.dist[0], -0.05, 0.01);
    EXPECT_LT(result.meanMm, 0.4);
    size_t rejected = 0;
    for (const CalibratedPlane& plane : result.planes) rejected += plane.rejected.size();
    EXPECT_GT(rejected, 20u); // those on the table
}

TEST(CalibrateProjector, a_wrong_height_is_noticed_and_too_little_refused) {
    const PatternScene scene = usualScene();
    auto planes = decode(scene, {0, 0.06, 0.12});
    auto wrong = planes;
    wrong[1].height = 0.07;
    const auto off = calibrate(scene, wrong), right = calibrate(scene, planes);
    EXPECT_GT(off.heldOutRms.value(), 5 * right.heldOutRms.value());
    EXPECT_FALSE(calibrate(scene, {planes[0], planes[2]}).heldOutRms); // one plane is too few for the others
    bool named = false;
    for (const std::string& warning : off.warnings) named = named || warning.find("off") != std::string::npos;
    EXPECT_TRUE(named);
    auto swapped = decode(scene, kHeights), fromAbove = swapped;
    std::swap(swapped[1].corners, swapped[swapped.size() - 1].corners);
    EXPECT_THROW(calibrate(scene, swapped), CalibrationError);
    auto reversed = planes;
    std::swap(reversed.front().height, reversed.back().height);
    EXPECT_THROW(calibrate(scene, reversed), CalibrationError);
    for (size_t i = 0; 2 * i + 1 < fromAbove.size(); ++i)
        std::swap(fromAbove[i].height, fromAbove[fromAbove.size() - 1 - i].height);
    try {
        calibrate(scene, fromAbove);
        ADD_FAILURE() << "planes in reverse were taken";
    } catch (const CalibrationError& error) {
        EXPECT_NE(std::string(error.what()).find("in reverse"), std::string::npos) << error.what();
    }
    EXPECT_THROW(calibrate(scene, {planes[0]}), CalibrationError);
    std::vector<ProjectorPlane> mirrored = planes;
    for (ProjectorPlane& plane : mirrored)
        for (auto& corner : plane.corners)
            corner.projector.x = scene.projector.width - 1 - corner.projector.x;
    try {
        calibrate(scene, mirrored);
        ADD_FAILURE() << "a mirrored picture was taken";
    } catch (const CalibrationError& error) {
        EXPECT_NE(std::string(error.what()).find("mirrored"), std::string::npos) << error.what();
    }
    const auto turned = [&](size_t first, size_t last) {
        std::vector<ProjectorPlane> out = planes;
        for (size_t i = first; i <= last; ++i)
            for (auto& corner : out[i].corners)
                corner.camera = glm::dvec2(scene.camera.width - 1, scene.camera.height - 1) - corner.camera;
        try {
            calibrate(scene, out);
        } catch (const CalibrationError& error) {
            return std::string(error.what());
        }
        return std::string("taken");
    };
    EXPECT_NE(turned(0, 2).find("pictures are turned by half"), std::string::npos) << turned(0, 2);
    EXPECT_NE(turned(1, 1).find("plane at 0.0600 m are turned by half"), std::string::npos) << turned(1, 1);
    EXPECT_THROW(calibrate(scene, {planes[0], planes[0]}), CalibrationError);
    EXPECT_THROW(calibrate(scene, {{0, {}}, {0.1, {}}}), CalibrationError);
}

std::string warningsOf(const PatternScene& scene, const std::vector<ProjectorPlane>& planes) {
    std::string all;
    for (const std::string& warning : calibrate(scene, planes).warnings) all += warning + "\n";
    return all;
}

// What a fit takes up in part.
TEST(CalibrateProjector, planes_too_high_by_one_factor_and_a_camera_that_moved_are_said) {
    const PatternScene scene = usualScene();
    const auto planes = decode(scene, {0, 0.06, 0.12});
    EXPECT_EQ(warningsOf(scene, planes), "only 3 planes; nine make the lens sure\n");
    auto high = planes, moved = planes;
    for (ProjectorPlane& plane : high) plane.height *= 1.08;
    EXPECT_NE(warningsOf(scene, high).find("not square"), std::string::npos) << warningsOf(scene, high);
    EXPECT_NE(warningsOf(scene, high).find("on planes held out"), std::string::npos);
    for (PatternCorner& corner : moved[2].corners) corner.camera += glm::dvec2(1.5, -1);
    EXPECT_NE(warningsOf(scene, moved).find("on planes held out"), std::string::npos)
        << warningsOf(scene, moved);
}

// Of a small board on a bright table the table carries the most corners, whatever the board's height: they
// fit a projector in the camera's place, without a residual.
TEST(CalibrateProjector, corners_on_the_table_beside_the_board_are_refused) {
    PatternScene scene = usualScene();
    scene.boardHalf = 0.12, scene.tableWhite = 0.7;
    try {
        calibrate(scene, decode(scene, kHeights));
        FAIL() << "calibrated by the table";
    } catch (const CalibrationError& error) {
        EXPECT_NE(std::string(error.what()).find("beside the board"), std::string::npos) << error.what();
    }
}

} // namespace
} // namespace heliodon::vision
