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
    Sketch corner = ell(0);
    corner.walls.push_back(wall("return", {-0.3, 0}, {-0.3 - 0.3, 0})); // out of the corner in the middle
    EXPECT_EQ(measured(corner).faces, measured(ell(0)).faces + 2);
}
