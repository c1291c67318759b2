#include "engine/app/light_report.h"

#include <functional>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "engine/app/finite_light.h"
#include "tests/compute/rooms.h"
#include "tests/compute/skies.h"
#include "tests/gpu/test_device.h"

namespace heliodon::app {
namespace {

// Two walls and loose squares between them.
geometry::PatchMesh crowd() {
    std::vector<std::vector<glm::dvec3>> faces{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                                               {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}}};
    for (int i = 0; i < 5; ++i)
        for (int k = 0; k < 4; ++k) {
            const glm::dvec3 low(0.1 + 0.17 * i, 0.1 + 0.22 * k, 0.3 + 0.09 * ((i + 2 * k) % 5));
            faces.push_back({low, low + glm::dvec3(0.1, 0, 0.02), low + glm::dvec3(0.1, 0.09, 0.02),
                             low + glm::dvec3(0, 0.09, 0)});
        }
    return test::polygons(faces);
}

TEST(LightReport, long_work_on_form_factors_is_noted_with_what_would_take_less) {
    compute::TransportOptions options;
    options.formFactors.maxError = 1e-5;
    options.formFactors.longFrom = 0;
    app::Run run(Arguments{"illuminance", {}, {}});
    testing::internal::CaptureStderr();
    makeTransport(run, test::device(), crowd(), options);
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_NE(said.find("past many blockers: about"), std::string::npos) << said;
    EXPECT_NE(said.find("--triangles"), std::string::npos) << said;
    EXPECT_EQ(run.report().dump().find("past many blockers"), std::string::npos) << "no part of the report";
}

std::string errorOf(const std::function<void()>& act) {
    try {
        act();
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "";
}

// A lamp so bright that sums of its light overflow stands for whatever makes no number of light.
TEST(LightReport, light_that_is_no_finite_number_does_not_leave_the_program) {
    test::BoxRoom box;
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9; };
    box.wall.exitance = glm::vec3(3e38f);
    compute::DaylightTransport transport(test::device(), test::boxRoom(box));
    app::Run run(Arguments{"illuminance", {}, {}});
    const daylight::Sky sky = test::overcast();
    const auto solve = [&] { solveLights(run, transport, std::span(&sky, 1)); };
    EXPECT_TRUE(errorOf(solve).starts_with("patch 0 ")) << errorOf(solve);
    transport.setSensors({{{2, 1, 2}, {0, 1, 0}}});
    EXPECT_TRUE(errorOf(solve).starts_with("sensor 0 ")) << errorOf(solve);
}

TEST(LightReport, hours_without_a_finite_number_are_named_by_their_sensor) {
    std::vector<float> lux{1, 2, 3, 4, 5, 6};
    expectFinite(lux, 10, 2);
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        lux[3] = bad; // the second of three sensors
        EXPECT_TRUE(errorOf([&] { expectFinite(lux, 10, 2); }).starts_with("sensor 11 "));
    }
}

TEST(LightReport, any_part_of_a_place_that_is_no_number_is_found) {
    compute::Moment moment;
    moment.sensors.resize(3);
    expectFinite(moment);
    const auto refused = [&](float& part) {
        part = std::numeric_limits<float>::quiet_NaN();
        const std::string error = errorOf([&] { expectFinite(moment); });
        part = 0;
        return error.starts_with("sensor 2 ");
    };
    compute::LightParts& last = moment.sensors[2];
    for (float* part : {&last.sun.x, &last.sky.y, &last.ground.z, &last.interreflected.x, &last.error})
        EXPECT_TRUE(refused(*part));
}

} // namespace
} // namespace heliodon::app
