// Models whose coordinates are rounded: what touched does so within that.
#include "geometry/last_decimal.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "geometry/input_error.h"
#include "tests/geometry/sheet_drawing.h"

namespace heliodon::geometry {

namespace {

class Rounded {
public:
    Rounded(double turn, double step) : turn_(turn), step_(step) {}

    void room(double gap = 0) {
        const std::array<dvec3, 4> wall{dvec3(0), {4, 0, 0}, {4, 2.5, 0}, {0, 2.5, 0}},
            pane{dvec3(1, 0.8, 0), {3, 0.8, 0}, {3, 2, 0}, {1, 2, 0}};
        const auto sides = Drawing::sidesOf(dvec3(0), {4, 2.5, 5});
        for (size_t k = 0; k < 5; ++k) {
            const auto& [o, u, v] = sides[k];
            const dvec3 off = k == 1 ? dvec3(0, gap, 0) : dvec3(0);
            face("wall", {o + off, o + u + off, o + u + v + off, o + v + off});
        }
        for (size_t k = 0; k < 4; ++k) face("wall", {wall[k], wall[(k + 1) % 4], pane[(k + 1) % 4], pane[k]});
        face("glass", {pane.begin(), pane.end()});
    }
    void solid(dvec3 low, dvec3 size) {
        for (const auto& [o, u, v] : Drawing::sidesOf(low, size)) face("wall", {o, o + v, o + u + v, o + u});
    }
    Building read() { return drawing_.read(); }

private:
    void face(const char* material, std::vector<dvec3> corners) {
        for (dvec3& p : corners) {
            const dvec3 turned(std::cos(turn_) * p.x + std::sin(turn_) * p.z + 0.37, p.y + 0.123,
                               std::cos(turn_) * p.z - std::sin(turn_) * p.x);
            p = step_ * glm::round(turned / step_);
        }
        drawing_.face(material, std::move(corners));
    }

    Drawing drawing_{false};
    double turn_, step_;
};

} // namespace

TEST(LastDecimal, is_that_of_all_coordinates) {
    const std::vector<dvec3> points{{1.253, -3.141, 0}, {0.5, 0.001, 2}},
        typed{{1.25, -3, 0}, {0.5, 0.001, 2}};
    EXPECT_NEAR(lastDecimal(points, 1e-6), 0.001, 1e-12);
    EXPECT_EQ(lastDecimal(typed, 1e-6), 0);
    EXPECT_EQ(lastDecimal(points, 0.002), 0);
    EXPECT_EQ(lastDecimal(std::vector{dvec3(2, 3, 4)}, 1e-6), 1);
    EXPECT_EQ(lastDecimal(std::vector{dvec3(1.0 / 3, 3, 4)}, 1e-6), 0);
    EXPECT_NEAR(lastDecimal(std::vector{dvec3(0.1f, 12.3f, 4)}, 1e-6), 0.1, 1e-12); // single precision
}

// A table, a cupboard against a wall and one in a corner, turned: their corners are off walls and floor.
TEST(LastDecimal, furniture_stands_on_floors_within_it) {
    int told = 0;
    for (const double step : {1e-3, 1e-4})
        for (const double turn : {0.2, 0.5, 0.8, 1.1}) {
            Rounded model(turn, step);
            model.room();
            model.solid({1, 0.72, 2}, {1.2, 0.03, 0.7});
            for (const double x : {1.05, 2.1})
                for (const double z : {2.05, 2.6}) model.solid({x, 0, z}, {0.05, 0.72, 0.05});
            model.solid({0, 0, 1}, {0.6, 2, 0.6});
            model.solid({3.4, 0, 4.4}, {0.6, 2, 0.6});
            const Building building = model.read();
            EXPECT_EQ(building.roomCount, 1u);
            EXPECT_NEAR(volume(meshBuilding(building, {300})),
                        50 - 0.03 * 0.7 * 1.2 - 4 * 0.05 * 0.05 * 0.72 - 2 * 0.6 * 0.6 * 2, 30 * step);
            told += std::ranges::any_of(building.warnings, [](const std::string& warning) {
                return warning.starts_with("coordinates are rounded to ");
            });
        }
    EXPECT_GE(told, 4); // others close as they are
}

// Against a wall, or 5 mm sunk into it: only that is said.
TEST(LastDecimal, furniture_runs_into_walls_that_it_is_drawn_into) {
    for (int k = 1; k < 30; ++k)
        for (const bool sunk : {false, true}) {
            SCOPED_TRACE(testing::Message() << k << ' ' << sunk);
            Rounded model(0.05 * k, 1e-4);
            model.room();
            model.solid({sunk ? -0.005 : 0, 1.4, 1}, {0.4, 0.6, 0.7});
            model.solid({sunk ? 3.6 : 3.595, 0, 3}, {0.405, 2, 0.6});
            const Building building = model.read();
            EXPECT_NEAR(volume(meshBuilding(building, {300})),
                        50 - 0.6 * 0.7 * (sunk ? 0.395 : 0.4) - 2 * 0.6 * (sunk ? 0.4 : 0.405), 3e-3);
            EXPECT_EQ(std::ranges::any_of(building.warnings,
                                          [](const std::string& warning) {
                                              return warning.find(" through walls") != std::string::npos;
                                          }),
                      sunk);
        }
}

TEST(LastDecimal, gaps_that_are_wider_stay_open) {
    for (const auto& [step, gap] : {std::pair(1e-3, 0.004), {1e-4, 0.001}}) {
        Rounded model(0.3, step);
        model.room(gap);
        EXPECT_THROW(model.read(), InputError);
    }
}

} // namespace heliodon::geometry
