#include "engine/app/light_report.h"

#include <gtest/gtest.h>

#include "tests/compute/rooms.h"
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

} // namespace
} // namespace heliodon::app
