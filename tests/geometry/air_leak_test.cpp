// Models that do not close: refused with the place where the air of the room gets out.
#include "geometry/air_leak.h"

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "geometry/input_error.h"
#include "tests/geometry/sheet_drawing.h"

namespace heliodon::geometry {

namespace {

struct Said {
    double width = 0;
    dvec3 place{1e9};
};

// As the message has it.
Said saidOf(Drawing& drawing) {
    Said out;
    try {
        const Building building = drawing.read();
        ADD_FAILURE() << building.roomCount << " rooms";
    } catch (const InputError& error) {
        const std::string what = error.what(), before = "leaks through a gap that is ",
                          round = " wide, round ";
        const size_t at = what.find(before), then = what.find(round);
        if (at == std::string::npos || then == std::string::npos) {
            ADD_FAILURE() << what;
            return out;
        }
        out.width = std::stod(what.substr(at + before.size()));
        std::istringstream(what.substr(then + round.size())) >> out.place.x >> out.place.y >> out.place.z;
    }
    return out;
}

// A box along the axes that looks out.
void body(std::vector<SoupFace>& faces, dvec3 o, dvec3 size) {
    for (const auto& [at, u, v] : Drawing::sidesOf(o, size)) {
        SoupFace& face = faces.emplace_back();
        face.loops = {{at, at + v, at + u + v, at + u}};
    }
}

// Screens, an open box and a canopy that hangs on the wall by an edge: larger borders than the gap has.
void clutter(Drawing& drawing) {
    drawing.sheet({0, 2.5, 0}, {4, 0, 0}, {0, 0.5, -3});
    drawing.sheet({1, 0.02, 2}, {2, 0, 0.3}, {0, 2, 0});
    drawing.sheet({2.2, 0.3, 1.5}, {0.3, 0, 1}, {0, 1.8, 0.2});
    for (const auto& [at, u, v] : Drawing::sidesOf({0.5, 0, 3.5}, {0.8, 0.6, 0.7}))
        if (u.y + v.y > 0) drawing.sheet(at, u, v);
}

} // namespace

TEST(AirLeak, gaps_in_walls_are_found_beside_larger_open_borders) {
    for (const double gap : {0.001, 0.05})
        for (const double turned : {0.0, 0.4}) {
            SCOPED_TRACE(fmt::format("gap {}, turned {}", gap, turned));
            Drawing drawing(false);
            drawing.turned = turned;
            clutter(drawing); // first in the file
            drawing.room(0, 4, true);
            drawing.sheet({0, 0, 5}, {0, 2.5, 0}, {1.5, 0, 0});
            drawing.sheet({1.5 + gap, 0, 5}, {0, 2.5, 0}, {2.5 - gap, 0, 0});
            const Said said = saidOf(drawing);
            EXPECT_NEAR(said.width, gap, 0.2 * gap);
            const dvec3 p(std::cos(turned) * said.place.x - std::sin(turned) * said.place.z, said.place.y,
                          std::sin(turned) * said.place.x + std::cos(turned) * said.place.z);
            EXPECT_NEAR(p.x, 1.5 + gap / 2, gap / 2 + 0.002);
            EXPECT_NEAR(p.z, 5, 0.006);
        }
}

TEST(AirLeak, names_of_objects_make_no_refusal_one_of_an_open_model) {
    Drawing drawing(false);
    drawing.room(0, 4, true);
    drawing.sheet({0, 0, 5}, {0, 2.5, 0}, {1.5, 0, 0}), drawing.sheet({1.6, 0, 5}, {0, 2.5, 0}, {2.4, 0, 0});
    drawing.object("not closed");
    drawing.sheet({3, 0, 5}, {0, 2, 0}, {0.8, 0, 0}, "glass"); // drawn twice
    drawing.sheet({3, 0, 5}, {0, 2, 0}, {0.8, 0, 0});
    try {
        drawing.read();
        ADD_FAILURE();
    } catch (const InputError& error) {
        const std::string what = error.what();
        EXPECT_NE(what.find("lie on one another"), std::string::npos) << what;
        EXPECT_EQ(what.find("leaks"), std::string::npos) << what;
    }
}

// A slot between two walls, each a closed body.
TEST(AirLeak, gaps_between_bodies_are_found) {
    const double gap = 0.02;
    std::vector<SoupFace> faces;
    body(faces, {0, -0.2, 0}, {4, 0.2, 5}), body(faces, {0, 2.5, 0}, {4, 0.2, 5});
    body(faces, {-0.2, -0.2, 0}, {0.2, 2.9, 5}), body(faces, {4, -0.2, 0}, {0.2, 2.9, 5});
    body(faces, {-0.2, -0.2, 5}, {4.4, 2.9, 0.2}), body(faces, {-0.2, -0.2, -0.2}, {2.2, 2.9, 0.2});
    body(faces, {2 + gap, -0.2, -0.2}, {2.2 - gap, 2.9, 0.2});
    body(faces, {1, 0, 2}, {0.5, 1, 0.5});
    const auto leak = airLeak(faces, 1e-5);
    ASSERT_TRUE(leak);
    EXPECT_NEAR(leak->width, gap, 0.2 * gap);
    EXPECT_NEAR(leak->place.x, 2 + gap / 2, gap);
    EXPECT_TRUE(leak->place.z >= -0.21 && leak->place.z <= 0.01) << leak->place.z;
}

TEST(AirLeak, what_is_closed_has_none) {
    const auto square = [](dvec3 o, dvec3 u, dvec3 v) {
        SoupFace face;
        face.loops = {{o, o + u, o + u + v, o + v}};
        return face;
    };
    std::vector<SoupFace> faces;
    for (const auto& [at, u, v] : Drawing::sidesOf({0, 0, 0}, {4, 2.5, 5})) faces.push_back(square(at, u, v));
    faces.push_back(square({1, 0.5, 1}, {1, 0, 0}, {0, 1, 0}));
    EXPECT_FALSE(airLeak(faces, 1e-5));
    faces[1].loops[0][2].y = faces[1].loops[0][3].y += 0.1; // one side of the ceiling is raised
    const auto leak = airLeak(faces, 1e-5);
    ASSERT_TRUE(leak);
    EXPECT_GT(leak->place.y, 2.49);
    EXPECT_LT(leak->width, 0.11);
}

} // namespace heliodon::geometry
