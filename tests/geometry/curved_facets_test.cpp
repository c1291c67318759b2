// Curved walls that other walls cut between two corners of their facets.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <set>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "geometry/building.h"
#include "geometry/mesh_domains.h"
#include "geometry/mesher.h"
#include "geometry/model_file.h"
#include "geometry/room_measures.h"
#include "geometry/sketch.h"
#include "tests/geometry/drawn_pieces.h"
#include "tests/geometry/mesh_volume.h"

using namespace heliodon::geometry;
using heliodon::test::wall;

namespace {

Arc arc(const char* id, glm::dvec2 center, double radius, double from, double to) {
    Arc out;
    out.id = id;
    out.center = center;
    out.radius = radius;
    out.a0Deg = from;
    out.a1Deg = to;
    return out;
}

ClosureOptions fittedOptions(const Sketch& sketch) {
    ClosureOptions options;
    options.facetLength = fittingFacet(surfaceOfRooms(sketch));
    options.coarseChord = 0.06;
    return options;
}

Sketch box(double width, double depth) {
    const double x = width / 2, y = depth / 2, h = 0.1875;
    Sketch sketch;
    const glm::dvec2 ends[4][2] = {{{-x - h, -y}, {x + h, -y}},
                                   {{x, -y - h}, {x, y + h}},
                                   {{x + h, y}, {-x - h, y}},
                                   {{-x, y + h}, {-x, -y - h}}};
    for (const auto& end : ends) {
        Wall& wall = sketch.walls.emplace_back();
        wall.id = "w" + std::to_string(sketch.walls.size());
        wall.a = end[0];
        wall.b = end[1];
    }
    return sketch;
}

MeshQuality qualityOf(const Sketch& sketch) {
    const Closure closure = closeSketch(sketch, fittedOptions(sketch));
    EXPECT_TRUE(closure.building) << closure.report.message;
    return measureMesh(meshBuilding(*closure.building));
}

// Two round rooms through one another: each arc is cut twice, at angles that fit no facet.
Sketch twoCircles() {
    Sketch sketch;
    sketch.arcs = {arc("left", {-4.3, 0.4}, 7, 0, 360), arc("right", {4.1, -0.7}, 8, 0, 360)};
    return sketch;
}

// Convex prisms of 36 indices: whether one of them holds the point.
bool inSolid(const Occluders& solids, glm::dvec3 p) {
    for (size_t first = 0; first < solids.triangles.size(); first += 36) {
        bool in = true;
        for (size_t i = first; in && i < first + 36; i += 3) {
            const auto corner = [&](size_t k) { return solids.vertices[solids.triangles[i + k]]; };
            in = glm::dot(glm::cross(corner(1) - corner(0), corner(2) - corner(0)), p - corner(0)) < 0;
        }
        if (in) return true;
    }
    return false;
}

} // namespace

TEST(CurvedFacets, are_even_between_the_walls_that_cut_them) {
    const Sketch sketch = twoCircles();
    const Closure closure = closeSketch(sketch, fittedOptions(sketch));
    ASSERT_TRUE(closure.building) << closure.report.message;
    ASSERT_EQ(closure.report.rooms.size(), 3u);
    // A surface is what one room sees of one wall in one piece.
    std::map<uint32_t, std::vector<double>> widths;
    for (const Face& face : closure.building->faces) {
        double width = 0, rise = 0;
        for (size_t k = 0; k < face.loops[0].size(); ++k) {
            const glm::dvec3 d = closure.building->vertices[face.loops[0][(k + 1) % face.loops[0].size()]] -
                                 closure.building->vertices[face.loops[0][k]];
            rise = std::max(rise, std::abs(d.y));
            width = std::max(width, std::hypot(d.x, d.z));
        }
        if (rise > 0) widths[face.surface].push_back(width);
    }
    ASSERT_GE(widths.size(), 4u);
    for (const auto& [surface, all] : widths) {
        const auto [least, most] = std::ranges::minmax(all);
        EXPECT_GT(least, 0.97 * most) << surface;
    }
}

// Wherever a low wall ends on a curved one: a fold a hair beside its side would leave a sliver of the wall.
TEST(CurvedFacets, have_no_folds_beside_the_sides_of_partitions) {
    for (const bool ring : {false, true})
        for (double at = 20; at < 160; at += 7) {
            Sketch sketch;
            sketch.arcs = {arc("round", {0, 0}, 8, 0, ring ? 360 : 180)};
            if (!ring) sketch.walls.push_back(wall("straight", {-8.2, 0}, {8.2, 0}));
            const double angle = at * std::numbers::pi / 180;
            const glm::dvec2 end(8 * std::cos(angle), 8 * std::sin(angle));
            sketch.walls.push_back(wall("low", 0.5 * end, end, HeightClass::green));
            const Closure closure = closeSketch(sketch, fittedOptions(sketch));
            ASSERT_TRUE(closure.building) << closure.report.message;
            double shortest = 1e300; // inches
            for (const Face& face : closure.building->faces)
                for (size_t k = 0, n = face.loops[0].size(); k < n; ++k)
                    shortest = std::min(shortest,
                                        glm::length(closure.building->vertices[face.loops[0][(k + 1) % n]] -
                                                    closure.building->vertices[face.loops[0][k]]) /
                                            kMetresPerInch);
            EXPECT_GT(shortest, 0.3) << at << (ring ? " degrees of a ring" : " degrees");
        }
}

// Corridors between two arcs, closed at both ends: facets a fifth shorter there left no room for columns, and
// what projectors see took 2.5 times as long to mesh in triangles that lean across the folds.
TEST(CurvedFacets, even_ones_take_upright_triangles) {
    int leaning = 0;
    for (const double sweep : {110.0, 120.0, 130.0, 140.0}) {
        Sketch sketch;
        sketch.arcs = {arc("outer", {0, 0}, 13, 0, sweep), arc("inner", {0, 0}, 10, 0, sweep)};
        for (const double angle : {0.0, sweep * std::acos(-1.0) / 180}) {
            Wall& wall = sketch.walls.emplace_back();
            wall.id = "end" + std::to_string(sketch.walls.size());
            const glm::dvec2 outwards(std::cos(angle), std::sin(angle));
            wall.a = 9.9 * outwards;
            wall.b = 13.1 * outwards;
        }
        const Closure closure = closeSketch(sketch, fittedOptions(sketch));
        ASSERT_TRUE(closure.building) << closure.report.message;
        const PatchMesh mesh = meshBuilding(*closure.building);
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            const double up = std::abs(patchNormal(mesh, i).y);
            leaning += std::abs(up - std::round(up)) > 1e-9;
        }
    }
    EXPECT_EQ(leaning, 0);
}

// A wall that cuts an arc 0.24 in behind a corner left 24.8 degrees and 0.19 before.
TEST(CurvedFacets, even_ones_leave_no_slivers_in_the_mesh) {
    const Sketch sketch = readSketch(HELIODON_TEST_DATA "/geometry/sketches/s_curve.json");
    const Closure closure = closeSketch(sketch, fittedOptions(sketch));
    ASSERT_TRUE(closure.building) << closure.report.message;
    const MeshQuality quality = measureMesh(meshBuilding(*closure.building));
    EXPECT_GE(quality.minAngleDeg, 30);
    EXPECT_LE(quality.areaDeviation, 0.11);
}

// Two low arcs and a low wall through one another: 5.2 degrees where facets were even along the whole arc.
TEST(CurvedFacets, of_partitions_leave_no_slivers_where_others_cross_them) {
    Sketch sketch = box(20, 14);
    sketch.arcs = {arc("large", {0, -2}, 5, 10, 170), arc("small", {4, 1}, 3, 100, 260)};
    for (Arc& low : sketch.arcs) low.heightClass = HeightClass::green;
    Wall& wall = sketch.walls.emplace_back();
    wall.id = "low";
    wall.a = {-3.1, -5};
    wall.b = {-2.2, 5};
    wall.heightClass = HeightClass::green;
    EXPECT_GE(qualityOf(sketch).minAngleDeg, 29);
}

// A ring in a square, drawn to touch its four sides: whether one could walk past was an accident of its
// facets.
TEST(CurvedFacets, curved_walls_that_run_by_others_within_a_crack_leave_no_way_past) {
    const double inner = 8 - 0.1875;
    for (const double gap : {-0.1, -0.02, -0.001, 0.0, 0.001, 0.01, 0.05, 0.3, 0.9, 1.2}) {
        Sketch sketch = box(16, 16);
        sketch.arcs.push_back(arc("ring", {}, inner - gap - 0.1875, 0, 360));
        const Closure closure = closeSketch(sketch, fittedOptions(sketch));
        ASSERT_EQ(closure.report.rooms.size(), gap < 1 ? 5 : 2) << gap;
        double floors = 0;
        for (const RoomReport& room : closure.report.rooms) floors += room.floorAreaFt2;
        const double ring = std::numbers::pi * (std::pow(inner - gap, 2) - std::pow(inner - gap - 0.375, 2));
        EXPECT_NEAR(floors, 4 * inner * inner - ring, 0.01 * (4 * inner * inner - ring)) << gap;
    }
    for (const double gap : {-0.01, 0.0, 0.02, 0.5, 1.2}) { // rings side by side, and one within the other
        Sketch sketch = box(30, 16);
        const double x = 5 + gap / 2;
        sketch.arcs.push_back(arc("one", {-x, 0}, 5 - 0.1875, 0, 360));
        sketch.arcs.push_back(arc("two", {x, 0}, 5 - 0.1875, 0, 360));
        sketch.arcs.push_back(arc("in one", {-x - 5 + 0.375 + 2 + gap, 0}, 2 - 0.1875, 0, 360));
        const Closure closure = closeSketch(sketch, fittedOptions(sketch));
        ASSERT_EQ(closure.report.rooms.size(), 4u) << gap;
        int rings = 0; // islands in a room: none where they are joined to each other or to what is around
        for (const RoomReport& room : closure.report.rooms) rings += (2 - room.euler) / 2;
        EXPECT_EQ(rings, gap < 1 ? 1 : 3) << gap;
    }
}

// Their facets are strips side by side, and staggered by turns all the way round: 24 degrees before.
TEST(CurvedFacets, of_columns_are_staggered) {
    Sketch sketch = box(20, 12);
    sketch.arcs = {arc("thick", {-4, 0}, 0.9, 0, 360), arc("thin", {4, 0}, 0.7, 0, 360)};
    EXPECT_GE(qualityOf(sketch).minAngleDeg, 33);
}

// Areas of the two lunes and of the lens between, walls 3/8 in thick, from circles.
TEST(CurvedFacets, enclose_the_area_of_the_arcs) {
    const auto lens = [](double r, double s, double d) { // of circles d apart
        const double a = (d * d + r * r - s * s) / (2 * d), b = d - a;
        return r * r * std::acos(a / r) - a * std::sqrt(r * r - a * a) + s * s * std::acos(b / s) -
               b * std::sqrt(s * s - b * b);
    };
    const double pi = std::acos(-1.0), d = std::hypot(8.4, 1.1), h = 0.1875;
    std::vector<double> expected{lens(7 - h, 8 - h, d), pi * std::pow(7 - h, 2) - lens(7 - h, 8 + h, d),
                                 pi * std::pow(8 - h, 2) - lens(7 + h, 8 - h, d)};
    const Sketch sketch = twoCircles();
    const Closure closure = closeSketch(sketch, fittedOptions(sketch));
    std::vector<double> areas;
    for (const RoomReport& room : closure.report.rooms) areas.push_back(room.floorAreaFt2);
    ASSERT_EQ(areas.size(), expected.size());
    std::ranges::sort(areas);
    std::ranges::sort(expected);
    // Ends of facets lie up to a chord's error off the arc.
    for (size_t k = 0; k < areas.size(); ++k) EXPECT_NEAR(areas[k], expected[k], 2e-3 * expected[k]);
}

// Else a wall would cast slivers of shadow on itself.
TEST(CurvedFacets, no_solid_stands_out_of_the_wall_that_rooms_see) {
    for (const char* name : {"s_curve.json", "three_arcs.json", "arc_with_partitions.json", ""}) {
        const Sketch sketch =
            *name ? readSketch(std::string(HELIODON_TEST_DATA "/geometry/sketches/") + name) : twoCircles();
        const Closure closure = closeSketch(sketch, fittedOptions(sketch));
        ASSERT_TRUE(closure.building) << closure.report.message;
        const Building& building = *closure.building;
        size_t asked = 0, out = 0;
        for (const Face& face : building.faces) {
            const auto& loop = face.loops[0];
            std::vector<glm::dvec3> foot; // of an upright facet from floor to ceiling
            glm::dvec3 normal{0};
            for (size_t k = 0; k < loop.size(); ++k) {
                const glm::dvec3 p = building.vertices[loop[k]];
                normal += glm::cross(p, building.vertices[loop[(k + 1) % loop.size()]]);
                if (p.y < 1e-9) foot.push_back(p);
            }
            if (loop.size() != 4 || foot.size() != 2) continue;
            for (const double share : {0.05, 0.3, 0.5, 0.7, 0.95}) {
                const glm::dvec3 inAir = glm::mix(foot[0], foot[1], share) + 1e-5 * glm::normalize(normal);
                ++asked;
                out += inSolid(building.occluders, inAir + glm::dvec3(0, 0.05, 0));
            }
        }
        EXPECT_GT(asked, 100u) << name;
        EXPECT_EQ(out, 0u) << name << " of " << asked;
    }
}

namespace {

// A round room of `sides` facets as an .obj: with one normal at each corner, or one for each facet.
// `more`: lines after that.
Building roundModel(int sides, bool smooth, bool triangles, const char* exponent = "",
                    const std::string& more = "") {
    const std::string file = testing::TempDir() + "round.obj";
    std::ofstream out(file);
    const auto angle = [&](double k) { return 2 * std::numbers::pi * k / sides; };
    const auto at = [&](double k) {
        return fmt::format("{:.6f} {} {:.6f}", std::cos(angle(k)), "{}", -std::sin(angle(k)));
    };
    std::string floor = "f", ceiling;
    for (int k = 0; k < sides; ++k) {
        for (const int y : {0, 1}) out << "v " << fmt::format(fmt::runtime(at(k)), y) << "\n";
        const double middle = smooth ? k : k + 0.5;
        out << fmt::format("vn {0:.6f}{2} 0 {1:.6f}{2}\n", std::cos(angle(middle)), -std::sin(angle(middle)),
                           exponent);
        floor += fmt::format(" {}", 2 * k + 1);
        ceiling = fmt::format(" {}", 2 * k + 2) + ceiling;
    }
    out << floor << "\nf" << ceiling << "\n";
    for (int k = 0; k < sides; ++k) {
        const int next = (k + 1) % sides, normal = (smooth ? next : k) + 1;
        const std::string a = fmt::format(" {}//{}", 2 * k + 1, k + 1),
                          b = fmt::format(" {}/7/{}", 2 * k + 2, k + 1),
                          c = fmt::format(" {}//{}", 2 * next + 2, normal),
                          d = fmt::format(" {}//{}", 2 * next + 1, normal - sides - 1);
        out << "f" << a << b << c << (triangles ? "\nf" + a + c : "") << d << "\n";
    }
    out << more;
    out.close();
    return importModel(file);
}

// The same as a .gltf, from triangles that share no corner, in a node that squeezes them.
Building roundScene(int sides, bool smooth) {
    std::vector<float> places, normals;
    const auto add = [&](double k, double y, double towards, double up, double radius = 1) {
        const double turn = 2 * std::numbers::pi / sides;
        for (const double x : {radius * std::cos(turn * k), y, -radius * std::sin(turn * k)})
            places.push_back(static_cast<float>(x));
        for (const double x :
             {up == 0 ? -std::cos(turn * towards) : 0, up, up == 0 ? std::sin(turn * towards) : 0})
            normals.push_back(static_cast<float>(x));
    };
    for (int k = 0; k < sides; ++k) {
        const double from = smooth ? k : k + 0.5, to = smooth ? k + 1 : k + 0.5;
        add(k, 0, from, 0), add(k, 1, from, 0), add(k + 1, 1, to, 0);
        add(k, 0, from, 0), add(k + 1, 1, to, 0), add(k + 1, 0, to, 0);
        add(k, 0, 0, 1), add(k + 1, 0, 0, 1), add(0, 0, 0, 1, 0);
        add(k + 1, 1, 0, -1), add(k, 1, 0, -1), add(0, 1, 0, -1, 0);
    }
    const size_t bytes = places.size() * sizeof(float);
    std::ofstream binary(testing::TempDir() + "round.bin", std::ios::binary);
    for (const auto* part : {&places, &normals})
        binary.write(reinterpret_cast<const char*>(part->data()), static_cast<std::streamsize>(bytes));
    binary.close();
    const std::string file = testing::TempDir() + "round.gltf";
    std::ofstream(file) << fmt::format(
        R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"scale":[1,3,0.7]}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1}}}}]}}],
"buffers":[{{"uri":"round.bin","byteLength":{1}}}],"bufferViews":[{{"buffer":0,"byteLength":{0}}},{{"buffer":0,"byteOffset":{0},"byteLength":{0}}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":{2},"type":"VEC3","min":[-1,0,-1],"max":[1,1,1]}},{{"bufferView":1,"componentType":5126,"count":{2},"type":"VEC3"}}]}})",
        bytes, 2 * bytes, places.size() / 3);
    return importModel(file);
}

enum class Smooth { no, byNormals, byGroup };

// A round room of 24 sides under a roof of `rings` rings of facets: a dome, or a cone with a normal for each
// facet at its tip.
Building roofedModel(int rings, bool cone, Smooth smooth) {
    const int sides = 24;
    const std::string file = testing::TempDir() + "roofed.obj";
    std::ofstream out(file);
    const auto place = [&](double share, double k) { // 0: where the roof begins, 1: its top
        const double up = share * std::numbers::pi / 2, a = 2 * std::numbers::pi * k / sides;
        const double radius = cone ? 1 - share : std::cos(up), rise = cone ? share : std::sin(up);
        return glm::dvec3(radius * std::cos(a), 1 + rise, -radius * std::sin(a));
    };
    std::vector<glm::dvec3> normals;
    const auto corner = [&](glm::dvec3 p, glm::dvec3 normal) {
        normals.push_back(normal);
        out << fmt::format("v {:.6f} {:.6f} {:.6f}\nvn {:.4f} {:.4f} {:.4f}\n", p.x, p.y, p.z, normal.x,
                           normal.y, normal.z);
    };
    const auto face = [&](int count) {
        out << (smooth == Smooth::byGroup ? "s 2\nf" : "s off\nf");
        for (int k = -count; k < 0; ++k)
            out << ' ' << k << (smooth == Smooth::byNormals ? fmt::format("//{}", k) : "");
        out << "\n";
    };
    for (int k = 0; k < sides; ++k)
        for (int ring = -1; ring < rings; ++ring) {
            const auto at = [&](int r, int column) {
                glm::dvec3 p = place(std::max(r, 0) / double(rings), column);
                if (r < 0) p.y = 0;
                const double a = 2 * std::numbers::pi * (r == rings ? k + 0.5 : column) / sides;
                const double up = r < 0 ? 0 : cone ? std::numbers::pi / 4 : r * std::numbers::pi / 2 / rings;
                corner(p, {-std::cos(a) * std::cos(up), -std::sin(up), std::sin(a) * std::cos(up)});
            };
            at(ring, k), at(ring + 1, k);
            if (ring + 1 < rings) at(ring + 1, k + 1);
            at(ring, k + 1);
            face(ring + 1 < rings ? 4 : 3);
        }
    for (int k = 0; k < sides; ++k) corner(place(0, k) * glm::dvec3(1, 0, 1), {0, 1, 0});
    face(sides);
    out.close();
    return importModel(file);
}

size_t surfacesOf(const Building& building) {
    std::set<uint32_t> surfaces;
    for (const Face& face : building.faces) surfaces.insert(face.surface);
    return surfaces.size();
}

} // namespace

// Light runs on over its facets, as in a sketch's curved wall.
TEST(CurvedFacets, a_models_wall_is_one_surface_where_its_normals_say_so) {
    for (const bool triangles : {false, true}) {
        EXPECT_EQ(surfacesOf(roundModel(24, true, triangles)), 3);
        EXPECT_EQ(surfacesOf(roundModel(24, false, triangles)), 26);
        EXPECT_EQ(surfacesOf(roundScene(24, triangles)), triangles ? 3 : 26); // by turns smooth
        EXPECT_EQ(surfacesOf(roundModel(24, true, triangles, "e300")), 26);   // nothing to go by
        EXPECT_EQ(surfacesOf(roundModel(6, true, triangles)), 8);             // corners of 60 degrees
        for (const int sides : {24, 100}) {
            const Building building = roundModel(sides, true, triangles);
            const MeshQuality mesh = measureMesh(meshBuilding(building, {.ofModel = true}));
            EXPECT_NEAR(static_cast<double>(mesh.triangles), 2000, 60);
            EXPECT_GE(mesh.minAngleDeg, 30);
        }
    }
}

// With facets as they come the deviation was 0.39, 0.83 and 1.7, the smallest angle 32, 10 and 4 degrees.
TEST(CurvedFacets, facets_much_narrower_than_triangles_are_merged) {
    for (const bool triangles : {false, true})
        for (const int sides : {100, 200, 400}) {
            const Building building = roundModel(sides, true, triangles);
            const PatchMesh mesh = meshBuilding(building, {.ofModel = true});
            const MeshQuality quality = measureMesh(mesh);
            EXPECT_NEAR(static_cast<double>(quality.triangles), 2000, 60) << sides;
            EXPECT_GE(quality.minAngleDeg, 36) << sides;
            EXPECT_LE(quality.areaDeviation, 0.13) << sides;
            EXPECT_NEAR(volume(mesh), std::numbers::pi, 3e-3 * std::numbers::pi) << sides;
        }
}

// Where 0.93 edges of a triangle turn by more than 0.25 radians facets become narrower than that, and are
// meshed one by one: with facets as they come there are 1196 triangles for 300, with angles of 0.6 degrees.
TEST(CurvedFacets, small_circles_of_narrow_facets_keep_their_volume) {
    const Building building = roundModel(300, true, false);
    const PatchMesh mesh = meshBuilding(building, {.triangles = 300, .ofModel = true});
    const MeshQuality quality = measureMesh(mesh);
    EXPECT_NEAR(static_cast<double>(quality.triangles), 300, 15);
    EXPECT_GE(quality.minAngleDeg, 25);
    const PatchMesh own = ownTriangles(building);
    const VolumeError error = worstVolumeError(own, mesh);
    EXPECT_LT(error.share, 0);
    EXPECT_GT(error.share, -0.013);
    EXPECT_NEAR(error.share, volume(mesh) / measureRooms(own)[0].volume - 1, 1e-12);
}

// Rounded coordinates put some corners of very narrow facets into one straight line, and such walls were left
// with all of their facets: 6 GB of memory.
TEST(CurvedFacets, facets_in_one_plane_by_chance_do_not_keep_others_from_merging) {
    const PatchMesh mesh = meshBuilding(roundModel(8000, true, false), {.ofModel = true});
    EXPECT_NEAR(static_cast<double>(mesh.patchCount()), 2000, 60);
}

// Edges of solids 0.5 mm before a wall 1 m away, where chords would leave it by 1 to 2 mm.
TEST(CurvedFacets, what_stands_close_before_a_wall_keeps_its_facets) {
    std::string solids;
    double volumeOf = 0;
    for (double a = 0.1; a < 6; a += 0.7) {
        for (const double y : {0.0, 0.5})
            for (const glm::dvec2 p : {glm::dvec2(0.9995, 0), {0.9, 0.05}, {0.9, -0.05}})
                solids += fmt::format("v {:.6f} {} {:.6f}\n", p.x * std::cos(a) - p.y * std::sin(a), y,
                                      -p.x * std::sin(a) - p.y * std::cos(a));
        solids += "f -6 -5 -4\nf -1 -2 -3\nf -6 -3 -2 -5\nf -5 -2 -1 -4\nf -4 -1 -3 -6\n";
        volumeOf += 0.05 * 0.0995 * 0.5;
    }
    const Building building = roundModel(200, true, false, "", solids);
    const PatchMesh mesh = meshBuilding(building, {.ofModel = true});
    // Chords of 0.11 radians take 0.2 % off, and triangles over the folds between them as much.
    EXPECT_NEAR(volume(mesh), std::numbers::pi - volumeOf, 6e-3 * std::numbers::pi);
    // No part of the floor twice, nor beyond the wall: its triangles have the area of its outline.
    double floor = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        if (patchNormal(mesh, i).y > 0.9 && patchCentroid(mesh, i).y < 0.1) floor += patchArea(mesh, i);
    EXPECT_NEAR(floor, std::numbers::pi - volumeOf / 0.5, 3e-3 * std::numbers::pi);
}

// A dome, which runs on from the wall, and a cone, whose facets meet in a tip and turn by 45 degrees from the
// wall.
TEST(CurvedFacets, a_models_roof_is_one_surface_where_normals_or_groups_say_so) {
    for (const bool cone : {false, true}) {
        const int rings = cone ? 1 : 6;
        EXPECT_EQ(surfacesOf(roofedModel(rings, cone, Smooth::no)), 1 + 24 * (rings + 1)) << cone;
        for (const Smooth smooth : {Smooth::byGroup, Smooth::byNormals})
            EXPECT_EQ(surfacesOf(roofedModel(rings, cone, smooth)), 2) << cone;
    }
    // The wall below a dome is unrolled, the dome's facets and the floor are flat.
    EXPECT_EQ(findMeshDomains(roofedModel(6, false, Smooth::byNormals), 0.15).size(), 1 + 24 * 6 + 1);
}

// Curved surfaces keep their normals in what the program writes.
TEST(CurvedFacets, what_was_curved_is_so_when_it_is_read_again) {
    const Building rounded = roundModel(24, true, false), roofed = roofedModel(6, false, Smooth::byNormals);
    for (const Building* building : {&rounded, &roofed})
        for (const char* name : {"again.obj", "again.glb"}) {
            const std::string file = testing::TempDir() + name;
            const PatchMesh mesh = meshBuilding(*building, {1000});
            writeModel(mesh, file);
            const Building again = importModel(file);
            EXPECT_EQ(surfacesOf(again), surfacesOf(*building)) << name;
            const PatchMesh finer = meshBuilding(again, {3000});
            EXPECT_NEAR(volume(finer), volume(mesh), 2e-3 * volume(mesh)) << name;
        }
}

// Triangles that lean across a fold, from its foot, are no part of the wall that is laid out, which then
// touches itself in that corner: the program's own models of rooms with arcs were refused when it read them
// again.
TEST(CurvedFacets, a_wall_may_hang_together_in_a_corner_beside_triangles_that_lean) {
    const int sides = 24;
    const std::string file = testing::TempDir() + "leaning.obj";
    std::ofstream out(file);
    const auto place = [&](int k, double y) {
        const double a = 2 * std::numbers::pi * k / sides;
        return glm::dvec3(std::cos(a), y, -std::sin(a));
    };
    const auto vertex = [&](glm::dvec3 p) { out << fmt::format("v {} {} {}\n", p.x, p.y, p.z); };
    std::string floor = "f", ceiling;
    for (int k = 0; k < sides; ++k) {
        for (const int y : {0, 1}) vertex(place(k, y));
        floor += fmt::format(" {}", 2 * k + 1);
        ceiling = fmt::format(" {}", 2 * k + 2) + ceiling;
    }
    for (int k = 0; k < 3; ++k) vertex(place(k, 0.5));
    vertex(glm::mix(place(1, 0.25), place(2, 0.25), 0.5));
    out << floor << "\nf" << ceiling << "\ns 1\nf 49 2 4 50\nf 50 4 6 51\n" // the upper half of two facets
        << "f 1 49 3\nf 3 49 52\nf 52 49 50\nf 3 52 5\nf 52 51 5\nf 52 50 51\n";
    for (int k = 2; k < sides; ++k) {
        const int next = (k + 1) % sides;
        out << fmt::format("f {} {} {} {}\n", 2 * k + 1, 2 * k + 2, 2 * next + 2, 2 * next + 1);
    }
    out.close();
    const Building building = importModel(file);
    for (const MeshDomain& domain : findMeshDomains(building, 0.1))
        for (size_t l = 0; l < domain.loops.size(); ++l)
            for (size_t k = 0; k < domain.loops[l].size(); ++k)
                for (size_t m = 0; m < k; ++m)
                    EXPECT_GT(glm::length(domain.planar[l][k] - domain.planar[l][m]), 0.1);
    const double own = volume(ownTriangles(building));
    EXPECT_NEAR(volume(meshBuilding(building, {.ofModel = true})), own, 1e-9 * own);
}

// Some of whose triangles span two facets, so that a fold runs out of what is left of the wall.
TEST(CurvedFacets, of_a_mesh_whose_triangles_lean_are_meshed_again) {
    const Closure closure = closeSketch(readSketch(HELIODON_TEST_DATA "/geometry/sketches/s_curve.json"));
    const PatchMesh mesh = meshBuilding(*closure.building);
    const std::string file = testing::TempDir() + "across.obj";
    writeModel(mesh, file);
    const PatchMesh again = meshBuilding(importModel(file), {.ofModel = true});
    EXPECT_NEAR(volume(again), volume(mesh), 2e-3 * volume(mesh));
}

// A fold right beside a low wall's end, with air between the two of less than triangles across it would take.
TEST(CurvedFacets, beside_a_low_wall_are_written_as_rooms_that_can_be_read) {
    const Sketch sketch = readSketch(HELIODON_TEST_DATA "/geometry/sketches/arc_with_partitions.json");
    const std::string file = testing::TempDir() + "beside.obj";
    for (const size_t triangles : {200, 600}) {
        ClosureOptions options;
        options.facetLength = fittingFacet(surfaceOfRooms(sketch), {triangles});
        options.chordError = 0.2; // wide facets, as few triangles ask for
        const Closure closure = closeSketch(sketch, options);
        const PatchMesh mesh = meshBuilding(*closure.building, {triangles});
        writeModel(mesh, file);
        const Building again = importModel(file);
        EXPECT_EQ(again.roomCount, closure.building->roomCount);
        EXPECT_NEAR(volume(ownTriangles(again)), volume(mesh), 1e-6 * volume(mesh));
    }
}
