// Floor and wall that share a row of vertices.
#include "geometry/spare_vertices.h"

#include <gtest/gtest.h>

using namespace heliodon::geometry;

namespace {

constexpr uint32_t kSteps = 6; // along the row: vertices 3 k + 1 at (k, 0, 0)

// The floor's other side at z = 1: vertices 3 k; the wall's at y = 1: 3 k + 2.
PatchMesh floorAndWall(bool wall = true) {
    PatchMesh mesh;
    mesh.materials.emplace_back();
    for (uint32_t k = 0; k <= kSteps; ++k)
        for (const glm::dvec3 p : {glm::dvec3(0, 0, 1), glm::dvec3(0), glm::dvec3(0, 1, 0)})
            mesh.vertices.push_back(p + glm::dvec3(k, 0, 0));
    for (uint32_t k = 0; k < kSteps; ++k)
        for (uint32_t s = 0; s < (wall ? 2 : 1); ++s) {
            const uint32_t a = 3 * k + s, b = a + 3;
            mesh.addPatch(std::array{a, b, b + 1}, 0, Role::projection, s, 0);
            mesh.addPatch(std::array{a, b + 1, a + 1}, 0, Role::projection, s, 0);
        }
    return mesh;
}

// Lets a line end on the row `at` steps from its beginning.
void cut(FlatPart& part, const PatchMesh& mesh, double at) {
    for (size_t e = 0; e < part.border.size(); ++e) {
        const auto [a, b] = part.borderEdge(e);
        if (a % 3 != 1 || b % 3 != 1) continue;
        const double from = mesh.vertices[a].x, to = mesh.vertices[b].x, t = (at - from) / (to - from);
        if (t < 0 || t > 1) continue;
        part.cuts.push_back({CutEnd{{}, static_cast<int>(e), t}, CutEnd{}});
        return;
    }
    FAIL() << "no such place";
}

std::vector<uint32_t> spareWith(const PatchMesh& mesh, std::vector<double> onFloor,
                                std::vector<double> onWall = {}) {
    std::vector<FlatPart> parts = flatParts(mesh);
    for (const double at : onFloor) cut(parts[0], mesh, at);
    for (const double at : onWall) cut(parts[1], mesh, at);
    std::vector<uint32_t> out;
    const std::vector<bool> spare = spareVertices(parts, mesh.vertices);
    for (uint32_t v = 0; v < spare.size(); ++v)
        if (spare[v]) out.push_back(v);
    return out;
}

using Vertices = std::vector<uint32_t>;

} // namespace

TEST(SpareVertices, make_way_for_a_cut_beside_them) {
    const PatchMesh mesh = floorAndWall();
    EXPECT_EQ(spareWith(mesh, {}), Vertices{});
    EXPECT_EQ(spareWith(mesh, {2.8}), Vertices{10});
    EXPECT_EQ(spareWith(mesh, {}, {3.2}), Vertices{10});
    EXPECT_EQ(spareWith(mesh, {2.6}), Vertices{}); // 1.4 steps to the next one
    EXPECT_EQ(spareWith(mesh, {2.6}, {3.5}), Vertices{10});
}

TEST(SpareVertices, stay_where_a_line_ends_and_at_corners) {
    const PatchMesh mesh = floorAndWall();
    EXPECT_EQ(spareWith(mesh, {2.8, 3.0}), Vertices{});
    EXPECT_EQ(spareWith(mesh, {0.1}), Vertices{});
    PatchMesh floor = floorAndWall(false);
    EXPECT_EQ(spareWith(floor, {2.8}), Vertices{10});
    floor.vertices[10].z = 0.01;
    EXPECT_EQ(spareWith(floor, {2.8}), Vertices{});
}

// Between two that go there is a cut.
TEST(SpareVertices, do_not_leave_two_at_a_time) {
    EXPECT_EQ(spareWith(floorAndWall(), {1.9}, {4.1, 3.1}), (Vertices{7, 13}));
    EXPECT_EQ(spareWith(floorAndWall(), {2.8, 4.2}), (Vertices{10}));
    EXPECT_EQ(spareWith(floorAndWall(), {2.8, 4.2}, {3.5}), (Vertices{10, 13}));
}
