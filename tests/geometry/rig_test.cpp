#include "geometry/rig.h"

#include <cmath>
#include <fstream>
#include <random>

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include "geometry/input_error.h"
#include "geometry/rig_edit.h"
#include "tests/documented_file.h"

namespace heliodon::geometry {
namespace {

Rig example() {
    return readRig(HELIODON_SOURCE "/examples/rig.json");
}

const char* const kPlainRig = R"({
 "format": "vh-rig/1",
 "camera": {"width": 100, "height": 80, "K": [[50, 0, 49.5], [0, 50, 39.5], [0, 0, 1]],
  "R": [[1, 0, 0], [0, 0, 1], [0, -1, 0]], "t": [0, 0, 2]},
 "projectors": [{"width": 10, "height": 8, "K": [[5, 0, 4], [0, 5, 4], [0, 0, 1]],
  "R": [[1, 0, 0], [0, 0, 1], [0, -1, 0]], "t": [0, 0, 1], "lumens": 1500, "black_level": 0.01, "response": 2.2,
  "display": "DP-1"}],
 "site": {"latitude_deg": 42.73, "longitude_deg": -73.68}
})";

std::filesystem::path written(const std::string& text) {
    const auto path = std::filesystem::path(testing::TempDir()) / "heliodon_rig_test.json";
    std::ofstream(path) << text;
    return path;
}

std::string complaint(const std::string& text) {
    try {
        readRig(written(text));
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

TEST(Rig, the_documented_one_is_read) {
    const Rig rig = readRig(written(test::documentedFile("vh-rig/1")));
    EXPECT_TRUE(rig.unknownFields.empty());
    ASSERT_EQ(rig.projectors.size(), 1u);
    EXPECT_EQ(rig.projectors[0].display, "HDMI-1");
    EXPECT_NEAR(rig.camera.centre().y, 1.53, 1e-12); // over the table, which it looks down at
    const auto middle = rig.projectors[0].pixelFromWorld({0, 0, 0});
    ASSERT_TRUE(middle);
    EXPECT_NEAR(middle->x, 512, 1e-9);
}

TEST(Rig, projects_as_the_formulas_written_out_by_hand) {
    const Rig rig = example();
    const glm::dvec3 world(0.21, 0.2032, -0.17);
    // X_dev = R X + t, then Brown-Conrady, with the numbers of the file typed here again.
    const double xd = 0.999132844701057 * 0.21 - 0.010038502903111349 * 0.2032 - 0.04040776038136249 * 0.17 -
                      0.004238977941092399;
    const double yd = -0.040129320412587384 * 0.21 + 0.02654204753141594 * 0.2032 -
                      0.9988419080895954 * 0.17 - 0.00583253416688722;
    const double zd = -0.01109938209078687 * 0.21 - 0.9995972929996881 * 0.2032 -
                      0.026116193154792636 * 0.17 + 1.5315044931736919;
    const double x = xd / zd, y = yd / zd, r2 = x * x + y * y;
    const double radial = 1 - 0.182 * r2 + 0.094 * r2 * r2;
    const double u = 1238.6 * (x * radial + 2 * 0.0006 * x * y - 0.0004 * (r2 + 2 * x * x)) + 703.2;
    const double v = 1240.1 * (y * radial + 0.0006 * (r2 + 2 * y * y) - 2 * 0.0004 * x * y) + 509.4;
    const auto pixel = rig.camera.pixelFromWorld(world);
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x, u,
                1e-8); // R is re-orthonormalised: it moves by the file's rounding, 1e-15 of 1.5 m
    EXPECT_NEAR(pixel->y, v, 1e-8);
}

TEST(Rig, sees_what_an_independent_renderer_projected) {
    // Corners of painted wall tops in the truth of a synthetic photograph, rounded there to 1e-4 px and 1e-7
    // m.
    const Rig rig = example();
    const struct {
        glm::dvec3 world;
        glm::dvec2 pixel;
    } marks[] = {{{-0.2158875, 0.2032, 0.1730709}, {505.275, 676.3399}},
                 {{0.2413126, 0.2032, 0.1742741}, {926.4495, 660.9652}},
                 {{0.26625, 0.254, 0.1574311}, {957.8497, 651.0265}}};
    for (const auto& mark : marks) {
        const glm::dvec2 pixel = rig.camera.pixelFromWorld(mark.world).value();
        EXPECT_NEAR(glm::distance(pixel, mark.pixel), 0,
                    2e-3); // OpenCV differs from that truth by up to 1.2e-4
        const glm::dvec3 back = rig.camera.worldOnPlane(mark.pixel, mark.world.y).value();
        EXPECT_NEAR(glm::distance(back, mark.world), 0, 1e-6);
    }
}

TEST(Rig, undoes_its_lens_over_the_whole_picture) {
    Rig rig = example();
    rig.projectors.push_back({});
    rig.projectors.back().lens = {900, 905, 700,
                                  500, 0.4, {-0.31, 0.13, 1e-3, -8e-4, -0.02}}; // wide and skewed
    std::mt19937 random(7);
    std::uniform_real_distribution<double> u(-0.5, 1391.5), v(-0.5, 1031.5);
    for (const Lens& lens : {rig.camera.lens, rig.projectors[0].lens, rig.projectors.back().lens}) {
        for (int i = 0; i < 2000; ++i) {
            const glm::dvec2 pixel(u(random), v(random));
            EXPECT_LT(glm::distance(lens.pixelFromPlane(lens.planeFromPixel(pixel)), pixel), 1e-6);
        }
    }
}

TEST(Rig, rays_leave_the_centre_and_meet_the_point) {
    const Rig rig = example();
    EXPECT_NEAR(glm::distance(rig.camera.centre(), glm::dvec3(0.021, 1.531, -0.034)), 0, 1e-9);
    for (const Projector& projector : rig.projectors) {
        const glm::dvec3 point(0.1, 0.2, -0.3);
        const glm::dvec2 pixel = projector.pixelFromWorld(point).value();
        const Ray ray = projector.rayFromPixel(pixel);
        EXPECT_NEAR(glm::length(ray.direction), 1, 1e-14);
        EXPECT_NEAR(glm::length(glm::cross(ray.direction, point - ray.origin)), 0, 1e-9);
        EXPECT_FALSE(projector.pixelFromWorld(ray.origin - ray.direction)); // behind it
        EXPECT_FALSE(projector.worldOnPlane(pixel, ray.origin.y + 1));      // above it, looking down
    }
}

TEST(Rig, reads_every_field) {
    const Rig rig = readRig(written(kPlainRig));
    ASSERT_EQ(rig.projectors.size(), 1u);
    EXPECT_EQ(rig.projectors[0].id, "P0");
    EXPECT_EQ(rig.projectors[0].lumens, 1500);
    EXPECT_EQ(rig.projectors[0].blackLevel, 0.01);
    EXPECT_EQ(std::stod(rig.projectors[0].response), 2.2);
    EXPECT_EQ(rig.projectors[0].display, "DP-1");
    EXPECT_EQ(rig.site.value().longitudeDeg, -73.68);
    EXPECT_EQ(rig.tableRadius, 0.5334);
    const glm::dvec2 pixel = rig.camera.pixelFromWorld({0.4, 0, 0}).value(); // camera 2 m up, looking down
    EXPECT_NEAR(pixel.x, 49.5 + 50 * 0.2, 1e-12);
    EXPECT_EQ(example().projectors.at(3).id, "P3");
}

TEST(Rig, names_fields_that_it_does_not_know) {
    EXPECT_TRUE(example().unknownFields.empty());
    const std::string wrong = replaced(replaced(kPlainRig, "lumens", "lumnes"), "\"t\": [0, 0, 2]",
                                       "\"t\": [0, 0, 2], \"distortion\": [0.1]");
    EXPECT_EQ(readRig(written(wrong)).unknownFields,
              (std::vector<std::string>{"camera.distortion (dist?)", "projectors[0].lumnes (lumens?)"}));
    const std::string alone = replaced(kPlainRig, "\"projectors\":", "\"note\": 1, \"Projector\":");
    EXPECT_EQ(readRig(written(alone)).unknownFields, std::vector<std::string>{"Projector (projectors?)"});
    const std::string turned = replaced(kPlainRig, "\"projectors\":", "\"porjectors\":");
    EXPECT_EQ(readRig(written(turned)).unknownFields, std::vector<std::string>{"porjectors (projectors?)"});
    const std::string inner = replaced(
        replaced(kPlainRig,
                 "\"site\":", "\"table\": {\"radius_m\": 0.5, \"radius\": 1, \"height_m\": 0.8}, \"site\":"),
        "\"latitude_deg\":", "\"latitude\": 1, \"latitude_deg\":");
    EXPECT_EQ(readRig(written(inner)).unknownFields,
              (std::vector<std::string>{"table.radius (radius_m?)", "site.latitude (latitude_deg?)"}));
}

TEST(Rig, makes_a_rounded_rotation_orthonormal) {
    const Rig rig = readRig(written(replaced(kPlainRig, "[[1, 0, 0], [0, 0, 1], [0, -1, 0]]",
                                             "[[1.0003, 0, 0.0002], [0, 0, 1], [0, -0.9998, 0]]")));
    const glm::dmat3 r = rig.camera.deviceFromWorld;
    const glm::dmat3 error = r * glm::transpose(r) - glm::dmat3(1);
    for (int i = 0; i < 3; ++i) EXPECT_LT(glm::length(error[i]), 1e-12);
}

TEST(Rig, names_the_wrong_field) {
    const struct {
        const char *from, *to, *expected;
    } cases[] = {
        {"vh-rig/1", "vh-rig/9", "format: \"vh-rig/9\", expected \"vh-rig/1\""},
        {"\"width\": 100", "\"width\": 100.5", "camera.width: expected a whole number of pixels"},
        {"\"width\": 100", "\"width\": -3", "camera.width: -3 is not between"},
        {"\"width\": 100, ", "", "camera.width: missing"},
        {"[0, 50, 39.5]", "[0, 50]", "camera.K[1]: expected 3 elements, found 2"},
        {"[0, 50, 39.5]", "[0, \"x\", 39.5]", "camera.K[1][1]: expected a number"},
        {"[0, 50, 39.5]", "[0, 0, 39.5]", "camera.K: focal lengths"},
        {"[0, 5, 4]", "[1, 5, 4]", "projectors[0].K: expected [[fx"},
        {"[0, -1, 0]]", "[0, -1.1, 0]]", "camera.R: not a rotation"},
        {"[0, -1, 0]]", "[0, 1, 0]]", "camera.R: mirrors space"},
        {"\"t\": [0, 0, 1]", "\"t\": [0, 1]", "projectors[0].t: expected 3 elements"},
        {"\"t\": [0, 0, 1]", "\"x\": \"1e400\",\n\"t\": [0, 0, 1e400]", "test.json:7: 1e400 is too large"},
        {"\"t\": [0, 0, 1]", "\"t\": [0, 0, 1e400]", "test.json:6: 1e400 is too large a number to represent"},
        {"\"t\": [0, 0, 1]", "\"t\": [0, 0, 1e200]", "projectors[0].t[2]: 1e+200 is not between"},
        {"0.01", "7", "projectors[0].black_level: 7 is not between 0 and 1"},
        {"\"response\": 2.2", "\"response\": \"log\"", "projectors[0].response: \"log\" is not known"},
        {"\"site\"", "\"surface_reflectance\": 1, \"site\"",
         "surface_reflectance: 1 is not between 0.01 and 0.98"},
        {"-73.68", "-273.68", "site.longitude_deg: -273.68 is not between"},
        {"\"K\": [[5,", "\"dist\": [1, 2, 3], \"K\": [[5,",
         "projectors[0].dist: expected k1, k2, p1, p2[, k3]"},
        {"\"K\": [[5,", "\"dist\": [0, 1e300, 0, 0], \"K\": [[5,",
         "projectors[0].dist[1]: 1e+300 is not between"},
        {"\"K\": [[5,", "\"dist\": [-2, 0, 0, 0], \"K\": [[5,",
         "projectors[0]: the lens (K, dist) folds back"},
        {"\"K\": [[50, 0, 49.5]", "\"K\": [[1e-300, 0, 49.5]", "camera: the lens (K, dist) folds back"},
    };
    for (const auto& c : cases) {
        const std::string what = complaint(replaced(kPlainRig, c.from, c.to));
        EXPECT_NE(what.find(c.expected), std::string::npos) << what << "\nexpected: " << c.expected;
    }
}

TEST(RigFile, is_read_once_and_keeps_what_it_does_not_know) {
    const auto path = std::filesystem::path(testing::TempDir()) / "heliodon_rig_file_test.json";
    std::ofstream(path) << R"({"format": "vh-rig/1", "colour": "grey", "table": {"radius_m": 0.4}})";
    const RigFile file(path);
    std::filesystem::remove(path); // as a pipe is empty once it was read
    EXPECT_TRUE(file.namesTable());
    EXPECT_THROW(file.rig(), InputError); // no camera yet
    OpticalDevice camera;
    camera.width = 640, camera.height = 480;
    camera.lens = {700, 700, 320, 240, 0, {}};
    camera.translation = {0, 0, 2};
    file.write(path, {0.5, camera, {}});
    EXPECT_EQ(readRig(path).camera.lens.fx, 700);
    const RigFile written(path);
    EXPECT_EQ(written.rig().tableRadius, 0.5);
    std::ifstream in(path);
    EXPECT_NE(std::string(std::istreambuf_iterator<char>(in), {}).find("grey"), std::string::npos);
    EXPECT_FALSE(RigFile("").namesTable());
}

// As calibration leaves many a wide lens: the polynomial has its largest value before the corner.
TEST(Rig, takes_a_lens_that_folds_back_in_the_corners_alone) {
    const Rig rig =
        readRig(written(replaced(kPlainRig, "\"K\": [[50,", "\"dist\": [-0.3, 0, 0, 0, 0], \"K\": [[50,")));
    const Lens& lens = rig.camera.lens;
    const auto missed = [&](glm::dvec2 pixel) {
        return glm::distance(lens.pixelFromPlane(lens.planeFromPixel(pixel)), pixel);
    };
    EXPECT_LT(missed({75, 60}), 1e-6);
    EXPECT_GT(missed({99, 79}), 1); // there is no such ray
    EXPECT_TRUE(std::isfinite(lens.planeFromPixel({99, 79}).x));
}

TEST(Rig, refuses_more_projectors_than_it_can_tell_apart) {
    const std::string whole = kPlainRig;
    const size_t from = whole.find("{\"width\": 10,"), to = whole.find("}],") + 1;
    const std::string projector = whole.substr(from, to - from);
    std::string list = projector;
    for (size_t k = 1; k < kMostProjectors; ++k) list += ", " + projector;
    EXPECT_EQ(complaint(replaced(whole, projector, list)), "accepted");
    EXPECT_NE(complaint(replaced(whole, projector, list + ", " + projector))
                  .find("projectors: expected 31 at most"),
              std::string::npos);
}

TEST(Rig, survives_a_file_cut_anywhere) {
    const std::string whole = kPlainRig;
    EXPECT_NE(complaint("\n").find("is empty, expected a rig"), std::string::npos);
    for (size_t length = 7; length + 1 < whole.size(); length += 7) {
        const std::string what = complaint(whole.substr(0, length));
        EXPECT_NE(what.find("is not JSON here"), std::string::npos) << length << ": " << what;
    }
    EXPECT_NE(complaint("[1, 2]").find("expected an object"), std::string::npos);
    EXPECT_THROW(readRig("/no/such/rig.json"), InputError);
}

} // namespace
} // namespace heliodon::geometry
