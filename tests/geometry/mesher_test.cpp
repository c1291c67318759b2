#include "geometry/mesher.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <gtest/gtest.h>

#include "geometry/mesh_domains.h"
#include "geometry/segment_distance.h"

using namespace heliodon::geometry;

namespace {

Sketch sketchOf(const std::string& name) {
    return readSketch(std::string(HELIODON_TEST_DATA "/geometry/sketches/") + name);
}

Building closed(const Sketch& sketch, const ClosureOptions& options = {}) {
    Closure closure = closeSketch(sketch, options);
    EXPECT_TRUE(closure.building) << closure.report.message;
    return std::move(*closure.building);
}

Building buildingOf(const std::string& name) {
    return closed(sketchOf(name));
}

// Facets of curved walls as the program makes them for so many triangles.
ClosureOptions fittedTo(const Sketch& sketch, size_t wanted) {
    ClosureOptions options;
    options.facetLength = fittingFacet(surfaceOfRooms(sketch), {wanted});
    options.coarseChord = 0.06;
    return options;
}

double faceArea(const Building& building) {
    double sum = 0;
    for (const Face& face : building.faces) {
        glm::dvec3 twice{0};
        for (const auto& loop : face.loops)
            for (size_t i = 0; i < loop.size(); ++i)
                twice +=
                    glm::cross(building.vertices[loop[i]], building.vertices[loop[(i + 1) % loop.size()]]);
        sum += 0.5 * glm::length(twice);
    }
    return sum;
}

void expectNoTVertices(const PatchMesh& mesh) {
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const auto corner = mesh.patch(i);
        for (size_t k = 0; k < corner.size(); ++k) ++edges[{corner[k], corner[(k + 1) % corner.size()]}];
    }
    for (const auto& [edge, count] : edges) {
        ASSERT_EQ(count, 1);
        ASSERT_TRUE(edges.contains({edge.second, edge.first}));
    }
}

} // namespace

TEST(Mesher, what_is_thrown_before_a_part_ends_the_work) {
    const Building building = buildingOf("p04_L.json");
    for (const int parts : {0, 1, 20}) {
        int left = parts;
        const auto stop = [&] {
            if (left-- == 0) throw std::invalid_argument("enough");
        };
        EXPECT_THROW(meshBuilding(building, {2000, stop}), std::invalid_argument) << parts;
    }
}

class MeshOfSketch : public testing::TestWithParam<std::string> {};

TEST_P(MeshOfSketch, closes_keeps_the_area_and_is_about_as_fine_as_asked) {
    const Building building = buildingOf(GetParam());
    const bool curved = GetParam() == "p09_D_curved.json" || GetParam() == "i01_mixed.sketch.json";
    for (const size_t wanted : {600u, 2000u, 10000u}) {
        const PatchMesh mesh = meshBuilding(building, {wanted});
        expectNoTVertices(mesh);
        double area = 0;
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            area += patchArea(mesh, i);
            ASSERT_GT(patchArea(mesh, i), 0);
        }
        // Triangles over the fold of two facets cut the corner: by the square of the turn, 1e-3 at most here.
        EXPECT_NEAR(area, faceArea(building), (curved ? 1e-3 : 1e-9) * area);
        EXPECT_NEAR(static_cast<double>(mesh.patchCount()), static_cast<double>(wanted),
                    (wanted < 1000 ? 0.04 : 0.03) * static_cast<double>(wanted));
    }
}

INSTANTIATE_TEST_SUITE_P(Sketches, MeshOfSketch,
                         testing::Values("p01_rect_tight.json", "p04_L.json", "p05_T_two_rooms.json",
                                         "p06_U.json", "p08_cubicle.json", "p09_D_curved.json",
                                         "i01_mixed.sketch.json", "i02_pinwheel.sketch.json"));

// The targets: angles of 36 degrees, as of gmsh's frontal mesher, which reaches 36.1 on the L-shaped room
// (pmp-library 22.3), but here in every room; areas with a deviation of 0.13 at 2000 and 0.09 at 10,000.
// Rooms with cracks, steps of half an inch or partitions need a few smaller triangles, and get what was
// measured for them. Builds of other optimisation round otherwise, and now and then mesh otherwise: that is
// within these limits.
struct RoomQuality {
    std::string sketch;
    double minAngle, deviation2000, deviation10000;
};

class MeshQualityOf : public testing::TestWithParam<RoomQuality> {};

TEST_P(MeshQualityOf, angles_are_large_and_areas_alike) {
    const Sketch sketch = sketchOf(GetParam().sketch);
    for (const size_t wanted : {2000u, 10000u}) {
        const Building building = closed(sketch, fittedTo(sketch, wanted));
        const MeshQuality quality = measureMesh(meshBuilding(building, {wanted}));
        printf("%s %zu: %zu triangles, %.1f degrees (%.1f with %zu in strips), deviation %.3f\n",
               GetParam().sketch.c_str(), wanted, quality.triangles, quality.minAngleDeg,
               quality.minAngleAllDeg, quality.stripTriangles, quality.areaDeviation);
        EXPECT_GE(quality.minAngleDeg, GetParam().minAngle);
        EXPECT_LE(quality.areaDeviation,
                  wanted == 2000 ? GetParam().deviation2000 : GetParam().deviation10000);
        EXPECT_NEAR(static_cast<double>(quality.triangles), static_cast<double>(wanted),
                    0.03 * static_cast<double>(wanted));
    }
}

INSTANTIATE_TEST_SUITE_P(Sketches, MeshQualityOf,
                         testing::Values(RoomQuality{"p01_rect_tight.json", 36, 0.13, 0.09},
                                         RoomQuality{"p02_rect_gaps.json", 36, 0.13, 0.09},
                                         RoomQuality{"p03_rect_overlap.json", 36, 0.13, 0.09},
                                         RoomQuality{"p04_L.json", 36, 0.13, 0.09},
                                         RoomQuality{"p05_T_two_rooms.json", 36, 0.13, 0.09},
                                         RoomQuality{"p06_U.json", 36, 0.13, 0.09},
                                         RoomQuality{"p07_cross.json", 36, 0.13, 0.09},
                                         RoomQuality{"p08_cubicle.json", 36, 0.13, 0.09},
                                         RoomQuality{"p09_D_curved.json", 36, 0.13, 0.09},
                                         RoomQuality{"p10_window_over_joint.json", 36, 0.13, 0.09},
                                         RoomQuality{"p11_two_buildings.json", 36, 0.13, 0.09},
                                         RoomQuality{"three_arcs.json", 36, 0.13, 0.09},
                                         RoomQuality{"i01_mixed.sketch.json", 36, 0.235, 0.09},
                                         RoomQuality{"i02_pinwheel.sketch.json", 35.5, 0.25, 0.09}));

// Where edges are many and equally long, as uprights are, the count would jump past what was asked for.
TEST(Mesher, few_triangles_are_as_many_as_asked_where_edges_are_alike) {
    const Building building = buildingOf("walls20.json");
    for (const size_t wanted : {280u, 300u, 320u}) {
        const PatchMesh mesh = meshBuilding(building, {wanted});
        expectNoTVertices(mesh);
        EXPECT_NEAR(static_cast<double>(mesh.patchCount()), static_cast<double>(wanted),
                    0.03 * static_cast<double>(wanted));
    }
}

// Thin partitions on all sides: 0.80 where triangles were as small as these are narrow, and all others large.
TEST(Mesher, thin_walls_do_not_take_triangles_from_all_others) {
    const MeshQuality quality = measureMesh(meshBuilding(buildingOf("walls20.json"), {2000}));
    EXPECT_LE(quality.areaDeviation, 0.45);
    EXPECT_NEAR(static_cast<double>(quality.triangles), 2000, 60);
}

// A slot of 0.17 in: with steps four times its width beside it the angles were 32.7 degrees.
TEST(Mesher, slots_nearly_half_an_edge_wide_leave_angles_large) {
    const MeshQuality quality = measureMesh(meshBuilding(buildingOf("i02_pinwheel.sketch.json"), {5000}));
    EXPECT_GE(quality.minAngleDeg, 35);
    EXPECT_LE(quality.areaDeviation, 0.16);
}

// A box with a wall of six faces, two of them slivers: what lies in one plane is meshed as one.
TEST(Mesher, seams_between_faces_of_one_plane_leave_no_trace) {
    Building box;
    const std::vector<double> splits{0, 0.01, 0.3, 0.3001, 1, 1.7, 2};
    for (const double z : {0.0, 1.0})
        for (const double y : {0.0, 1.0})
            for (const double x : splits) box.vertices.emplace_back(x, y, z);
    const auto at = [&](size_t x, int y, int z) {
        return static_cast<uint32_t>(x + splits.size() * static_cast<size_t>(y + 2 * z));
    };
    const auto add = [&](std::vector<uint32_t> loop, uint32_t surface) {
        Face face;
        face.loops = {std::move(loop)};
        face.surface = surface;
        box.faces.push_back(std::move(face));
    };
    const size_t last = splits.size() - 1;
    for (size_t x = 0; x < last; ++x) { // floor, ceiling, and the two long walls; normals inwards
        add({at(x, 0, 0), at(x, 0, 1), at(x + 1, 0, 1), at(x + 1, 0, 0)}, 0);
        add({at(x, 1, 0), at(x + 1, 1, 0), at(x + 1, 1, 1), at(x, 1, 1)}, 1);
        add({at(x, 0, 0), at(x + 1, 0, 0), at(x + 1, 1, 0), at(x, 1, 0)}, 2);
        add({at(x, 0, 1), at(x, 1, 1), at(x + 1, 1, 1), at(x + 1, 0, 1)}, 3);
    }
    add({at(0, 0, 0), at(0, 1, 0), at(0, 1, 1), at(0, 0, 1)}, 4);
    add({at(last, 0, 0), at(last, 0, 1), at(last, 1, 1), at(last, 1, 0)}, 5);
    box.materials.emplace_back();
    box.roomCount = 1;
    const PatchMesh mesh = meshBuilding(box, {1000});
    expectNoTVertices(mesh);
    const MeshQuality quality = measureMesh(mesh);
    EXPECT_GT(quality.minAngleAllDeg, 36);
    EXPECT_LT(quality.areaDeviation, 0.16);
    double area = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) area += patchArea(mesh, i);
    EXPECT_NEAR(area, 10, 1e-9);
}

TEST(Mesher, normals_point_into_the_air_of_curved_walls_too) {
    const PatchMesh mesh = meshBuilding(buildingOf("p09_D_curved.json"));
    const glm::dvec3 middle(0, 0.127, 0);
    double volume = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const double height = glm::dot(middle - patchCentroid(mesh, i), patchNormal(mesh, i));
        EXPECT_GT(height, 0) << i; // the room is convex
        volume += patchArea(mesh, i) * height / 3;
    }
    EXPECT_NEAR(volume / std::pow(kMetresPerInch, 3), 1671.39,
                0.005 * 1671.39); // chords: 0.13 %, folds cut a little more
}

TEST(Mesher, glasses_of_an_interior_window_have_mirrored_triangles) {
    const PatchMesh mesh = meshBuilding(buildingOf("p05_T_two_rooms.json"));
    size_t twins = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        if (mesh.twin[i] == kNoTwin) continue;
        ++twins;
        const auto j = static_cast<size_t>(mesh.twin[i]);
        ASSERT_EQ(mesh.twin[j], static_cast<int32_t>(i));
        EXPECT_NE(mesh.room[i], mesh.room[j]);
        // Across the wall's thickness, 0.375 in, straight.
        EXPECT_NEAR(glm::length(patchCentroid(mesh, i) - patchCentroid(mesh, j)), 0.375 * kMetresPerInch,
                    1e-9);
        EXPECT_NEAR(patchArea(mesh, i), patchArea(mesh, j), 1e-12);
        EXPECT_NEAR(glm::dot(patchNormal(mesh, i), patchNormal(mesh, j)), -1, 1e-12);
    }
    EXPECT_GT(twins, 10u);
}

// A picture window (1 to 8 ft) with a standard one (3 to 7 ft) over it, narrower or wider: a ring, or a piece
// above and a piece below.
TEST(Mesher, windows_over_one_another_in_an_interior_wall_are_mirrored_piece_by_piece) {
    for (const double width : {2.0, 6.0}) {
        Sketch sketch = readSketch(HELIODON_TEST_DATA "/geometry/sketches/p05_T_two_rooms.json");
        const auto inner = std::ranges::find(sketch.windows, "w5", &WindowMarker::wall);
        ASSERT_NE(inner, sketch.windows.end());
        WindowMarker picture = *inner, standard = picture;
        picture.id = "picture";
        picture.kind = WindowKind::picture;
        picture.width = 4;
        standard.id = "standard";
        standard.kind = WindowKind::standard;
        standard.width = width;
        sketch.windows = {picture, standard};
        const Closure closure = closeSketch(sketch);
        ASSERT_TRUE(closure.building) << closure.report.message;
        const PatchMesh mesh = meshBuilding(*closure.building);
        double area = 0;
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            if (mesh.twin[i] == kNoTwin) continue;
            area += patchArea(mesh, i);
            EXPECT_NEAR(
                glm::length(patchCentroid(mesh, i) - patchCentroid(mesh, static_cast<size_t>(mesh.twin[i]))),
                0.375 * kMetresPerInch, 1e-9);
        }
        // Both sides; the picture window and what the standard one has beside it.
        EXPECT_NEAR(area / (kMetresPerInch * kMetresPerInch), 2 * (4 * 7 + std::max(0.0, width - 4) * 4),
                    1e-6);
        expectNoTVertices(mesh);
    }
}

// Partitions against it divide the edges between its facets; six rooms, a door, walls that cross.
TEST(Mesher, curved_wall_with_partitions_against_it_is_meshed) {
    const Building building = buildingOf("arc_with_partitions.json");
    const PatchMesh mesh = meshBuilding(building, {3000});
    expectNoTVertices(mesh);
    double area = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) area += patchArea(mesh, i);
    EXPECT_NEAR(area, faceArea(building), 1e-3 * area); // folds, as above
}

// A round column in the room, 0.79 in of radius where triangles have edges of 1.2 and 2.4 in: none may cut
// through it.
TEST(Mesher, a_column_thinner_than_the_triangles_keeps_its_shape) {
    Sketch sketch = readSketch(HELIODON_TEST_DATA "/geometry/sketches/p01_rect_tight.json");
    Arc column;
    column.id = "column";
    column.radius = 0.6;
    column.a1Deg = 360;
    sketch.arcs = {column};
    const Closure closure = closeSketch(sketch);
    ASSERT_TRUE(closure.building) << closure.report.message;
    for (const size_t wanted : {500u, 2000u}) {
        const PatchMesh mesh = meshBuilding(*closure.building, {wanted});
        expectNoTVertices(mesh);
        double volume = 0;
        for (size_t i = 0; i < mesh.patchCount(); ++i)
            volume -= glm::dot(0.5 * patchAreaVector(mesh, i), patchCentroid(mesh, i)) / 3;
        const double whole = closure.report.rooms[0].volumeFt3;
        EXPECT_NEAR(volume / std::pow(kMetresPerInch, 3), whole, 5e-4 * whole)
            << wanted; // narrow facets by twos
    }
}

// How deep a mesh lies in the solids of curved walls at the middle of its edges, and how far from their
// facets at all: metres.
std::pair<double, double> offFacets(const PatchMesh& mesh, const Building& building) {
    struct Facet {
        glm::dvec2 from, to, normal;
    };
    std::multimap<uint32_t, Facet> plan; // by surface
    for (const Face& face : building.faces) {
        const glm::dvec3 n = faceNormal(building, face), from = building.vertices[face.loops[0][0]];
        if (std::abs(n.y) > 1e-9) continue;
        const auto squareTo = [&](uint32_t v) {
            const glm::dvec3 d = building.vertices[v] - from;
            return d.x * d.x + d.z * d.z;
        };
        const glm::dvec3 to = building.vertices[*std::ranges::max_element(face.loops[0], {}, squareTo)];
        plan.emplace(face.surface, Facet{{from.x, from.z}, {to.x, to.z}, {n.x, n.z}});
    }
    double deepest = 0, farthest = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        if (mesh.role[i] != Role::projection || std::abs(patchNormal(mesh, i).y) > 1e-9) continue;
        const auto corners = mesh.patch(i);
        for (size_t k = 0; k < 3; ++k) {
            const glm::dvec3 middle = 0.5 * (mesh.vertices[corners[k]] + mesh.vertices[corners[(k + 1) % 3]]);
            const glm::dvec2 p(middle.x, middle.z);
            double off = 1e300;
            bool inside = false;
            const auto [first, last] = plan.equal_range(mesh.surface[i]);
            for (auto at = first; at != last; ++at) {
                const Facet& facet = at->second;
                const double distance = distanceToSegment(p, facet.from, facet.to);
                if (distance >= off) continue;
                off = distance;
                inside = glm::dot(p - facet.from, facet.normal) < 0;
            }
            farthest = std::max(farthest, off);
            if (inside) deepest = std::max(deepest, off);
        }
    }
    return {deepest, farthest};
}

// Columns, walls that bend both ways, facets much narrower than the triangles elsewhere, partitions that end
// in curved walls, low arcs: no triangle lies deep in the wall's solids or cuts off a corner.
TEST(Mesher, triangles_of_curved_walls_lie_in_their_facets) {
    for (const char* name :
         {"round_column.json", "spiral.json", "s_curve.json", "i01_mixed.sketch.json", "three_arcs.json"})
        for (const bool fitted : {false, true}) {
            const Sketch sketch = sketchOf(name);
            const Building building = closed(sketch, fitted ? fittedTo(sketch, 2000) : ClosureOptions{});
            const auto [deep, off] = offFacets(meshBuilding(building), building);
            EXPECT_LT(deep, 2e-3) << name;
            EXPECT_LT(off, 3e-3) << name;
        }
}

// Of three circles through one another, which are in rooms on both their sides.
TEST(Mesher, large_triangles_do_not_lie_deep_in_curved_walls_either) {
    Sketch sketch;
    for (const glm::dvec2 center : {glm::dvec2(-4, 0), glm::dvec2(4, 0), glm::dvec2(0, 6)}) {
        Arc& ring = sketch.arcs.emplace_back();
        ring.id = "a" + std::to_string(sketch.arcs.size());
        ring.center = center;
        ring.radius = 8;
        ring.a1Deg = 360;
    }
    const size_t wanted = 500;
    ClosureOptions options = fittedTo(sketch, wanted);
    options.chordError = 0.32;
    const Building building = closed(sketch, options);
    EXPECT_LT(offFacets(meshBuilding(building, {wanted}), building).first, 2e-3);
}

// Half of the ring is bridged.
TEST(Mesher, gaps_of_a_ring_are_meshed_as_well_as_its_arcs) {
    Sketch sketch;
    for (const double from : {0.0, 120.0, 240.0}) {
        Arc& arc = sketch.arcs.emplace_back();
        arc.id = "a" + std::to_string(sketch.arcs.size());
        arc.radius = 10;
        arc.a0Deg = from;
        arc.a1Deg = from + 60;
    }
    const Building building = closed(sketch, fittedTo(sketch, 2000));
    EXPECT_LE(measureMesh(meshBuilding(building)).areaDeviation, 0.09);
}

// Half circles side by side, whose ends are filled up to where their inner faces meet.
TEST(Mesher, walls_of_a_lobed_room_have_no_strips_at_their_ends) {
    Sketch sketch;
    for (const double turn : {0.0, 72.0, 144.0, 216.0, 288.0}) {
        Arc& arc = sketch.arcs.emplace_back();
        arc.id = "a" + std::to_string(sketch.arcs.size());
        arc.radius = 4.5;
        const double angle = glm::radians(turn), out = arc.radius / std::tan(glm::radians(36.0));
        arc.center = out * glm::dvec2(std::cos(angle), std::sin(angle));
        arc.a0Deg = turn - 90;
        arc.a1Deg = turn + 90;
    }
    const MeshQuality quality = measureMesh(meshBuilding(closed(sketch, fittedTo(sketch, 2000))));
    EXPECT_EQ(quality.stripTriangles, 0u);
    EXPECT_GE(quality.minAngleDeg, 36);
    EXPECT_LE(quality.areaDeviation, 0.13);
}

// A room whose corners are arcs that begin 0.3 in from the walls, of facets that turn by 26 degrees.
TEST(Mesher, gaps_beside_round_corners_are_no_strips) {
    Sketch sketch;
    for (int k = 0; k < 4; ++k) {
        const double turn = 90.0 * k, c = std::cos(glm::radians(turn)), s = std::sin(glm::radians(turn));
        const auto turned = [&](double x, double y) { return glm::dvec2(c * x - s * y, s * x + c * y); };
        Wall& wall = sketch.walls.emplace_back();
        wall.id = "w" + std::to_string(k);
        wall.a = turned(8, -6.55);
        wall.b = turned(8, 6.55);
        Arc& arc = sketch.arcs.emplace_back();
        arc.id = "a" + std::to_string(k);
        arc.center = turned(6.7, 6.7);
        arc.radius = 1.3;
        arc.a0Deg = turn + 6.6;
        arc.a1Deg = turn + 83.4;
    }
    const MeshQuality quality = measureMesh(meshBuilding(closed(sketch, fittedTo(sketch, 2000))));
    EXPECT_LE(quality.stripTriangles, 20u); // 184 if they were
}

TEST(Mesher, surface_of_rooms_is_known_before_they_are_closed) {
    for (const char* name : {"p08_cubicle.json", "p09_D_curved.json", "i01_mixed.sketch.json",
                             "three_arcs.json", "arc_with_partitions.json"}) {
        const Sketch sketch = readSketch(std::string(HELIODON_TEST_DATA "/geometry/sketches/") + name);
        const double exact = faceArea(*closeSketch(sketch).building);
        EXPECT_NEAR(surfaceOfRooms(sketch), exact, 0.02 * exact) << name;
        ClosureOptions coarse;
        coarse.chordError = 0.06;
        EXPECT_NEAR(surfaceOfRooms(sketch, coarse), exact, 0.02 * exact) << name;
    }
    EXPECT_EQ(surfaceOfRooms(Sketch{}), 0);
}

TEST(Mesher, facets_of_one_arc_are_one_surface) {
    const Building building = buildingOf("p09_D_curved.json");
    const PatchMesh mesh = meshBuilding(building);
    EXPECT_EQ(std::set<uint32_t>(mesh.surface.begin(), mesh.surface.end()).size(),
              7u); // 3 walls, arc, floor, ceiling, glass
}

// Round a body that touches a wall in one upright edge, a hair off it beside that, the floor comes back to a
// corner; a wall that the upper corner of such a body meets has a slit, as wide as rounding leaves it.
TEST(Mesher, outlines_that_touch_themselves_are_divided) {
    Building floor;
    floor.materials.resize(1);
    floor.vertices = {{-1.4597, 0, 3.8331}, {-1.3776, 0, 3.4487}, {-1.5865, 0, 4.426},  {1.3279, 0, 5.0489},
                      {1.5476, 0, 3.9285},  {-1.3485, 0, 3.3125}, {-0.6421, 0, 3.6059}, {-0.7242, 0, 3.9903}};
    floor.faces.emplace_back().loops = {{0, 1, 2, 3, 4, 5, 1, 6, 7}};
    Building wall;
    wall.materials.resize(1);
    wall.vertices = {{1.4959, 0.2523, -4.2817},
                     {1.4959, 2.7523, -4.2817},
                     {-3.14, 2.7523, -2.4085},
                     {-3.14, 0.2523, -2.4085},
                     {0.7653, 0.2523, -3.9865},
                     {0.7653, 1.9267, -3.9865},
                     {0.76530000000001097, 0.25230000867118052, -3.9864999999999728}};
    wall.faces.emplace_back().loops = {{2, 3, 1}};
    wall.faces.emplace_back().loops = {{3, 4, 5, 6, 0, 1}};
    for (const Building* building : {&floor, &wall})
        for (const size_t triangles : {20u, 300u}) {
            const PatchMesh mesh = meshBuilding(*building, {triangles});
            double area = 0;
            for (size_t i = 0; i < mesh.patchCount(); ++i) area += patchArea(mesh, i);
            EXPECT_NEAR(area, faceArea(*building), 1e-4);
        }
}

TEST(Mesher, an_outline_that_crosses_itself_is_refused_by_face) {
    Building building;
    building.materials.resize(1);
    building.vertices = {{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0},
                         {0, 1, 0}, {3, 1, 2}, {3, 1, 0}, {0, 1, 1}};
    building.faces.emplace_back().loops = {{0, 1, 2, 3}};
    building.faces.emplace_back().loops = {{4, 5, 6, 7}};
    building.faces[1].surface = 1;
    try {
        meshBuilding(building);
        FAIL() << "not refused";
    } catch (const MeshError& error) {
        EXPECT_EQ(error.face, 1u);
    }
}
