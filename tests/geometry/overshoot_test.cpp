// Walls that run on past another one by little end where the faces of the two meet: rooms have the corners
// and the area that they would have without, and what casts shadows does not stand out into them.
#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "geometry/building.h"
#include "tests/geometry/drawn_pieces.h"

using namespace heliodon::geometry;
using heliodon::test::turned;
using heliodon::test::wall;

namespace {

constexpr double kHalf = 0.1875; // inches of a wall's thickness

// An L whose corner in the middle is a wall's end and so much more; `lean`: of the wall across, to the side.
Sketch ell(double over, double lean = 0) {
    Sketch s;
    const glm::dvec2 foot(lean, -6);
    s.walls = {wall("w", {-8, 6 + kHalf}, {-8, -6 - kHalf}),   wall("n", {-8 - kHalf, 6}, {8 + kHalf, 6}),
               wall("e", {8, 6 + kHalf}, {8, -kHalf}),         wall("a", {8 + kHalf, 0}, {-kHalf - over, 0}),
               wall("b", kHalf * glm::normalize(-foot), foot), wall("s", {1, -6}, {-8 - kHalf, -6})};
    return s;
}

// Three rooms; the wall between two of them runs on into the third.
Sketch tee(double over) {
    Sketch s;
    s.walls = {wall("w", {-8, 6 + kHalf}, {-8, -6 - kHalf}),
               wall("n", {-8 - kHalf, 6}, {8 + kHalf, 6}),
               wall("e", {8, 6 + kHalf}, {8, -6 - kHalf}),
               wall("s", {8 + kHalf, -6}, {-8 - kHalf, -6}),
               wall("across", {-8, 0}, {8, 0}),
               wall("up", {1, -6}, {1, kHalf + over})};
    return s;
}

Sketch thick(Sketch s, double thickness) {
    for (Wall& w : s.walls) w.thickness = thickness;
    return s;
}

// A box into which its south side juts as a corner of so many degrees; walls run on past their crossing by
// half their thickness and so much more.
Sketch wedge(double degrees, double thickness, double over) {
    const double half = degrees / 2 * std::numbers::pi / 180, high = std::min(5.0, 6 / std::tan(half)),
                 x = high * std::tan(half);
    const glm::dvec2 tip(0, high - 7), up(std::sin(half), std::cos(half)), down(up.x, -up.y);
    const double on = thickness / 2 + over;
    Sketch s;
    s.walls = {wall("w", {-9, 7.3}, {-9, -7.3}),    wall("n", {-9.3, 7}, {9.3, 7}),
               wall("e", {9, 7.3}, {9, -7.3}),      wall("s1", {-9.3, -7}, {-x + 0.2, -7}),
               wall("a", {-x, -7}, tip + on * up),  wall("b", tip - on * down, {x, -7}),
               wall("s2", {x - 0.2, -7}, {9.3, -7})};
    return thick(s, thickness);
}

// Two rooms and a wall at a slant whose middle runs on past the far face of the wall between them.
Sketch slantedTee(double degrees, double thickness, double over) {
    const double a = degrees * std::numbers::pi / 180;
    const glm::dvec2 up(std::cos(a), std::sin(a)), foot = glm::dvec2(2, 0) - 6 / up.y * up;
    Sketch s = tee(0);
    s.walls.back() = wall("up", foot, glm::dvec2(2, 0) + (thickness / 2 / up.y + over) * up);
    return thick(s, thickness);
}

struct Measured {
    double area = 0; // square feet, all rooms
    size_t faces = 0;
};

Measured measured(const Sketch& sketch) {
    const Closure closure = closeSketch(sketch);
    Measured out;
    EXPECT_TRUE(closure.building) << closure.report.message;
    if (!closure.building) return out;
    for (const RoomReport& room : closure.report.rooms) out.area += room.floorAreaFt2;
    out.faces = closure.building->faces.size();
    return out;
}

// Corners of solids within the floor of a room, farther than a hair from its edges.
size_t cornersInAir(const Building& building) {
    size_t count = 0;
    for (const glm::dvec3 corner : building.occluders.vertices)
        for (const Face& face : building.faces) {
            if (std::ranges::any_of(face.loops[0], [&](uint32_t v) { return building.vertices[v].y != 0; }))
                continue;
            bool within = false;
            double nearest = 1e9;
            for (const auto& loop : face.loops)
                for (size_t i = 0; i < loop.size(); ++i) {
                    const glm::dvec3 a = building.vertices[loop[i]],
                                     b = building.vertices[loop[(i + 1) % loop.size()]];
                    if ((a.z > corner.z) != (b.z > corner.z) &&
                        corner.x < a.x + (b.x - a.x) * (corner.z - a.z) / (b.z - a.z))
                        within = !within;
                    const glm::dvec2 d(b.x - a.x, b.z - a.z), p(corner.x - a.x, corner.z - a.z);
                    const double t = std::clamp(glm::dot(p, d) / glm::dot(d, d), 0.0, 1.0);
                    nearest = std::min(nearest, glm::length(p - t * d));
                }
            count += within && nearest > 1e-3 * kMetresPerInch;
        }
    return count;
}

} // namespace

TEST(Overshoot, is_no_part_of_a_room) {
    for (const bool corner : {true, false}) {
        const Measured exact = measured(corner ? ell(0) : tee(0));
        for (const double over : {0.0025, 0.03, 0.1, 0.15, 0.3, 0.39})
            for (const double degrees : {0.0, 17.0, 90.0, 133.0}) {
                SCOPED_TRACE(testing::Message() << corner << ' ' << over << ' ' << degrees);
                const Sketch sketch = turned(corner ? ell(over) : tee(over), degrees);
                const Measured drawn = measured(sketch);
                EXPECT_EQ(drawn.faces, exact.faces);
                EXPECT_NEAR(drawn.area, exact.area, 1e-6);
                const Closure closure = closeSketch(sketch);
                EXPECT_EQ(cornersInAir(*closure.building), 0u);
            }
    }
}

TEST(Overshoot, ends_at_walls_that_lean) {
    for (const double lean : {-4.0, -3.0, -1.0, 1.0, 3.0, 6.0}) {
        const Measured exact = measured(ell(0, lean));
        for (const double over : {0.1, 0.2}) {
            SCOPED_TRACE(testing::Message() << lean << ' ' << over);
            const Measured drawn = measured(ell(over, lean));
            EXPECT_EQ(drawn.faces, exact.faces);
            EXPECT_NEAR(drawn.area, exact.area, 1e-6);
        }
    }
}

TEST(Overshoot, of_thick_walls_is_no_part_of_sharp_corners) {
    for (const double thickness : {0.25, 0.375, 0.5, 0.6})
        for (const double degrees : {30.0, 40.0, 60.0, 75.0, 90.0, 110.0, 135.0, 150.0}) {
            const Measured exact = measured(wedge(degrees, thickness, 0));
            EXPECT_EQ(exact.faces, 9u) << thickness << ' ' << degrees;
            for (const double over : {0.05, 0.1, 0.2}) {
                SCOPED_TRACE(testing::Message() << thickness << ' ' << degrees << ' ' << over);
                const Measured drawn = measured(turned(wedge(degrees, thickness, over), 17));
                EXPECT_EQ(drawn.faces, exact.faces);
                EXPECT_NEAR(drawn.area, exact.area, 1e-6);
            }
        }
}

TEST(Overshoot, of_slanted_walls_is_no_part_of_the_room_behind) {
    for (const double thickness : {0.375, 0.5, 0.6})
        for (const double degrees : {30.0, 45.0, 60.0, 75.0, 120.0}) {
            const Measured exact = measured(slantedTee(degrees, thickness, -0.3));
            for (const double over : {0.0, 0.03, 0.1, 0.2, 0.3, 0.39}) {
                SCOPED_TRACE(testing::Message() << thickness << ' ' << degrees << ' ' << over);
                const Measured drawn = measured(turned(slantedTee(degrees, thickness, over), 133));
                EXPECT_EQ(drawn.faces, exact.faces);
                EXPECT_NEAR(drawn.area, exact.area, 1e-6);
            }
            EXPECT_GT(measured(slantedTee(degrees, thickness, 0.45)).faces, exact.faces);
        }
}

// The two pieces are one side of the room.
TEST(Overshoot, of_walls_in_pieces_is_no_part_of_a_room) {
    Sketch s = ell(0.2);
    s.walls[3].b = {2, 0};
    s.walls.push_back(wall("a2", {1.9, 0}, {-kHalf - 0.2, 0}));
    s.walls[4].b = {0, -3};
    s.walls.push_back(wall("b2", {0, -2.9}, {0, -6}));
    EXPECT_EQ(measured(s).faces, measured(ell(0)).faces);
    EXPECT_NEAR(measured(s).area, measured(ell(0)).area, 1e-6);
}

// A bay whose side runs through the wall beside it, before another wall 1.2 in away.
TEST(Overshoot, does_not_go_on_to_what_lies_ahead) {
    const auto bay = [](double over) {
        const glm::dvec2 d = glm::normalize(glm::dvec2(1, -1)), foot(-8, 2), peak = foot - 2.0 * d;
        Sketch s;
        s.walls = {wall("s", {-8.2, -6}, {8.2, -6}),
                   wall("e", {8, -6.2}, {8, 6.2}),
                   wall("n", {8.2, 6}, peak + glm::dvec2(-0.3, 6 - peak.y)),
                   wall("w", {-8, 2.3}, {-8, -6.2}),
                   wall("bay", peak - 0.3 * d, foot + over * d),
                   wall("b", {peak.x, 6.3}, peak),
                   wall("m", {-7.8, 0.6}, {7.8, 0.6})};
        s.walls[4].thickness = s.walls[5].thickness = 0.6;
        return s;
    };
    for (const bool door : {false, true}) {
        const auto drawn = [&](double over) { // the end of a short wall beside a door is near, too
            Sketch s = bay(over);
            if (!door) return s;
            s.walls.back() = wall("m", {-4.4, 0.95}, {7.8, 0.95});
            s.walls.push_back(wall("jamb", {-7.8, 0.95}, {-7.05, 0.95}));
            return s;
        };
        const Measured exact = measured(drawn(-0.2));
        for (const double over : {0.0, 0.1, 0.2, 0.28, 0.35}) {
            SCOPED_TRACE(testing::Message() << door << ' ' << over);
            const Measured other = measured(turned(drawn(over), 33));
            EXPECT_EQ(other.faces, exact.faces);
            EXPECT_NEAR(other.area, exact.area, 1e-6);
        }
    }
}

TEST(Overshoot, is_a_wall_where_it_is_long) {
    EXPECT_EQ(measured(ell(0.45)).faces, measured(ell(0)).faces + 2);
    EXPECT_EQ(measured(tee(0.45)).faces, measured(tee(0)).faces + 4);
}

TEST(Overshoot, of_a_short_wall_is_what_it_is_drawn_for) {
    Sketch box = tee(0);
    box.walls.pop_back();
    for (const double slant : {50.0, 60.0, 75.0, 90.0})
        for (const double length : {0.45, 0.5, 0.55, 0.6}) {
            Sketch room = box;
            const glm::dvec2 foot(2, -6);
            room.walls.push_back(wall("nib", foot, foot + length * turned({1, 0}, slant)));
            const Measured drawn = measured(room);
            EXPECT_GE(drawn.faces, measured(box).faces + 3);
            for (const double degrees : {17.0, 45.0, 90.0, 133.0, 211.0}) {
                SCOPED_TRACE(testing::Message() << slant << ' ' << length << ' ' << degrees);
                const Measured other = measured(turned(room, degrees));
                EXPECT_EQ(other.faces, drawn.faces);
                EXPECT_NEAR(other.area, drawn.area, 1e-6);
            }
        }
    for (const double length : {0.45, 0.6, 0.8}) { // a stub as thick as it is long
        Sketch room = thick(box, 0.6);
        room.walls.push_back(wall("nib", {2, -6}, {2, -6 + 0.3 + length}));
        room.walls.back().thickness = 0.6;
        EXPECT_EQ(measured(room).faces, measured(thick(box, 0.6)).faces + 4) << length;
    }
    Sketch corner = ell(0);
    corner.walls.push_back(wall("return", {-0.3, 0}, {-0.3 - 0.3, 0})); // out of the corner in the middle
    EXPECT_EQ(measured(corner).faces, measured(ell(0)).faces + 2);
}

// Heads of T-shaped piers, in the middle and a little to one side.
TEST(Overshoot, short_walls_across_the_end_of_another_one_stay) {
    for (const double thickness : {0.25, 0.375, 0.5})
        for (const double length : {0.9, 1.0, 1.2, 1.4})
            for (const double off : {0.0, 0.05}) {
                Sketch s;
                s.walls = {wall("w", {-8, 6}, {-8, -6}), wall("n", {-8, 6}, {8, 6}),
                           wall("e", {8, 6}, {8, -6}), wall("s", {8, -6}, {-8, -6})};
                const double room = measured(thick(s, thickness)).area, half = thickness / 2;
                s.walls.push_back(wall("stem", {0, -6 + half}, {0, -4}));
                s.walls.push_back(wall("head", {off - length / 2, -4 + half}, {off + length / 2, -4 + half}));
                EXPECT_NEAR(measured(thick(s, thickness)).area,
                            room - thickness * (2 - half) - thickness * length, 1e-6)
                    << thickness << ' ' << length << ' ' << off;
            }
}
