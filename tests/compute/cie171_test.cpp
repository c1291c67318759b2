// Cases after CIE 171:2006, sections 5.3 to 5.14, against quadrature of our own making (the CIE's tables are
// not copied); the rooms are in cie171_rooms.h. tests/app/cie171_command_test.cpp has them as files.
#include <numbers>

#include <gtest/gtest.h>

#include "compute/daylight/glazing.h"
#include "compute/daylight_transport.h"
#include "tests/compute/cie171_rooms.h"
#include "tests/compute/rooms.h"
#include "tests/gpu/test_device.h"

namespace heliodon::compute {
namespace {

using glm::dvec3;

// Where less than 0.01 % of the sky's light arrives, a difference of 0.0001 % counts as 1 %.
TEST(Cie171, daylight_through_openings_of_all_skies) {
    const test::Csv table("cie171.csv.gz");
    const test::cie171::Cases cases = test::cie171::casesOf(table);
    ASSERT_EQ(cases.size(), 18u);
    for (const auto& [name, rows] : cases) {
        DaylightTransport transport(test::device(), test::cie171::roomOf(name));
        const test::cie171::Places places(table, rows);
        transport.setSensors(places.sensors);
        ASSERT_TRUE(transport.report().sensorsOutside.empty()) << name.test << ' ' << name.opening;
        double worst = 0, squares = 0, inside = 0;
        std::string where;
        for (int type = 1; type <= 16; ++type) {
            // Sun in the south, 60 degrees high.
            daylight::Sky sky = daylight::cieGeneralSky(type, {0, std::sqrt(0.75), 0.5}, 5000);
            const double horizontal = daylight::diffuseHorizontalIlluminance(sky);
            sky.ground.luminance = test::cie171::hasGround(name) ? 0.3 * horizontal / std::numbers::pi : 0;
            const Moment moment = transport.light(sky);
            for (const size_t row : rows) {
                if (table.number(row, "sky") != type) continue;
                const LightParts& parts = moment.sensors[places.sensorOfRow.at(row)];
                const double percent = 100 * photometric(parts.total()) / horizontal,
                             there = table.number(row, "percent");
                const double off = std::abs(percent - there) / std::max(there, 0.01);
                squares += off * off;
                inside +=
                    std::abs(percent - there) * horizontal / 100 <= double{parts.error} + 1e-6 * horizontal;
                if (off > worst)
                    worst = off, where = table.text(row, "point") + " type " + std::to_string(type) + " " +
                                         std::to_string(percent) + " " + std::to_string(there);
            }
        }
        const auto count = static_cast<double>(rows.size());
        std::printf("%-10s %-8s values %4.0f  rms %.4f %%  worst %.3f %% (%s)  inside lux_error %.1f %%\n",
                    name.test.c_str(), name.opening.c_str(), count, 100 * std::sqrt(squares / count),
                    100 * worst, where.c_str(), 100 * inside / count);
        EXPECT_LT(worst, 0.003) << name.test << ' ' << name.opening << ' ' << where;
        EXPECT_GE(inside / count, 0.99);
    }
}

TEST(Cie171, configuration_factors_of_sources_and_reflectors) {
    const test::Csv table("cie171_kernels.csv");
    for (const test::cie171::Source& source : test::cie171::sources()) {
        DaylightTransport transport(test::device(), source.mesh);
        std::vector<Sensor> sensors;
        std::vector<double> values;
        for (size_t row = 0; row < table.rows.size(); ++row)
            if (table.text(row, "test") == source.test) {
                sensors.push_back(test::cie171::sensorAt(table.number(row, "y"), table.number(row, "z")));
                values.push_back(table.number(row, "value"));
            }
        ASSERT_FALSE(values.empty());
        transport.setSensors(sensors);
        const Moment moment = transport.light(daylight::Sky{});
        double worst = 0;
        for (size_t s = 0; s < values.size(); ++s) {
            const double lux = photometric(moment.sensors[s].total());
            EXPECT_NEAR(lux, values[s], 0.001 * values[s] + 1e-5) << source.test << " sensor " << s;
            if (values[s] > 0) worst = std::max(worst, std::abs(lux / values[s] - 1));
        }
        std::printf("%-10s worst %.5f %%\n", source.test.c_str(), 100 * worst);
    }
}

// A lamp of 10000 lm in the middle of a cube of 4 m: what its walls send on is spread as the lamp's light is.
TEST(Cie171, light_reflected_within_a_cube) {
    const test::Csv table("cie171_kernels.csv");
    for (size_t row = 0; row < table.rows.size(); ++row) {
        if (table.text(row, "test") != "5.8") continue;
        const double rho = table.number(row, "point"), there = table.number(row, "value");
        test::BoxRoom cube;
        cube.high = {4, 4, 4}, cube.cells = {8, 8, 8};
        cube.wall.reflectance = glm::vec3(static_cast<float>(rho));
        geometry::PatchMesh mesh = test::boxRoom(cube);
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            // The solid angle of a triangle (Van Oosterom, Strackee 1983) is its share of the lamp's light.
            const auto corner = [&](size_t k) {
                return glm::normalize(mesh.vertices[mesh.patch(i)[k]] - dvec3(2));
            };
            const dvec3 a = corner(0), b = corner(1), c = corner(2);
            const double angle = 2 * std::atan2(std::abs(glm::dot(a, glm::cross(b, c))),
                                                1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
            const double lux = 10000 * angle / (4 * std::numbers::pi) / geometry::patchArea(mesh, i);
            geometry::Material wall = cube.wall;
            wall.exitance = glm::vec3(static_cast<float>(rho * lux));
            mesh.material[i] = static_cast<uint32_t>(mesh.materials.size());
            mesh.materials.push_back(wall);
        }
        DaylightTransport transport(test::device(), mesh);
        const Moment moment = transport.light(daylight::Sky{});
        double sum = 0;
        for (size_t i = 0; i < mesh.patchCount(); ++i)
            sum += geometry::patchArea(mesh, i) * photometric(moment.patches[i].total()) / 96;
        EXPECT_NEAR(sum, there, 0.001 * there) << "reflectance " << rho;
        if (there > 0) std::printf("5.8        rho %.2f off %.4f %%\n", rho, 100 * (sum / there - 1));
    }
}

TEST(Cie171, directional_transmittance_of_clear_glass) {
    const test::Csv table("cie171_kernels.csv");
    size_t rows = 0;
    for (size_t row = 0; row < table.rows.size(); ++row) {
        const std::string name = table.text(row, "test");
        if (!name.starts_with("5.5")) continue;
        const double t = name == "5.5" ? daylight::transmissivityFromNormal(0.88, 1.52) : 1;
        const double cosine = std::cos(table.number(row, "point") * std::numbers::pi / 180);
        EXPECT_NEAR(daylight::slabTransmittance(cosine, t, 1.52), table.number(row, "value"), 2e-6);
        ++rows;
    }
    EXPECT_EQ(rows, 38u);
}

} // namespace
} // namespace heliodon::compute
