#include "compute/point_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "compute/sensor_gather.h"
#include "compute/view_cells.h"
#include "geometry/mesher.h"
#include "geometry/model_file.h"
#include "tests/compute/rooms.h"

namespace heliodon::compute {
namespace {

using glm::dvec3;

// From a point to a parallel rectangle with one corner straight above it (Howell, B-3).
double parallelCorner(double a, double b) {
    const double ra = std::sqrt(1 + a * a), rb = std::sqrt(1 + b * b);
    return (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb)) / (2 * std::numbers::pi);
}

std::vector<dvec3> rectangle(double x0, double x1, double z0, double z1, double y) {
    return {{x0, y, z0}, {x1, y, z0}, {x1, y, z1}, {x0, y, z1}};
}

void addRectangle(geometry::PatchMesh& mesh, const std::vector<dvec3>& corners) {
    std::vector<uint32_t> indices;
    for (const dvec3& corner : corners) {
        indices.push_back(static_cast<uint32_t>(mesh.vertices.size()));
        mesh.vertices.push_back(corner);
    }
    mesh.addPatch(indices, 0, geometry::Role::projection, static_cast<uint32_t>(mesh.patchCount()), 0);
}

// A sheet of the given extent at height 1 between the floor's middle and a ceiling at height 2.
geometry::PatchMesh roomWithSheet(double x0, double x1, double z0, double z1) {
    geometry::PatchMesh mesh = test::boxRoom({.low = dvec3(-3, 0, -3), .high = dvec3(3, 2, 3)});
    addRectangle(mesh, rectangle(x0, x1, z0, z1, 1));
    return mesh;
}

TEST(PointView, open_rectangle_is_howells) {
    const geometry::PatchMesh mesh = test::boxRoom({.low = dvec3(-3, 0, -3), .high = dvec3(3, 2, 3)});
    const Blockers blockers(mesh);
    const PointView view(blockers, {0, 0, 0}, {0, 1, 0}, 0);
    EXPECT_NEAR(view.factor(rectangle(0, 1.5, 0, 0.7, 2)), parallelCorner(0.75, 0.35), 1e-14);
}

// A board over the floor, seen from the ceiling: of floor and board all of the view is seen once, however
// thin the board, from five millionths of the room on.
TEST(PointView, what_a_thin_board_covers_is_not_seen_besides) {
    const double size = glm::length(dvec3(6, 2, 6)); // of the room
    for (const auto& [gap, thickness] : {std::pair(5e-6, 1e-6), {1e-6, 5e-6}, {1e-3, 1e-3}}) {
        geometry::PatchMesh mesh = test::boxRoom({.low = dvec3(-3, 0, -3), .high = dvec3(3, 2, 3)});
        const double low = gap * size, high = low + thickness * size;
        std::vector<dvec3> top = rectangle(-0.7, 0.7, -0.7, 0.7, high);
        std::ranges::reverse(top);
        addRectangle(mesh, top);
        addRectangle(mesh, rectangle(-0.7, 0.7, -0.7, 0.7, low));
        const PointView view(Blockers(mesh), {0.1, 1.5, 0.2}, {0, -1, 0}, 0);
        double sum = 0;
        for (size_t i = 0; i < mesh.patchCount(); ++i)
            if (geometry::patchNormal(mesh, i).y > -0.5) sum += view.factor(geometry::patchCorners(mesh, i));
        EXPECT_NEAR(sum, 1, 1e-3) << gap << ", " << thickness;
    }
}

// However large the scene is in its unit.
TEST(PointView, windows_are_hidden_by_what_stands_before_them_in_a_large_unit) {
    for (const double unit : {1.0, 1e6}) {
        const geometry::PatchMesh mesh =
            test::boxRoom({.low = unit * dvec3(-3, 0, -3), .high = unit * dvec3(3, 2, 3)});
        const PointView view(Blockers(mesh), dvec3(0), {0, 1, 0}, 0);
        std::vector<dvec3> pane = rectangle(-1, 1, -1, 1, 1.5), before = rectangle(-2, 2, -2, 2, 1);
        for (dvec3& p : pane) p *= unit;
        for (dvec3& p : before) p *= unit;
        std::vector<PointView::Polygon> parts{pane};
        view.hideBeyond(std::vector<const PointView::Polygon*>{&before}, parts);
        EXPECT_TRUE(parts.empty()) << unit;
    }
}

TEST(PointView, a_sheet_takes_its_shadow_and_no_more) {
    const geometry::PatchMesh mesh = roomWithSheet(-0.5, 0.25, -0.5, 0.4);
    const Blockers blockers(mesh);
    const PointView view(blockers, {0, 0, 0}, {0, 1, 0}, 0);
    const auto F = [](double x0, double x1, double z0, double z1) {
        return parallelCorner(x1 / 2, z1 / 2) + parallelCorner(-x0 / 2, z1 / 2) +
               parallelCorner(x1 / 2, -z0 / 2) + parallelCorner(-x0 / 2, -z0 / 2);
    };
    EXPECT_NEAR(view.factor(rectangle(-2, 2, -2, 2, 2)), F(-2, 2, -2, 2) - F(-1, 0.5, -1, 0.8), 1e-13);
    std::vector<PointView::Polygon> parts;
    EXPECT_EQ(view.factor(rectangle(-0.4, 0.4, -0.4, 0.4, 2), parts), 0); // wholly behind it
    EXPECT_TRUE(parts.empty());
}

// A lattice of 18 x 18 sheets, of whose shadows, side by side, the form factors are known.
TEST(PointView, behind_a_crowd_what_is_seen_is_exact_and_in_few_pieces) {
    constexpr int kRow = 18;
    constexpr double kStep = 2.0 / kRow, kSheet = 0.6 * kStep;
    geometry::PatchMesh mesh = test::boxRoom({.low = dvec3(-3, 0, -3), .high = dvec3(3, 2, 3)});
    const auto corner = [](double x, double z) { // signed: of rectangles between corners
        return std::copysign(parallelCorner(std::abs(x) / 2, std::abs(z) / 2), x * z);
    };
    const auto F = [&](double x0, double x1, double z0, double z1) {
        return corner(x1, z1) - corner(x0, z1) - corner(x1, z0) + corner(x0, z0);
    };
    double lit = F(-2, 2, -2, 2);
    for (int i = 0; i < kRow; ++i)
        for (int k = 0; k < kRow; ++k) {
            const double x = -1 + (i + 0.2) * kStep, z = -1 + (k + 0.2) * kStep;
            addRectangle(mesh, rectangle(x, x + kSheet, z, z + kSheet, 1));
            lit -= F(2 * x, 2 * (x + kSheet), 2 * z, 2 * (z + kSheet));
        }
    const PointView view(Blockers(mesh), {0, 0, 0}, {0, 1, 0}, 0);
    std::vector<PointView::Polygon> parts;
    EXPECT_NEAR(view.factor(rectangle(-2, 2, -2, 2, 2), parts), lit, 1e-12);
    EXPECT_LE(parts.size(), 620u); // 594; by one sheet after the other in their order 683
}

TEST(ViewCells, of_slivers_have_shares_that_are_numbers) {
    const dvec3 up(0, 0, 1);
    const auto weightsOf = [&](double height) {
        double sum = 0;
        const std::array<dvec3, 3> corners{dvec3(-1, 0, 1), dvec3(1, 0, 1), dvec3(0, height, 1)};
        forCells(corners, up, 0.2, [&](dvec3, double weight) { sum += weight; });
        return sum;
    };
    const double sliver = weightsOf(1e-60);
    EXPECT_GT(sliver, 0);
    EXPECT_LE(scaleOfCells(1e-17, sliver), 1);
    EXPECT_EQ(scaleOfCells(1e-17, 0), 0);
    const PointView view(Blockers(test::boxRoom({})), {0, 0, 0}, up, 0);
    const double factor = view.unhinderedFactor(std::array{dvec3(-1, 0, 1), dvec3(1, 0, 1), dvec3(0, 1, 1)});
    EXPECT_NEAR(scaleOfCells(factor, weightsOf(1)), 0.5, 0.01);
}

TEST(PointView, what_lies_below_the_horizon_is_cut_off) {
    const geometry::PatchMesh mesh = test::boxRoom({});
    const Blockers blockers(mesh);
    // A wall at unit distance, half of it below: the upper half alone (Howell, B-4).
    const PointView view(blockers, {2, 1, 2}, {0, 1, 0}, 0);
    const std::vector<dvec3> wall{{1, 0, 3}, {3, 0, 3}, {3, 3, 3}, {1, 3, 3}};
    const double r = std::sqrt(1 + 4.0);
    EXPECT_NEAR(view.factor(wall), 2 * (std::atan(1.0) - std::atan(1 / r) / r) / (2 * std::numbers::pi),
                1e-14);
}

TEST(PointView, a_box_seen_from_any_place_adds_up_to_one) {
    const geometry::PatchMesh mesh = roomWithSheet(-1, 1, -0.7, 1.3);
    const PointScene scene(mesh);
    std::vector<Sensor> sensors;
    for (double x : {-2.9, -1.0, 0.0, 0.123, 2.0})
        for (double y : {0.0, 0.3, 1.4})
            sensors.push_back({{x, y, 0.37 * x}, glm::normalize(dvec3(0.1 * x, 1, 0.2))});
    const SensorGather gather =
        gatherSensors(scene, PatchSlopes(mesh), SlatLobes(scene, GlowingBlinds(mesh), {}), {}, sensors, 1);
    for (size_t s = 0; s < sensors.size(); ++s) {
        double even = 0, smooth = 0;
        for (size_t j = 0; j < mesh.patchCount(); ++j) {
            even += gather.even[s * mesh.patchCount() + j];
            smooth += gather.smooth[s * mesh.patchCount() + j];
        }
        // The sheet's back gives nothing, and tilted places on the floor lose what dips below it.
        EXPECT_LE(even, 1 + 1e-5);
        EXPECT_NEAR(smooth, even, 1e-5); // slopes of constant light are zero
    }
}

TEST(PointView, meshed_walls_block_as_few_polygons_however_rounding_scatters_their_edges) {
    const geometry::Building cornell = geometry::importModel(
        HELIODON_TEST_DATA "/compute/daylight/a2_cornell/model.obj", geometry::UpAxis::z);
    for (size_t triangles : {500, 1000, 1500, 2000, 2500, 3000}) // five faces on each of two boxes
        EXPECT_EQ(Blockers(geometry::meshBuilding(cornell, {triangles})).regions().size(), 10u) << triangles;
}

TEST(PointView, points_outside_are_in_no_room) {
    const geometry::PatchMesh mesh = test::boxRoom({});
    EXPECT_EQ(roomOfPoint(mesh, {2, 1, 2}, {0, 1, 0}), 0u);
    EXPECT_EQ(roomOfPoint(mesh, {2, 0, 2}, {0, 1, 0}), 0u); // on the floor
    EXPECT_EQ(roomOfPoint(mesh, {-1, 1, 2}, {1, 0, 0}), geometry::kNoRoom);
    EXPECT_EQ(roomOfPoint(mesh, {2, -1, 2}, {0, 1, 0}), geometry::kNoRoom);
    EXPECT_EQ(roomOfPoint(mesh, {9, 9, 9}, {0, 1, 0}), geometry::kNoRoom);
}

TEST(RoomOfPoint, a_wall_without_thickness_counts_on_the_side_that_is_seen) {
    const geometry::PatchMesh mesh = test::twoRooms(false); // share z = 5
    for (const double slant : {0.0, 0.4, -0.7}) {
        EXPECT_EQ(roomOfPoint(mesh, {2.1, 1.3, 4.5}, glm::normalize(glm::dvec3(slant, 0.1, 1))), 0u);
        EXPECT_EQ(roomOfPoint(mesh, {2.1, 1.3, 5.5}, glm::normalize(glm::dvec3(slant, 0.1, -1))), 1u);
    }
}

} // namespace
} // namespace heliodon::compute
