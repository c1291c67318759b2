// Normals of curved walls, against the arc.
#include "geometry/corner_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <gtest/gtest.h>

using namespace heliodon::geometry;

namespace {

// Facets of an arc round the y axis, looking in, each divided into `across` by 3 rectangles, these along
// diagonals at random; without the rectangles that `hole` names by facet, column and row.
struct Arc {
    PatchMesh mesh;
    std::vector<double> angle; // per corner: where its vertex lies between the folds, as on the arc
};

Arc arcOf(int facets, double degrees, int across, auto&& hole) {
    const double step = degrees * std::numbers::pi / 180;
    Arc out;
    std::mt19937 random(7);
    const int columns = facets * across + 1;
    std::vector<double> at;
    for (int c = 0; c < columns; ++c) {
        const int facet = std::min(c / across, facets - 1);
        const double part = static_cast<double>(c - facet * across) / across, from = facet * step;
        const glm::dvec2 a(std::cos(from), std::sin(from)), b(std::cos(from + step), std::sin(from + step));
        const glm::dvec2 p = 3.0 * glm::mix(a, b, part);
        at.push_back(from + part * step);
        for (int row = 0; row < 4; ++row) out.mesh.vertices.emplace_back(p.x, 0.7 * row, p.y);
    }
    out.mesh.materials.emplace_back();
    for (int c = 0; c + 1 < columns; ++c)
        for (uint32_t row = 0; row < 3; ++row) {
            if (hole(c / across, c % across, static_cast<int>(row))) continue;
            const auto v = [&](uint32_t right, uint32_t up) {
                return (static_cast<uint32_t>(c) + right) * 4 + row + up;
            };
            const bool other = random() % 2 == 0;
            for (const auto& t : {std::array{v(0, 0), v(1, 0), other ? v(0, 1) : v(1, 1)},
                                  std::array{v(1, 1), v(0, 1), other ? v(1, 0) : v(0, 0)}}) {
                out.mesh.addPatch(t, 0, Role::projection, 0, 0);
                for (const uint32_t vertex : t) out.angle.push_back(at[vertex / 4]);
            }
        }
    return out;
}

void expectOnArc(const Arc& arc) {
    const std::vector<glm::dvec3> normals = cornerNormals(arc.mesh);
    ASSERT_EQ(normals.size(), arc.mesh.corners.size());
    const double side = glm::dot(patchNormal(arc.mesh, 0), glm::dvec3(-1, 0, 0)) > 0 ? -1 : 1;
    for (size_t c = 0; c < normals.size(); ++c) {
        const glm::dvec3 exact = side * glm::dvec3(std::cos(arc.angle[c]), 0, std::sin(arc.angle[c]));
        EXPECT_LT(glm::length(normals[c] - exact), 1e-6)
            << "corner " << c << " at " << arc.angle[c] * 180 / std::numbers::pi << " degrees";
    }
}

// Upright rectangles from point to point, looking in.
PatchMesh wallAlong(std::span<const glm::dvec2> points) {
    PatchMesh mesh;
    mesh.materials.emplace_back();
    for (const glm::dvec2 p : points)
        for (const double y : {0.0, 2.5}) mesh.vertices.emplace_back(p.x, y, p.y);
    for (uint32_t v = 0; v + 3 < mesh.vertices.size(); v += 2)
        mesh.addPatch(std::array{v, v + 2, v + 3, v + 1}, 0, Role::projection, 0, 0);
    return mesh;
}

double degreesBetween(glm::dvec3 a, glm::dvec3 b) {
    return std::acos(std::min(1.0, glm::dot(a, b))) * 180 / std::numbers::pi;
}

} // namespace

TEST(CornerNormals, are_those_of_the_arc_where_its_facets_are_uneven_and_it_ends_beside_their_circle) {
    std::vector<glm::dvec2> points;
    std::vector<double> angle;
    double at = 0;
    for (const double step : {0.0, 13.0, 13.0, 13.0, 13.0, 8.0, 8.0, 7.0}) angle.push_back(at += step);
    for (const double a : angle) {
        const double r = a == angle.front() || a == angle.back() ? 3 - 0.0105 : 3;
        points.push_back(r * glm::dvec2(std::cos(glm::radians(a)), std::sin(glm::radians(a))));
    }
    const PatchMesh mesh = wallAlong(points);
    const std::vector<glm::dvec3> normals = cornerNormals(mesh);
    ASSERT_EQ(normals.size(), mesh.corners.size());
    const double side = patchNormal(mesh, 0).x < 0 ? -1 : 1;
    for (size_t c = 0; c < normals.size(); ++c) {
        const double a = glm::radians(angle[mesh.corners[c] / 2]);
        EXPECT_LT(degreesBetween(normals[c], side * glm::dvec3(std::cos(a), 0, std::sin(a))), 0.12)
            << angle[mesh.corners[c] / 2] << " degrees";
    }
}

TEST(CornerNormals, go_on_turning_at_no_end_that_is_straight) {
    std::vector<glm::dvec2> points;
    for (int k = 0; k <= 4; ++k) {
        const double a = glm::radians(12.0 * k);
        points.emplace_back(std::cos(a), std::sin(a));
    }
    const double last = glm::radians(48.0 + 6);
    for (const double length : {0.1, 0.2, 3.0}) {
        SCOPED_TRACE(length);
        std::vector<glm::dvec2> all = points;
        all.push_back(points.back() + length * glm::dvec2(-std::sin(last), std::cos(last)));
        const PatchMesh mesh = wallAlong(all);
        const std::vector<glm::dvec3> normals = cornerNormals(mesh);
        ASSERT_EQ(normals.size(), mesh.corners.size());
        for (size_t c = 16; c < 20; ++c)
            EXPECT_LT(degreesBetween(normals[c], patchNormal(mesh, 4)), 6 + 1e-6);
    }
}

TEST(CornerNormals, are_those_of_the_arc_however_facets_are_divided) {
    for (const int across : {1, 2, 5}) {
        SCOPED_TRACE(across);
        expectOnArc(arcOf(8, 15, across, [](int, int, int) { return false; }));
    }
}

TEST(CornerNormals, of_a_wall_with_a_hole_are_those_of_the_wall) {
    expectOnArc(arcOf(6, 12, 3, [](int facet, int column, int row) {
        return row == 1 && ((facet == 2 && column == 2) || (facet == 3 && column == 0));
    }));
    expectOnArc(arcOf(6, 12, 2, [](int facet, int, int row) { return facet == 3 && row == 0; }));
}

TEST(CornerNormals, of_a_sphere_are_within_its_facets) {
    PatchMesh mesh;
    mesh.materials.emplace_back();
    const int around = 24, high = 9;
    for (int r = 0; r <= high; ++r)
        for (int a = 0; a < around; ++a) {
            const double up = std::numbers::pi * (r - 4.5) / 12, turn = 2 * std::numbers::pi * a / around;
            mesh.vertices.emplace_back(std::cos(up) * std::cos(turn), std::sin(up),
                                       std::cos(up) * std::sin(turn));
        }
    for (uint32_t r = 0; r < high; ++r)
        for (uint32_t a = 0; a < around; ++a) {
            const uint32_t b = (a + 1) % around, low = r * around, up = low + around;
            mesh.addPatch(std::array{low + a, low + b, up + b}, 0, Role::projection, 0, 0);
            mesh.addPatch(std::array{low + a, up + b, up + a}, 0, Role::projection, 0, 0);
        }
    const std::vector<glm::dvec3> normals = cornerNormals(mesh);
    ASSERT_EQ(normals.size(), mesh.corners.size());
    for (size_t c = 0; c < normals.size(); ++c) {
        const glm::dvec3 exact = glm::normalize(mesh.vertices[mesh.corners[c]]);
        const bool rim = mesh.corners[c] < around || mesh.corners[c] >= high * around;
        EXPECT_GT(std::abs(glm::dot(normals[c], exact)),
                  std::cos((rim ? 9.0 : 1.5) * std::numbers::pi / 180));
    }
}

TEST(CornerNormals, are_none_where_all_is_flat) {
    PatchMesh mesh;
    mesh.materials.emplace_back();
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 1}, {1, 1, 1}};
    mesh.addPatch(std::array{0u, 1u, 2u, 3u}, 0, Role::projection, 0, 0);
    mesh.addPatch(std::array{1u, 4u, 5u, 2u}, 0, Role::projection, 1, 0);
    EXPECT_TRUE(cornerNormals(mesh).empty());
}
