// Random sketches, from tight rooms to nonsense. A short run by default; the long one is
//   test_geometry_closure_fuzz --gtest_repeat=250
// which takes new sketches for each repeat, 100,000 in all; --gtest_random_seed=S begins with others.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <map>
#include <random>
#include <set>
#include <span>
#include <string>

#include <unistd.h>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>

#include "geometry/bounds.h"
#include "geometry/building.h"
#include "geometry/face_soup.h"
#include "geometry/input_error.h"
#include "geometry/mesher.h"
#include "geometry/model_file.h"
#include "geometry/room_measures.h"
#include "tests/geometry/drawn_pieces.h"

using namespace heliodon::geometry;
using heliodon::test::wall;
using heliodon::test::window;

namespace {

constexpr unsigned kSketches = 400;

class SketchMaker {
public:
    explicit SketchMaker(unsigned seed) : random_(seed) {}

    Sketch make() {
        sketch_ = {};
        const int kind = pick(4);
        if (kind == 0)
            nonsense(pick(20));
        else if (kind == 1)
            polygon();
        else if (kind == 2)
            grid();
        else {
            polygon();
            nonsense(pick(8));
        }
        decorate();
        return sketch_;
    }

private:
    int pick(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
    double real(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random_);
    }
    glm::dvec2 point(double r = 18) { return {real(-r, r), real(-r, r)}; }
    HeightClass height() { return static_cast<HeightClass>(pick(3)); }

    void addWall(glm::dvec2 a, glm::dvec2 b, HeightClass h) {
        Wall w;
        w.id = fmt::format("w{}", sketch_.walls.size());
        w.a = a;
        w.b = b;
        w.heightClass = h;
        if (pick(10) == 0) w.thickness = real(0.05, 1);
        sketch_.walls.push_back(w);
    }

    // Any walls at all; some of them copies, some snapped to whole inches so that they touch and overlap
    // exactly.
    void nonsense(int count) {
        for (int k = 0; k < count; ++k) {
            glm::dvec2 a = point(), b = point();
            if (pick(2)) {
                a = glm::round(a);
                b = glm::round(b);
            }
            if (pick(3) == 0) b = pick(2) ? glm::dvec2(a.x, b.y) : glm::dvec2(b.x, a.y);
            if (pick(6) == 0 && !sketch_.walls.empty()) {
                const Wall& other =
                    sketch_.walls[static_cast<size_t>(pick(static_cast<int>(sketch_.walls.size())))];
                a = other.a + 0.1 * point(1);
                b = other.b + 0.1 * point(1);
            }
            if (pick(30) == 0) b = a;
            addWall(a, b, height());
        }
        for (int k = pick(4); k > 0 && count > 0; --k) {
            Arc arc;
            arc.id = fmt::format("a{}", sketch_.arcs.size());
            arc.center = point(10);
            arc.radius = real(0.2, 10);
            arc.a0Deg = real(-360, 360);
            arc.a1Deg = arc.a0Deg + (pick(8) ? real(1, 359) : 360);
            arc.heightClass = height();
            sketch_.arcs.push_back(arc);
        }
    }

    // A star-shaped room with gaps or overshoots at its corners.
    void polygon() {
        const int n = 3 + pick(8);
        const double slack = real(-1, 1);
        const HeightClass h = pick(2) ? HeightClass::red : HeightClass::blue;
        std::vector<glm::dvec2> corners;
        for (int k = 0; k < n; ++k) {
            const double angle = 2 * 3.14159265 * (k + real(0, 0.7)) / n, r = real(4, 15);
            corners.emplace_back(r * std::cos(angle), r * std::sin(angle));
        }
        for (int k = 0; k < n; ++k) {
            const glm::dvec2 a = corners[static_cast<size_t>(k)],
                             b = corners[static_cast<size_t>((k + 1) % n)];
            const glm::dvec2 d = glm::normalize(b - a);
            addWall(a + slack * d, b - slack * d, h);
        }
    }

    // Rooms in a row with doors and cracks.
    void grid() {
        const int n = 1 + pick(3);
        const double width = real(4, 9), depth = real(4, 12), x0 = -0.5 * n * width;
        addWall({x0, 0}, {x0 + n * width, 0}, HeightClass::red);
        addWall({x0, depth}, {x0 + n * width, depth}, HeightClass::red);
        for (int k = 0; k <= n; ++k) {
            const double hole = k == 0 || k == n ? real(-0.5, 0.5) : real(-1, 4);
            addWall({x0 + k * width, 0}, {x0 + k * width, depth - hole}, HeightClass::red);
        }
    }

    void decorate() {
        for (int k = pick(5); k > 0 && !sketch_.walls.empty(); --k) {
            WindowMarker w;
            w.id = fmt::format("win{}", k);
            w.wall = sketch_.walls[static_cast<size_t>(pick(static_cast<int>(sketch_.walls.size())))].id;
            w.pos = real(-1, 15);
            w.width = real(0.1, 8);
            w.kind = static_cast<WindowKind>(pick(3));
            sketch_.windows.push_back(w);
        }
        for (int k = pick(4); k > 0; --k) {
            Skylight s;
            s.id = fmt::format("sky{}", k);
            s.center = point(10);
            s.size = {real(0.1, 8), real(0.1, 8)};
            s.angleDeg = pick(2) ? 0 : real(0, 90);
            sketch_.skylights.push_back(s);
        }
        for (int k = pick(3); k > 0; --k) addWall(point(8), point(8), HeightClass::green);
    }

    std::mt19937 random_;
    Sketch sketch_;
};

#if defined(__SANITIZE_ADDRESS__) || !defined(NDEBUG)
constexpr double kSlower = 30; // than release, which takes under 100 ms
#else
constexpr double kSlower = 1;
#endif

// Over all repeats.
struct Tally {
    std::map<std::string, int> codes;
    int sketches = 0, closed = 0, meshed = 0;
    double slowestMs = 0;
    unsigned slowestSeed = 0;
};

// Of this process, so that other work on the machine does not count.
double cpuMs() {
    return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

constexpr double kLeastTriangle = 1e-6 * kMetresPerInch * kMetresPerInch; // m2

void expectNoNeedles(const Building& building) {
    for (const Face& face : building.faces) {
        std::set<uint32_t> corners; // an outline that touches itself cannot be meshed
        for (const auto& loop : face.loops)
            for (const uint32_t v : loop) ASSERT_TRUE(corners.insert(v).second);
        for (const auto& t : triangulateFace(building, face)) {
            const glm::dvec3 a = building.vertices[t[0]];
            ASSERT_GE(0.5 * glm::length(glm::cross(building.vertices[t[1]] - a, building.vertices[t[2]] - a)),
                      kLeastTriangle);
        }
    }
}

// An edge of a triangle goes through another triangle that has neither of its ends.
bool crossesItself(const PatchMesh& mesh) {
    std::vector<Bounds> boxes;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        std::vector<glm::dvec3> corners;
        for (const uint32_t v : mesh.patch(i)) corners.push_back(mesh.vertices[v]);
        boxes.push_back(boundsOf(corners));
    }
    const auto crosses = [&](uint32_t from, uint32_t to, std::span<const uint32_t> t) {
        if (std::ranges::any_of(t, [&](uint32_t v) { return v == from || v == to; })) return false;
        const glm::dvec3 p = mesh.vertices[from], q = mesh.vertices[to], a = mesh.vertices[t[0]],
                         b = mesh.vertices[t[1]], c = mesh.vertices[t[2]], n = glm::cross(b - a, c - a);
        const double before = glm::dot(p - a, n), after = glm::dot(q - a, n);
        if (before * after >= 0) return false;
        const glm::dvec3 x = p + before / (before - after) * (q - p);
        return glm::dot(glm::cross(b - a, x - a), n) > 0 && glm::dot(glm::cross(c - b, x - b), n) > 0 &&
               glm::dot(glm::cross(a - c, x - c), n) > 0;
    };
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        for (size_t j = 0; j < mesh.patchCount(); ++j) {
            if (i == j || glm::any(glm::greaterThan(boxes[i].low, boxes[j].high)) ||
                glm::any(glm::greaterThan(boxes[j].low, boxes[i].high)))
                continue;
            const auto t = mesh.patch(i);
            for (size_t k = 0; k < t.size(); ++k)
                if (crosses(t[k], t[(k + 1) % t.size()], mesh.patch(j))) return true;
        }
    return false;
}

// It crosses nothing, and triangles of glasses that are twins are opposite one another.
void expectMeshed(const Building& building, PatchMesh& mesh) {
    ASSERT_NO_THROW(mesh = meshBuilding(building, {500}));
    ASSERT_FALSE(crossesItself(mesh));
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        ASSERT_GE(patchArea(mesh, i), kLeastTriangle);
        if (mesh.twin[i] == kNoTwin) continue;
        const auto j = static_cast<size_t>(mesh.twin[i]);
        ASSERT_EQ(mesh.twin[j], static_cast<int32_t>(i));
        // Walls that were merged have faces a few degrees off one another, and differ by 0.1 in a side.
        ASSERT_LT(glm::dot(patchNormal(mesh, i), patchNormal(mesh, j)), -0.99);
        const auto corners = mesh.patch(i);
        double longest = 0;
        for (size_t k = 0; k < corners.size(); ++k)
            longest = std::max(longest, glm::length(mesh.vertices[corners[k]] -
                                                    mesh.vertices[corners[(k + 1) % corners.size()]]));
        ASSERT_NEAR(patchArea(mesh, i), patchArea(mesh, j),
                    std::max(0.1 * patchArea(mesh, i), 0.05 * kMetresPerInch * longest));
        const glm::dvec3 across = patchCentroid(mesh, j) - patchCentroid(mesh, i);
        ASSERT_LT(glm::length(across), 2 * kMetresPerInch); // the thickest wall and a half
        ASSERT_LT(glm::dot(across, patchNormal(mesh, i)), 0);
    }
}

void expectMeshed(const Building& building) {
    PatchMesh mesh;
    expectMeshed(building, mesh);
}

// Written as a model. Throws InputError where that is refused.
Building readAgain(const PatchMesh& mesh, const std::string& type = ".obj") {
    const std::string name = fmt::format("{}read_again_{}", testing::TempDir(), ::getpid());
    writeModel(mesh, name + type);
    const struct Removal {
        std::string name;
        ~Removal() {
            for (const char* extension : {".obj", ".mtl", ".glb"}) std::filesystem::remove(name + extension);
        }
    } removal{name};
    Building again = importModel(name + type);
    for (const std::string& warning : again.warnings) // the file says it as it is read
        EXPECT_EQ(warning.find("(twins) is not used"), std::string::npos) << warning;
    return again;
}

// It has the same rooms and panes, and each glass between two rooms its twin.
void expectSame(const PatchMesh& mesh, const Building& again) {
    const auto byVolume = [](std::vector<RoomMeasures> rooms) { // they are not in the same order
        std::ranges::sort(rooms, {}, &RoomMeasures::volume);
        return rooms;
    };
    const std::vector<RoomMeasures> before = byVolume(measureRooms(mesh)),
                                    after = byVolume(measureRooms(ownTriangles(again)));
    ASSERT_EQ(after.size(), before.size());
    for (size_t r = 0; r < before.size(); ++r) {
        ASSERT_NEAR(after[r].volume, before[r].volume, 1e-6 * before[r].volume);
        ASSERT_NEAR(after[r].floorArea, before[r].floorArea, 1e-5 * before[r].floorArea);
        ASSERT_NEAR(after[r].surface, before[r].surface, 1e-5 * before[r].surface);
        ASSERT_EQ(after[r].euler, before[r].euler);
    }
    ASSERT_EQ(std::ranges::count_if(again.faces, [](const Face& face) { return face.twin >= 0; }),
              std::ranges::count_if(mesh.twin, [](int32_t twin) { return twin != kNoTwin; }));
    const PaneCount panes = countPanes(mesh), panesAfter = countPanes(meshBuilding(again, {500}));
    ASSERT_EQ(panesAfter.windows, panes.windows);
    ASSERT_EQ(panesAfter.skylightPanes, panes.skylightPanes);
}

void expectReadAgain(const PatchMesh& mesh) {
    Building again;
    ASSERT_NO_THROW(again = readAgain(mesh));
    expectSame(mesh, again);
}

} // namespace

// Windows of different kinds over one another, so that a window shows as several glasses; glasses that share
// edges; faces of a wall that are not parallel; the tip of a wedge between a low wall and a high one;
// skylights whose side leaves a wall by less than two degrees, so that ceilings touched themselves (the last
// two).
TEST(ClosureFuzz, sketches_that_once_closed_but_could_not_be_meshed) {
    for (const unsigned seed : {30000220u, 36000046u, 38000109u, 38000173u, 40000134u, 40000181u, 3723588892u,
                                866686894u, 1873687004u}) {
        SCOPED_TRACE(seed);
        const Closure closure = closeSketch(SketchMaker(seed).make());
        ASSERT_TRUE(closure.building) << closure.report.message;
        expectMeshed(*closure.building);
    }
}

// Outlines that touch themselves where a straight run passes a corner by; walls nearly on one line, whose
// faces were not flat (1601000201, 1911000154, 77002829); an outline that crossed itself (1606000067);
// partitions and skylights that all but touch a corner, another one or a wall (77...);
// crossings that round to one point (3338000381, 3843131179); a corner drawn out into another room
// (1853032714); a room pinched to nothing between two corners of walls (1909687059); the last square along a
// wedge that crosses a wall beyond it (1434196534).
TEST(ClosureFuzz, sketches_that_once_could_not_be_proven) {
    for (const unsigned seed :
         {11000049u, 40000105u,   40000375u,   1601000201u, 1606000067u, 1911000154u, 77000409u, 77000732u,
          77000900u, 77001260u,   77001422u,   77001674u,   77002829u,   77002880u,   77004238u, 77004650u,
          77005292u, 3338000381u, 3843131179u, 1853032714u, 1909687059u, 1434196534u}) {
        SCOPED_TRACE(seed);
        const Closure closure = closeSketch(SketchMaker(seed).make());
        ASSERT_TRUE(closure.building) << closure.report.message;
        expectNoNeedles(*closure.building);
        expectMeshed(*closure.building);
    }
}

// Interior windows whose sides are not quite parallel, and such as have corners a hair off those opposite,
// where a partition passes the wall at a slant: two windows, or refused.
TEST(ClosureFuzz, models_of_windows_whose_sides_differ_a_little_are_read_again) {
    for (const unsigned seed : {770230u, 770267u, 990027u, 990278u, 990295u, 2000942u, 2002311u}) {
        SCOPED_TRACE(seed);
        const Closure closure = closeSketch(SketchMaker(seed).make());
        ASSERT_TRUE(closure.building) << closure.report.message;
        for (const size_t triangles : {500u, 2000u})
            expectReadAgain(meshBuilding(*closure.building, {triangles}));
    }
}

// Windows side by side in the two faces of a wall, of about one shape.
TEST(ClosureFuzz, models_of_windows_that_only_stand_beside_one_another_are_read_again) {
    for (const unsigned seed : {7000042u, 7000823u}) {
        SCOPED_TRACE(seed);
        const Closure closure = closeSketch(SketchMaker(seed).make());
        ASSERT_TRUE(closure.building) << closure.report.message;
        expectReadAgain(meshBuilding(*closure.building, {200}));
    }
}

// Windows of two walls 1.1 in apart that cover one another in part, and wholly: both look outside. Such with a
// crack of 0.4 in between them, and one in a wall thicker than those that panes of any file are taken to stand
// in: it is between the rooms.
TEST(ClosureFuzz, models_say_which_panes_are_the_sides_of_one_window) {
    for (const double x : {0.4, 0.75})
        for (const double other : {4.0, 5.0}) { // partly and wholly opposite
            Sketch sketch;
            sketch.walls = {wall("a", {-14, -4}, {-x, -4}), wall("b", {-x, -4}, {-x, 4}),
                            wall("c", {-x, 4}, {-14, 4}),   wall("d", {-14, 4}, {-14, -4}),
                            wall("e", {x, -5}, {13, -5}),   wall("f", {13, -5}, {13, 3}),
                            wall("g", {13, 3}, {x, 3}),     wall("h", {x, -5}, {x, 3})};
            sketch.windows = {window("in b", "b", 4, 3), window("in h", "h", other, 3)};
            const Closure closure = closeSketch(sketch);
            ASSERT_TRUE(closure.building) << closure.report.message;
            ASSERT_EQ(closure.report.windowCount, x > 0.5 ? 2 : 1);
            const PatchMesh mesh = meshBuilding(*closure.building, {500});
            ASSERT_EQ(std::ranges::any_of(mesh.twin, [](int32_t twin) { return twin != kNoTwin; }), x < 0.5);
            for (const char* type : {".obj", ".glb"}) expectSame(mesh, readAgain(mesh, type));
        }
    Sketch thick;
    thick.walls = {wall("a", {-7, -5}, {7, -5}), wall("b", {7, -5}, {7, 5}), wall("c", {7, 5}, {-7, 5}),
                   wall("d", {-7, 5}, {-7, -5}), wall("e", {0, -5}, {0, 5})};
    thick.walls.back().thickness = 1.2;
    thick.windows = {window("in e", "e", 5, 3)};
    const Closure closure = closeSketch(thick);
    ASSERT_TRUE(closure.building) << closure.report.message;
    const PatchMesh mesh = meshBuilding(*closure.building, {500});
    ASSERT_GT(std::ranges::count_if(mesh.twin, [](int32_t twin) { return twin != kNoTwin; }), 0);
    for (const char* type : {".obj", ".glb"}) expectSame(mesh, readAgain(mesh, type));
}

// Two curved walls that meet in a wedge, and a sliver of partition along a curved wall: triangles across
// folds crossed the wall beside them, or shared an edge with it.
TEST(ClosureFuzz, models_of_walls_close_to_a_curved_one_are_read_again) {
    for (const auto& [seed, triangles] : {std::pair(2001067u, size_t{600}), {3000353u, size_t{2000}}}) {
        SCOPED_TRACE(seed);
        const Sketch sketch = SketchMaker(seed).make();
        ClosureOptions options, coarse;
        options.coarseChord = coarse.chordError = 0.06; // as the program's
        options.facetLength = fittingFacet(surfaceOfRooms(sketch, coarse), {triangles});
        const Closure closure = closeSketch(sketch, options);
        ASSERT_TRUE(closure.building) << closure.report.message;
        expectReadAgain(meshBuilding(*closure.building, {triangles}));
    }
}

// A curved wall and the straight one of the same height between its ends, 0.15 in behind it: the mesh crossed
// itself there, and had a sliver of a room more when it was read again.
TEST(ClosureFuzz, triangles_across_folds_keep_clear_of_the_chord_of_a_curved_wall) {
    const Closure closure = closeSketch(SketchMaker(1622000240).make());
    ASSERT_TRUE(closure.building) << closure.report.message;
    PatchMesh mesh;
    ASSERT_NO_FATAL_FAILURE(expectMeshed(*closure.building, mesh));
    expectReadAgain(mesh);
}

// Where walls cross at a small angle: a window in the wedge between them, and one with a notch on one side.
TEST(ClosureFuzz, windows_whose_sides_differ_are_left_out_by_name) {
    for (const unsigned seed : {1123000192u, 1305000320u}) {
        SCOPED_TRACE(seed);
        const Closure closure = closeSketch(SketchMaker(seed).make());
        ASSERT_TRUE(closure.building) << closure.report.message;
        EXPECT_EQ(closure.report.outcome, Outcome::warn);
        EXPECT_NE(closure.report.message.find("is ignored: the two sides of its wall differ"),
                  std::string::npos)
            << closure.report.message;
        expectMeshed(*closure.building);
    }
}

// A partition 0.05 in before a wall that it meets 11 in further on: squares over the point where they touch
// walked along the wedge, each round with all its arrangements anew, and took 93 ms where it takes 40.
TEST(ClosureFuzz, a_partition_along_a_wall_takes_no_longer_than_others) {
    const Sketch sketch = SketchMaker(2950033053u).make();
    double least = 1e9;
    for (int run = 0; run < 3; ++run) {
        const double start = cpuMs();
        const Closure closure = closeSketch(sketch);
        least = std::min(least, cpuMs() - start);
        ASSERT_TRUE(closure.building) << closure.report.message;
        expectNoNeedles(*closure.building);
        expectMeshed(*closure.building);
    }
    EXPECT_LT(least, 70 * kSlower);
}

TEST(ClosureFuzz, every_sketch_closes_proven_or_is_refused_with_a_reason) {
    static unsigned run = 0;
    static Tally tally;
    const unsigned first = 1000000u * (static_cast<unsigned>(GTEST_FLAG_GET(random_seed)) + run++);
    const int before = tally.closed;
    for (unsigned k = 0; k < kSketches; ++k) {
        SCOPED_TRACE(fmt::format("seed {}", first + k));
        const Sketch sketch = SketchMaker(first + k).make();
        const double start = cpuMs();
        const Closure closure = closeSketch(sketch);
        const double ms = cpuMs() - start;
        if (ms > tally.slowestMs) {
            tally.slowestMs = ms;
            tally.slowestSeed = first + k;
        }
        ++tally.sketches;
        ++tally.codes[closure.report.code];
        if (closure.report.code == "NOT_PROVEN") printf("seed %u could not be proven\n", first + k);
        ASSERT_FALSE(closure.report.code.empty());
        ASSERT_FALSE(closure.report.message.empty());
        ASSERT_EQ(closure.building.has_value(), closure.report.outcome != Outcome::refuse);
        if (!closure.building) continue;
        ++tally.closed;
        for (const RoomReport& room : closure.report.rooms) {
            ASSERT_TRUE(room.closed && !room.selfIntersecting);
            ASSERT_GT(room.volumeFt3, 0);
        }
        ASSERT_NO_FATAL_FAILURE(expectNoNeedles(*closure.building));
        if (k % 10 == 0) {
            PatchMesh mesh;
            ASSERT_NO_FATAL_FAILURE(expectMeshed(*closure.building, mesh));
            ++tally.meshed;
            ASSERT_NO_FATAL_FAILURE(expectReadAgain(mesh));
        }
    }
    std::string line =
        fmt::format("{} sketches: {} closed, {} of them meshed and read again; slowest "
                    "{:.1f} ms (seed {});",
                    tally.sketches, tally.closed, tally.meshed, tally.slowestMs, tally.slowestSeed);
    for (const auto& [code, count] : tally.codes) line += fmt::format(" {} {}", code, count);
    printf("%s\n", line.c_str());
    EXPECT_GT(tally.closed - before, static_cast<int>(kSketches) / 4);
    // A refusal with a reason too, but no one's fault but ours: one in a thousand at most.
    EXPECT_LE(tally.codes["NOT_PROVEN"], 1 + tally.sketches / 1000);
    EXPECT_LT(tally.slowestMs, 100 * kSlower);
}
