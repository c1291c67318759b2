// What the projectors' pictures do on the physical walls: places (checklist 31, 32) and amounts of light.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/passes/frame_renderer.h"
#include "engine/passes/projector_light.h"
#include "engine/passes/projector_share.h"
#include "tests/gpu/test_device.h"
#include "tests/passes/exitance_from.h"
#include "tests/passes/sketch_scene.h"

namespace heliodon::passes {
namespace {

geometry::Rig exampleRig() {
    return geometry::readRig(HELIODON_SOURCE "/examples/rig.json");
}

// Bright squares of 8 mm on the table and above it.
struct Markers {
    geometry::PatchMesh mesh;
    compute::Lighting light;
    std::vector<glm::dvec3> centres;
};

Markers markers() {
    Markers m;
    m.mesh.materials = {{"white", glm::vec3(0.5f)}};
    const double half = 0.004;
    for (int i = -4; i <= 4; ++i)
        for (int j = -4; j <= 4; ++j) {
            const glm::dvec3 c(0.09 * i, 0.05 * ((i + j + 8) % 3), 0.09 * j);
            const auto first = static_cast<uint32_t>(m.mesh.vertices.size());
            for (const glm::dvec3& d :
                 {glm::dvec3(-half, 0, half), {half, 0, half}, {half, 0, -half}, {-half, 0, -half}})
                m.mesh.vertices.push_back(c + d);
            m.mesh.addPatch(std::array{first, first + 1, first + 2, first + 3}, 0, geometry::Role::projection,
                            static_cast<uint32_t>(m.centres.size()), 0);
            m.centres.push_back(c);
            m.light.exitance.emplace_back(1000.0f);
        }
    return m;
}

void expectMarkersInPlace(const geometry::Rig& rig, int supersample) {
    const Markers m = markers();
    FrameRenderer renderer(test::device(), m.mesh, {}, &rig);
    ProjectorOptions options;
    options.supersample = supersample;
    const std::vector<ImageF> pictures = renderer.projectorsHdr(m.light, options);
    int found = 0;
    double worst = 0;
    for (size_t p = 0; p < rig.projectors.size(); ++p)
        for (const glm::dvec3& c : m.centres) {
            const auto want = rig.projectors[p].pixelFromWorld(c);
            constexpr int kReach = 9;
            if (!want || want->x < 40 || want->y < 40 || want->x > rig.projectors[p].width - 40 ||
                want->y > rig.projectors[p].height - 40)
                continue;
            // Pictures of other markers must not come into the window.
            const bool alone = std::none_of(m.centres.begin(), m.centres.end(), [&](const glm::dvec3& other) {
                const auto at = rig.projectors[p].pixelFromWorld(other);
                return other != c && at && glm::length(*at - *want) < 26;
            });
            if (!alone) continue;
            double sum = 0;
            glm::dvec2 moment(0);
            for (int y = int(want->y) - kReach; y <= int(want->y) + kReach; ++y)
                for (int x = int(want->x) - kReach; x <= int(want->x) + kReach; ++x) {
                    const double value = pictures[p].pixel(x, y)[1];
                    sum += value;
                    moment += value * glm::dvec2(x, y);
                }
            ASSERT_GT(sum, 0) << "marker " << c.x << " " << c.z << " of projector " << p;
            worst = std::max(worst, glm::length(moment / sum - *want));
            ++found;
        }
    EXPECT_GT(found, 150);
    // Half a pixel is what is asked for. A square drawn without anti-aliasing, interpolated once, keeps its
    // centroid to about a tenth on each side.
    EXPECT_LT(worst, 0.5);
    testing::Test::RecordProperty("worst_px", std::to_string(worst));
}

TEST(Projector, markers_lie_where_the_rig_says_within_half_a_pixel) {
    expectMarkersInPlace(exampleRig(), 1);
    expectMarkersInPlace(exampleRig(), 2);
}

TEST(Projector, markers_lie_right_through_a_strong_and_skewed_lens) {
    geometry::Rig rig = exampleRig();
    for (geometry::Projector& projector : rig.projectors) {
        projector.lens.dist = {-0.12, 0.05, 0.004, -0.003, 0.01};
        projector.lens.skew = 12;
    }
    expectMarkersInPlace(rig, 1);
}

// The sum over projectors.
glm::dvec3 physicalExitance(const geometry::Rig& rig, const std::vector<ImageF>& pictures, glm::dvec3 point,
                            glm::dvec3 normal, double reflectance) {
    glm::dvec3 sum(0);
    for (size_t p = 0; p < rig.projectors.size(); ++p)
        sum += test::exitanceFrom(rig.projectors[p], pictures[p], point, normal, reflectance);
    return sum;
}

// The drive that a picture's bytes stand for.
ImageF driveOf(const geometry::Projector& projector, const Image8& picture) {
    ImageF drive{picture.width, picture.height, {}};
    for (const uint8_t byte : picture.rgb) {
        const double v = byte / 255.0, linear = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
        drive.rgb.push_back(static_cast<float>(projector.blackLevel + (1 - projector.blackLevel) * linear));
    }
    return drive;
}

TEST(Projector, overlapping_projectors_together_show_the_simulated_light) {
    const geometry::Rig rig = exampleRig();
    const test::SketchScene scene = test::sketchScene(8);
    compute::Lighting light = scene.light;
    light.sunDirection = glm::dvec3(0);
    for (glm::vec3& exitance : light.exitance)
        exitance = {400, 300, 200}; // even: what is shown is known everywhere
    FrameRenderer renderer(test::device(), scene.mesh, scene.occluders, &rig);
    const std::vector<ImageF> pictures = renderer.projectorsHdr(light);
    const double exposure = renderer.reachLux() / renderer.autoWhite(light);
    // Two to four times too bright: white.
    ProjectorOptions bright;
    bright.tone.whiteLux = 100;
    std::vector<ImageF> cut;
    for (const Image8& picture : renderer.projectors(light, bright))
        cut.push_back(driveOf(rig.projectors[cut.size()], picture));
    // On the floor and the walls, away from the outlines of shadows by nothing but chance: most points must
    // be right, and those in a band to one pixel along a shadow's edge may be off.
    size_t right = 0, dark = 0, white = 0, all = 0;
    for (size_t p = 0; p < scene.mesh.patchCount(); ++p) {
        if (scene.mesh.role[p] != geometry::Role::projection) continue;
        const glm::dvec3 shown =
            physicalExitance(rig, pictures, geometry::patchCentroid(scene.mesh, p),
                             geometry::patchNormal(scene.mesh, p), rig.surfaceReflectance);
        const glm::dvec3 want = exposure * glm::dvec3(400, 300, 200);
        ++all;
        // 2 %: the slope of the gain over half a pixel.
        right += glm::length(shown - want) < 0.02 * glm::length(want);
        dark += glm::length(shown) < 0.02 * glm::length(want);
        const glm::dvec3 most = renderer.reachLux() * glm::dvec3(1),
                         reached =
                             physicalExitance(rig, cut, geometry::patchCentroid(scene.mesh, p),
                                              geometry::patchNormal(scene.mesh, p), rig.surfaceReflectance);
        white += glm::length(reached - most) < 0.04 * glm::length(most); // 2 %, and steps of the bytes
    }
    EXPECT_GE(double(right), 0.93 * double(all - dark));
    EXPECT_LE(double(dark), 0.1 * double(all));          // seen by no projector
    EXPECT_GE(double(white), 0.83 * double(all - dark)); // nine tenths can be as bright
}

// Sunlit paint: the same luminance and hue as far as white has them, paler where a channel has no more.
TEST(Projector, brighter_than_white_stays_as_bright_and_of_its_hue) {
    const glm::dvec3 lux(300, 500, 2400), luminance(0.2126, 0.7152, 0.0722);
    const double white = 1000, bright = glm::dot(luminance, lux) / white;
    ASSERT_LT(bright, 1);
    const Markers m = markers();
    compute::Lighting light = m.light;
    light.exitance.assign(light.exitance.size(), glm::vec3(lux));
    geometry::Rig rig = exampleRig();
    rig.projectors.resize(1);
    FrameRenderer renderer(test::device(), m.mesh, {}, &rig);
    ProjectorOptions options;
    options.tone.whiteLux = white;
    const ImageF drive = driveOf(rig.projectors[0], renderer.projectors(light, options)[0]);
    options.tone.whiteLux = 10 * white; // all within white
    const ImageF plain = driveOf(rig.projectors[0], renderer.projectors(light, options)[0]);
    const glm::dvec2 at = *rig.projectors[0].pixelFromWorld(m.centres[40]);
    const size_t pixel = 3 * (size_t(std::lround(at.y)) * size_t(drive.width) + size_t(std::lround(at.x)));
    const auto colour = [&](const ImageF& picture) {
        return glm::dvec3(picture.rgb[pixel], picture.rgb[pixel + 1], picture.rgb[pixel + 2]);
    };
    const glm::dvec3 shown = colour(drive), full = 10.0 * colour(plain);
    EXPECT_NEAR(glm::dot(luminance, shown), glm::dot(luminance, full), 0.03 * glm::dot(luminance, full));
    EXPECT_NEAR(shown.b, full.b * white / lux.b, 0.03 * shown.b); // white has no more blue
    const double grey = glm::dot(luminance, shown), less = (shown.b - grey) / (full.b - grey);
    EXPECT_NEAR(shown.r - grey, less * (full.r - grey), 0.03 * shown.b);
    EXPECT_NEAR(shown.g - grey, less * (full.g - grey), 0.03 * shown.b);
}

// Far from the projector its red ends before its luminance does.
TEST(Projector, where_a_channel_ends_the_others_make_up_for_its_luminance) {
    const Markers m = markers();
    compute::Lighting light = m.light;
    light.exitance.assign(light.exitance.size(), glm::vec3(990, 50, 50));
    geometry::Rig rig = exampleRig();
    rig.projectors.resize(1);
    FrameRenderer renderer(test::device(), m.mesh, {}, &rig);
    ProjectorOptions options;
    options.tone.whiteLux = 1000;
    const ImageF drive = driveOf(rig.projectors[0], renderer.projectors(light, options)[0]);
    options.tone.whiteLux = 4000; // all within reach
    const ImageF plain = driveOf(rig.projectors[0], renderer.projectors(light, options)[0]);
    const glm::dvec3 luminance(0.2126, 0.7152, 0.0722);
    size_t beyond = 0;
    for (const glm::dvec3& c : m.centres) {
        const auto at = rig.projectors[0].pixelFromWorld(c);
        if (!at || at->x < 1 || at->y < 1 || at->x > drive.width - 2 || at->y > drive.height - 2) continue;
        const int x = int(std::lround(at->x)), y = int(std::lround(at->y));
        const auto of = [&](const ImageF& picture) {
            const float* value = picture.pixel(x, y);
            return glm::dvec3(value[0], value[1], value[2]);
        };
        const glm::dvec3 full = 4.0 * of(plain);
        if (full.r < 1.05) continue;
        ++beyond;
        const double wanted = glm::dot(luminance, full);
        EXPECT_NEAR(glm::dot(luminance, of(drive)), wanted, 0.02 * wanted) << c.x << " " << c.z; // bytes
    }
    EXPECT_GT(beyond, 2u);
}

// What the device draws is what geometry/projector_blend.h says.
TEST(Projector, each_shows_its_share) {
    const geometry::Rig rig = exampleRig();
    const test::SketchScene scene = test::sketchScene(8);
    compute::Lighting light = scene.light;
    light.sunDirection = glm::dvec3(0);
    light.exitance.assign(scene.mesh.patchCount(), glm::vec3(300)); // even
    FrameRenderer renderer(test::device(), scene.mesh, scene.occluders, &rig);
    const std::vector<ImageF> pictures = renderer.projectorsHdr(light);
    const double shown = 300 * renderer.reachLux() / renderer.autoWhite(light);
    const ShownMesh mesh = shownMesh(scene.mesh, VertexLight(scene.mesh), scene.occluders, rig);
    std::vector<glm::dvec3> centres;
    for (const geometry::Projector& projector : rig.projectors) centres.push_back(projector.centre());
    size_t all = 0, right = 0, shared = 0;
    for (size_t t = 0; t < mesh.blend.visible.size(); ++t) {
        const DrawCorner* corner = &mesh.mesh.corners[3 * t];
        const glm::dvec3 middle((corner[0].position + corner[1].position + corner[2].position) / 3.0f),
            normal(corner[0].normal);
        const std::vector<double> shares = geometry::blendShares(mesh.blend, t, middle, normal, centres);
        for (size_t p = 0; p < shares.size(); ++p) {
            const double found = test::exitanceFrom(rig.projectors[p], pictures[p], middle, normal,
                                                    rig.surfaceReflectance)[1] /
                                 shown;
            ++all;
            shared += shares[p] > 0.1 && shares[p] < 0.9;
            right +=
                std::abs(found - shares[p]) < 0.03; // a share runs by 1.5 in 5 cm, a pixel is 1.3 mm wide
        }
    }
    EXPECT_GT(shared, all / 20);
    EXPECT_GT(double(right), 0.97 * double(all)); // others lie within a pixel of the outline of a wall
}

// As if the rig had only the others.
TEST(Projector, the_others_take_over_what_one_that_is_left_out_showed) {
    const geometry::Rig rig = exampleRig();
    geometry::Rig others = rig;
    others.projectors.erase(others.projectors.begin() + 1);
    const test::SketchScene scene = test::sketchScene(8);
    compute::Lighting light = scene.light;
    light.sunDirection = glm::dvec3(0);
    FrameRenderer renderer(test::device(), scene.mesh, scene.occluders, &rig),
        expected(test::device(), scene.mesh, scene.occluders, &others);
    std::vector<bool> dark(rig.projectors.size(), false);
    dark[1] = true;
    renderer.leaveOut(dark);
    EXPECT_NEAR(renderer.reachLux(), expected.reachLux(), 0.01 * expected.reachLux());
    const double scale = expected.reachLux() / renderer.reachLux();
    std::vector<ImageF> found = renderer.projectorsHdr(light);
    const std::vector<ImageF> wanted = expected.projectorsHdr(light);
    for (const float drive : found[1].rgb) EXPECT_EQ(drive, 0);
    found.erase(found.begin() + 1);
    for (size_t i = 0; i < wanted.size(); ++i) {
        double sum = 0, difference = 0;
        for (size_t k = 0; k < wanted[i].rgb.size(); ++k) {
            sum += double{wanted[i].rgb[k]};
            difference += std::abs(scale * double{found[i].rgb[k]} - double{wanted[i].rgb[k]});
        }
        EXPECT_GT(sum, 0);
        EXPECT_LT(difference, 0.01 * sum) << i; // other triangles
    }
}

// Only parts of a picture, triangles that a projector sees and shadows within reach of the sun are drawn.
TEST(Projector, what_is_left_out_of_drawing_would_have_shown_nothing) {
    const geometry::Rig rig = exampleRig();
    const test::SketchScene scene = test::sketchScene(8);
    FrameScene confined(scene.mesh, scene.occluders, &rig), whole(scene.mesh, scene.occluders, &rig);
    int drawn = 0, all = 0;
    for (size_t i = 0; i < whole.views.size(); ++i) {
        const View& view = whole.views[i];
        for (const PixelRect& part : confined.views[i].parts) {
            drawn += part.width * part.height;
            EXPECT_TRUE(part.x >= view.shown.x && part.x + part.width <= view.shown.x + view.shown.width &&
                        part.y >= view.shown.y && part.y + part.height <= view.shown.y + view.shown.height);
        }
        all += view.shown.width * view.shown.height;
        whole.views[i].parts = {view.shown};
    }
    EXPECT_LT(drawn, 0.8 * all);
    FrameRenderer part(test::device(), std::move(confined)), full(test::device(), std::move(whole));
    const std::vector<Image8> found = part.projectors(scene.light), wanted = full.projectors(scene.light);
    for (size_t i = 0; i < wanted.size(); ++i) EXPECT_EQ(found[i].rgb, wanted[i].rgb) << i;
}

TEST(Projector, one_that_is_turned_away_shows_nothing) {
    geometry::Rig rig = exampleRig();
    geometry::Projector& away = rig.projectors[0];
    const glm::dmat3 turn(-1, 0, 0, 0, 1, 0, 0, 0, -1); // about its own upright
    away.deviceFromWorld = turn * away.deviceFromWorld;
    away.translation = turn * away.translation;
    const test::SketchScene scene = test::sketchScene(8);
    FrameRenderer renderer(test::device(), scene.mesh, scene.occluders, &rig);
    const View& view = renderer.scene().views[0]; // else nobody would have cleared what is read back
    EXPECT_EQ(view.shown.width * view.shown.height, 0);
    const std::vector<Image8> pictures = renderer.projectors(scene.light);
    for (const uint8_t byte : pictures[0].rgb) ASSERT_EQ(byte, 0);
}

TEST(Projector, nothing_is_shown_outside_the_model) {
    const geometry::Rig rig = exampleRig();
    const test::SketchScene scene = test::sketchScene(6);
    FrameRenderer renderer(test::device(), scene.mesh, scene.occluders, &rig);
    const std::vector<Image8> pictures = renderer.projectors(scene.light);
    ASSERT_EQ(pictures.size(), 4u);
    for (size_t p = 0; p < 4; ++p) {
        const geometry::Projector& projector = rig.projectors[p];
        size_t lit = 0;
        for (int y = 0; y < projector.height; y += 3)
            for (int x = 0; x < projector.width; x += 3) {
                const uint8_t* value = pictures[p].pixel(x, y);
                if (value[0] + value[1] + value[2] == 0) continue;
                ++lit;
                // A lit pixel's ray meets the box of the room, a pixel's width let out.
                const geometry::Ray ray = projector.rayFromPixel({x, y});
                const glm::dvec3 half(8 * 0.0254 + 0.003, 5 * 0.0254 + 0.003, 6 * 0.0254 + 0.003),
                    centre(0, 5 * 0.0254, 0);
                double enter = 0, leave = 1e9;
                for (int axis = 0; axis < 3; ++axis) {
                    const double a = (centre[axis] - half[axis] - ray.origin[axis]) / ray.direction[axis],
                                 b = (centre[axis] + half[axis] - ray.origin[axis]) / ray.direction[axis];
                    enter = std::max(enter, std::min(a, b));
                    leave = std::min(leave, std::max(a, b));
                }
                EXPECT_LE(enter, leave) << "projector " << p << " pixel " << x << " " << y;
            }
        EXPECT_GT(lit, 500u);
        const View& view = renderer.scene().views[p]; // and little more is drawn
        EXPECT_LT(view.width * view.height,
                  view.supersample * view.supersample * projector.width * projector.height / 2);
    }
}

TEST(Projector, response_and_black_level_are_compensated) {
    geometry::Rig rig = exampleRig();
    const Markers m = markers();
    rig.projectors.resize(1);
    const auto shownBy = [&](const std::string& response, double black) {
        rig.projectors[0].response = response;
        rig.projectors[0].blackLevel = black;
        FrameRenderer renderer(test::device(), m.mesh, {}, &rig);
        ProjectorOptions options;
        options.tone.whiteLux = 4000; // a quarter of full where reach is met
        const auto pixel = rig.projectors[0].pixelFromWorld(m.centres[40]);
        const std::vector<Image8> pictures = renderer.projectors(m.light, options);
        return pictures[0].pixel(int(std::lround(pixel->x)), int(std::lround(pixel->y)))[1] / 255.0;
    };
    const double srgb = shownBy("srgb", 0), linear = std::pow((srgb + 0.055) / 1.055, 2.4);
    ASSERT_GT(linear, 0.05);
    ASSERT_LT(linear, 0.9);
    // Half a level of 255 on each side.
    EXPECT_NEAR(std::pow(shownBy("2.2", 0), 2.2), linear, 0.01);
    EXPECT_NEAR(shownBy("1", 0), linear, 0.01);
    EXPECT_NEAR(shownBy("1", 0.02), (linear - 0.02) / 0.98, 0.01);
}

// Sums over all projectors at the markers, as a part of the reach.
std::vector<double> shownAtMarkers(const geometry::Rig& rig, const Markers& m, double whiteLux) {
    FrameRenderer renderer(test::device(), m.mesh, {}, &rig);
    ProjectorOptions options;
    options.tone.whiteLux = whiteLux;
    std::vector<ImageF> drives;
    for (const Image8& picture : renderer.projectors(m.light, options))
        drives.push_back(driveOf(rig.projectors[drives.size()], picture));
    std::vector<double> sums;
    for (const glm::dvec3& c : m.centres)
        sums.push_back(physicalExitance(rig, drives, c, {0, 1, 0}, rig.surfaceReflectance).g /
                       renderer.reachLux());
    return sums;
}

// Where it is brighter than its own part, and than all that is wanted.
TEST(Projector, what_one_leaks_is_taken_off_the_others) {
    geometry::Rig rig = exampleRig();
    const Markers m = markers();
    const double white = 20000; // the light is a twentieth of the reach
    const std::vector<double> wanted = shownAtMarkers(rig, m, white);
    rig.projectors[0].blackLevel = 0.08;
    rig.projectors[2].blackLevel = 0.02;
    const std::vector<double> found = shownAtMarkers(rig, m, white), leaked = shownAtMarkers(rig, m, 1e12);
    size_t right = 0;
    for (size_t i = 0; i < m.centres.size(); ++i) {
        const double least = std::max(wanted[i], leaked[i]);
        right += std::abs(found[i] - least) < 0.04 * least; // half a step of each projector's byte
    }
    EXPECT_EQ(right, m.centres.size());
}

// In the middle of all pictures the brighter gives more, and all are at their full together.
TEST(Projector, unlike_ones_are_driven_alike) {
    geometry::Rig rig = exampleRig();
    rig.projectors[1].lumens = 600;
    const Markers m = markers();
    FrameRenderer renderer(test::device(), m.mesh, {}, &rig);
    const std::vector<ImageF> pictures = renderer.projectorsHdr(m.light);
    const auto drive = [&](size_t p) {
        const glm::dvec2 at = *rig.projectors[p].pixelFromWorld(m.centres[40]);
        return double{pictures[p].pixel(int(std::lround(at.x)), int(std::lround(at.y)))[1]};
    };
    ASSERT_GT(drive(0), 0.1);
    for (size_t p = 1; p < rig.projectors.size(); ++p) EXPECT_NEAR(drive(p), drive(0), 0.02 * drive(0)) << p;
}

TEST(Projector, a_picture_in_floats_is_the_one_in_bytes_with_its_windows) {
    geometry::Rig rig = exampleRig();
    rig.projectors.resize(1);
    const test::SketchScene scene = test::sketchScene(6);
    FrameRenderer renderer(test::device(), scene.mesh, scene.occluders, &rig);
    ProjectorOptions options;
    options.tone.whiteLux = 200000; // nothing is cut
    const Image8 bytes = renderer.projectors(scene.light, options)[0];
    const ImageF floats = renderer.projectorsHdr(scene.light, options)[0];
    for (size_t i = 0; i < bytes.rgb.size(); ++i) {
        const double code = bytes.rgb[i] / 255.0, f = std::min(double{floats.rgb[i]}, 1.0);
        const double coded = f <= 0.0031308 ? 12.92 * f : 1.055 * std::pow(f, 1 / 2.4) - 0.055;
        ASSERT_NEAR(coded, code, 1.0 / 255) << i; // drivers may round by more than half a step
    }
}

TEST(Projector, pictures_in_floats_and_bytes_of_one_drawing_are_those_of_two) {
    geometry::Rig rig = exampleRig();
    rig.projectors[1].response = "2.2";
    rig.projectors[2].blackLevel = 0.01;
    const test::SketchScene scene = test::sketchScene(6);
    for (const ToneMap map : {ToneMap::linear, ToneMap::falseColour}) {
        FrameRenderer renderer(test::device(), scene.mesh, scene.occluders, &rig);
        ProjectorOptions options;
        options.tone.map = map;
        const std::vector<Image8> bytes = renderer.projectors(scene.light, options);
        const std::vector<ImageF> floats = renderer.projectorsHdr(scene.light, options);
        const ProjectorPictures both = renderer.projectorsBoth(scene.light, options);
        ASSERT_EQ(both.bytes.size(), bytes.size());
        ASSERT_EQ(both.floats.size(), floats.size());
        for (size_t p = 0; p < bytes.size(); ++p) {
            EXPECT_TRUE(both.bytes[p].rgb == bytes[p].rgb) << p;
            EXPECT_TRUE(both.floats[p].rgb == floats[p].rgb) << p;
        }
    }
}

TEST(Projector, full_intensity_integrates_back_to_its_lumens) {
    // A narrow square picture of side s at distance 1 has the solid angle s^2 (1 - s^2 / 4 + ...).
    geometry::Projector projector;
    projector.width = projector.height = 100;
    projector.lens = {10000, 10000, 49.5, 49.5};
    projector.lumens = 1;
    EXPECT_NEAR(fullIntensity(projector), 1e4, 1); // 1e-4 of it is the next term
}

} // namespace
} // namespace heliodon::passes
