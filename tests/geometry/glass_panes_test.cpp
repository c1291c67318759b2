// Windows whose panes are drawn as they are built: what lets light in is one face in each hole.
#include <algorithm>
#include <array>
#include <fstream>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "geometry/input_error.h"
#include "geometry/mesher.h"
#include "geometry/model_file.h"
#include "tests/geometry/mesh_volume.h"

using namespace heliodon::geometry;

namespace {

using Corners = std::vector<glm::dvec3>;

class Drawing {
public:
    Drawing() : out_(file_) {
        std::ofstream(std::string(testing::TempDir()) + "slabs.mtl")
            << "newmtl wall\nKd 0.5 0.5 0.5\nnewmtl glass\nKd 0 0 0\nTf 0.8 0.8 0.8\nNi 1.52\n"
               "newmtl dark\nTf 0.3 0.3 0.3\nNi 1.52\nnewmtl stone\nKd 0.2 0.3 0.4\n";
        out_ << "mtllib slabs.mtl\n";
    }

    // Of the faces drawn from then on, every so many is turned over; 0: none.
    void turnEvery(size_t step) { turnEvery_ = step; }

    void face(const char* material, Corners corners) {
        if (turnEvery_ > 0 && ++drawn_ % turnEvery_ == 0) std::ranges::reverse(corners);
        for (const glm::dvec3& p : corners) out_ << fmt::format("v {:.9g} {:.9g} {:.9g}\n", p.x, p.y, p.z);
        out_ << "usemtl " << material << "\nf";
        for (size_t k = 0; k < corners.size(); ++k) out_ << ' ' << next_++;
        out_ << '\n';
    }
    void object(const char* name) { out_ << "o " << name << '\n'; }
    void ring(const Corners& outside, const Corners& hole) {
        for (size_t k = 0; k < 4; ++k)
            face("wall", {outside[k], outside[(k + 1) % 4], hole[(k + 1) % 4], hole[k]});
    }
    // Four faces from one outline to another.
    void tube(const char* material, const Corners& from, const Corners& to) {
        for (size_t k = 0; k < 4; ++k) face(material, {from[k], from[(k + 1) % 4], to[(k + 1) % 4], to[k]});
    }
    void slab(const Corners& one, const Corners& other, const char* glass = "glass") {
        face(glass, one);
        face(glass, {other[3], other[2], other[1], other[0]});
        tube(glass, one, other);
    }
    // Looks outwards where `one` runs counter-clockwise about the way to the other.
    void box(const Corners& one, const Corners& other) {
        face("wall", {one[3], one[2], one[1], one[0]});
        face("wall", other);
        tube("wall", one, other);
    }

    Building read() {
        out_.close();
        return importModel(file_);
    }

private:
    std::string file_ = testing::TempDir() + "slabs.obj";
    std::ofstream out_;
    int next_ = 1;
    size_t turnEvery_ = 0, drawn_ = 0;
};

Corners rectangle(double x0, double x1, double y0, double y1, double z) {
    return {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
}
Corners whole(double z) {
    return rectangle(0, 4, 0, 2.5, z);
}
Corners hole(double z, double wider = 0) {
    return rectangle(1 - wider, 3 + wider, 0.8 - wider, 2 + wider, z);
}

Corners turned(Corners outline) {
    std::ranges::reverse(outline);
    return outline;
}

// A room of 30 m3 behind z = `near`, with a hole there.
void drawRoom(Drawing& drawing, double near, double far) {
    drawing.ring(whole(near), hole(near));
    drawing.face("wall", turned(whole(far)));
    drawing.tube("wall", turned(whole(near)), turned(whole(far)));
}

double glassOf(const Building& building, bool toOutside = false, const std::string& name = "") {
    double area = 0;
    for (const Face& face : building.faces)
        if ((name.empty() || building.materials[face.material].name == name) &&
            building.materials[face.material].isOpening() && !(toOutside && face.twin != kNoTwin)) {
            glm::dvec3 sum{0};
            const auto& loop = face.loops[0];
            for (size_t k = 1; k + 1 < loop.size(); ++k)
                sum += glm::cross(building.vertices[loop[k]] - building.vertices[loop[0]],
                                  building.vertices[loop[k + 1]] - building.vertices[loop[0]]);
            area += 0.5 * glm::length(sum);
        }
    return area;
}

// Of each room, the smallest first.
void expectVolumesOf(Drawing& drawing, const std::vector<double>& wanted) {
    const Building building = drawing.read();
    ASSERT_EQ(building.roomCount, wanted.size());
    const PatchMesh mesh = meshBuilding(building, {500});
    std::vector<double> found(wanted.size(), 0);
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        found[mesh.room[i]] -= glm::dot(patchCentroid(mesh, i), patchAreaVector(mesh, i)) / 6;
    std::ranges::sort(found);
    for (size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], wanted[k], 1e-5 * wanted[k]);
}

void expectPanes(Drawing& drawing, uint32_t rooms, double glass, double cubicMetres,
                 const std::string& repair = "1 slab of glass taken as a pane") {
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, rooms);
    EXPECT_NEAR(glassOf(building), glass, 1e-6 * glass);
    EXPECT_NEAR(volume(meshBuilding(building, {500})), cubicMetres, 1e-5 * cubicMetres);
    EXPECT_TRUE(building.warnings.empty()) << fmt::format("{}", fmt::join(building.warnings, "; "));
    EXPECT_EQ(std::ranges::count(building.repairs, repair), 1)
        << fmt::format("{}", fmt::join(building.repairs, "; "));
}

} // namespace

TEST(GlassPanes, slabs_in_a_hole_of_a_wall_without_thickness) {
    for (const auto& [one, other] : std::vector<std::pair<double, double>>{
             {-0.01, 0.01}, {-0.02, 0}, {0, 0.02}, {0.02, 0}}) // about it, outside it, in the room
        for (const double wider : {0.0, -0.004}) {
            Drawing drawing;
            drawRoom(drawing, 0, 3);
            drawing.slab(hole(one, wider), hole(other, wider));
            if (one * other == 0 || wider == 0) expectPanes(drawing, 1, 2.4, 30);
        }
    Drawing over; // glued on
    drawRoom(over, 0, 3);
    over.slab(hole(0, 0.05), hole(-0.02, 0.05));
    expectPanes(over, 1, 2.4, 30);
}

// As a program writes that exports both sides of every face; each was a room of glass.
TEST(GlassPanes, drawn_twice_are_one) {
    for (const bool turned : {false, true})
        for (const bool both : {false, true}) { // walls, too
            Drawing drawing;
            drawRoom(drawing, 0, 3);
            drawing.slab(hole(-0.01), hole(0.01));
            drawing.turnEvery(turned ? 1 : 0);
            if (both) drawRoom(drawing, 0, 3);
            drawing.slab(hole(-0.01), hole(0.01));
            const Building building = drawing.read();
            EXPECT_EQ(building.roomCount, 1u);
            EXPECT_NEAR(glassOf(building), 2.4, 1e-6);
        }
}

namespace {

void drawThickWalls(Drawing& drawing, double thick = 0.3, const char* reveal = "wall") {
    drawRoom(drawing, 0, 3);
    drawing.tube(reveal, hole(0), hole(-thick));
    const Corners outside = rectangle(-thick, 4 + thick, -thick, 2.5 + thick, -thick),
                  behind = rectangle(-thick, 4 + thick, -thick, 2.5 + thick, 3 + thick);
    drawing.ring(turned(outside), turned(hole(-thick)));
    drawing.face("wall", behind);
    drawing.tube("wall", outside, behind);
}

} // namespace

TEST(GlassPanes, slabs_between_the_sides_of_a_hole_through_a_thick_wall) {
    for (const double wider : {0.0, 0.02, -0.004}) { // let into the wall, with a joint
        Drawing drawing;
        drawThickWalls(drawing);
        drawing.slab(hole(-0.12, wider), hole(-0.1, wider));
        expectPanes(drawing, 1, 2.4, 30 + 2.4 * 0.11);
    }
}

// The inside of the walls is no room, whichever way the faces look.
TEST(GlassPanes, in_walls_larger_than_the_room) {
    for (const double thick : {0.4, 2.0})
        for (const size_t every : {0u, 1u, 2u})
            for (const double pane : {0.0, 0.5, 1.0}) {
                Drawing drawing;
                drawing.turnEvery(every);
                drawThickWalls(drawing, thick);
                drawing.face("glass", hole(-pane * thick));
                const Building building = drawing.read();
                EXPECT_EQ(building.roomCount, 1u) << thick << ' ' << every << ' ' << pane;
                EXPECT_NEAR(volume(meshBuilding(building, {500})), 30 + 2.4 * pane * thick, 1e-4);
            }
}

// By area, on both sides of an axis.
glm::dvec3 sidesOf(const Occluders& outside) {
    glm::dvec3 towards(0);
    for (size_t t = 0; t < outside.triangles.size(); t += 3) {
        const glm::dvec3 a = outside.vertices[outside.triangles[t]];
        towards += 0.5 * glm::abs(glm::cross(outside.vertices[outside.triangles[t + 1]] - a,
                                             outside.vertices[outside.triangles[t + 2]] - a));
    }
    return towards;
}

// Before glass in the middle of the wall its sides may shade it; the front of the wall cannot.
TEST(GlassPanes, what_stands_before_them_outside_is_kept) {
    for (const double pane : {0.5, 1.0}) {
        Drawing drawing;
        drawThickWalls(drawing, 0.4);
        drawing.face("glass", hole(-0.4 * pane));
        const glm::dvec3 towards = sidesOf(drawing.read().outside);
        const double depth = 0.4 * (1 - pane);
        EXPECT_NEAR(towards.x, 2 * 1.2 * depth, 1e-6);
        EXPECT_NEAR(towards.y, 2 * 2.0 * depth, 1e-6);
        EXPECT_NEAR(towards.z, 0, 1e-6);
    }
}

// All of it, and there is some.
template<class Model> void expectStone(const Model& model) {
    EXPECT_EQ(model.outside.material.size(), model.outside.triangles.size() / 3);
    EXPECT_FALSE(model.outside.material.empty());
    for (const uint32_t material : model.outside.material)
        EXPECT_EQ(model.materials[material].reflectance, glm::vec3(0.2f, 0.3f, 0.4f));
}

TEST(GlassPanes, what_stands_before_them_is_written_and_read) {
    Drawing drawing;
    drawThickWalls(drawing, 0.4, "stone");
    drawing.face("glass", hole(0));
    const PatchMesh given = meshBuilding(drawing.read(), {300});
    const glm::dvec3 sides = sidesOf(given.outside);
    ASSERT_GT(sides.x, 0.9);
    expectStone(given);
    for (const char* name : {"outside.obj", "outside.glb"}) {
        const std::string file = testing::TempDir() + name;
        writeModel(given, file);
        const Building again = importModel(file);
        EXPECT_EQ(again.roomCount, 1u);
        EXPECT_TRUE(again.repairs.empty() && again.warnings.empty()) << name;
        EXPECT_NEAR(glm::length(sidesOf(again.outside) - sides), 0, 1e-6) << name; // single precision
        const PatchMesh patches = readPatches(file);
        EXPECT_EQ(patches.patchCount(), given.patchCount());
        EXPECT_NEAR(glm::length(sidesOf(patches.outside) - sides), 0, 1e-6) << name;
        expectStone(again), expectStone(patches);
    }
}

TEST(GlassPanes, bodies_before_them_keep_their_material) {
    Drawing drawing;
    drawRoom(drawing, 0, 3);
    drawing.face("glass", hole(0));
    const Corners one = rectangle(-5, 9, 0, 8, -12), other = rectangle(-5, 9, 0, 8, -9);
    drawing.face("stone", {one[3], one[2], one[1], one[0]});
    drawing.face("stone", other);
    drawing.tube("stone", one, other);
    expectStone(drawing.read());
}

// However large: a neighbour, the ground that the house stands on.
TEST(GlassPanes, bodies_without_any_outside_are_no_rooms) {
    for (const double top : {0.7, 0.0}) {
        Drawing drawing;
        drawRoom(drawing, 0, 3);
        drawing.face("glass", hole(0));
        const double low = top - 5;
        const double far = top == 0 ? 30 : -10;
        drawing.box(rectangle(-30, 30, low, top, -30), rectangle(-30, 30, low, top, far));
        expectVolumesOf(drawing, {30});
        const std::vector<std::string> warnings = drawing.read().warnings;
        ASSERT_EQ(warnings.size(), 1u) << top;
        EXPECT_EQ(warnings[0].rfind("1 solid stands outside", 0), 0u) << warnings[0];
    }
}

TEST(GlassPanes, in_walls_without_floor_and_ceiling) {
    Drawing drawing;
    drawRoom(drawing, 0, 3);
    drawing.tube("wall", hole(0), hole(-2));
    const Corners outside = rectangle(-2, 6, 0, 2.5, -2), behind = rectangle(-2, 6, 0, 2.5, 5);
    drawing.ring(turned(outside), turned(hole(-2)));
    drawing.face("wall", behind);
    drawing.tube("wall", outside, behind);
    drawing.face("glass", hole(-1));
    expectVolumesOf(drawing, {32.4});
}

// A hall is none though the windows of the room in it lead through it to the outside.
TEST(GlassPanes, of_a_room_in_a_hall_that_looks_in) {
    Drawing drawing;
    drawRoom(drawing, 0, 3);
    drawing.tube("wall", hole(0), hole(-1));
    const Corners outside = rectangle(-2, 6, -1, 4, -1), behind = rectangle(-2, 6, -1, 4, 6);
    drawing.ring(outside, hole(-1));
    drawing.face("wall", turned(behind));
    drawing.tube("wall", turned(outside), turned(behind));
    drawing.face("glass", hole(-0.5));
    expectVolumesOf(drawing, {31.2, 8 * 5 * 7 - 30 - 2.4});
}

TEST(GlassPanes, flat_ones_that_are_larger_or_smaller_than_their_hole) {
    for (const double wider : {0.02, -0.004}) {
        Drawing thick;
        drawThickWalls(thick);
        thick.face("glass", hole(-0.1, wider));
        expectPanes(thick, 1, 2.4, 30 + 2.4 * 0.1, "1 pane taken to fill the hole");
        Drawing thin;
        drawRoom(thin, 0, 3);
        thin.face("glass", hole(0, wider));
        expectPanes(thin, 1, 2.4, 30, "1 pane taken to fill the hole");
    }
}

// A bar stands in the hole: what it leaves free are two panes.
TEST(GlassPanes, behind_a_bar) {
    Drawing drawing;
    drawThickWalls(drawing);
    const Corners foot = {{1.9, 0.8, -0.2}, {2.1, 0.8, -0.2}, {2.1, 0.8, -0.05}, {1.9, 0.8, -0.05}};
    Corners head = foot;
    for (glm::dvec3& p : head) p.y = 2;
    drawing.tube("wall", turned(foot), turned(head));
    drawing.face("wall", foot);
    drawing.face("wall", turned(head));
    drawing.slab(hole(-0.12), hole(-0.1));
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 1u);
    EXPECT_NEAR(glassOf(building), 2.4 - 0.2 * 1.2, 1e-6);
}

TEST(GlassPanes, bars_outside_are_cut_out_of_no_room) {
    for (const bool inside : {false, true}) {
        Drawing drawing;
        drawThickWalls(drawing);
        drawing.box(rectangle(1.9, 2.1, 0.8, 2, -0.25), rectangle(1.9, 2.1, 0.8, 2, -0.15));
        if (inside) drawing.box(rectangle(1.4, 1.5, 0.8, 2, -0.05), rectangle(1.4, 1.5, 0.8, 2, -0.02));
        drawing.face("glass", hole(-0.1));
        std::vector<std::string> starts;
        for (const std::string& warning : drawing.read().warnings) starts.push_back(warning.substr(0, 20));
        std::vector<std::string> expected{"1 solid stands outsi"};
        if (inside) expected.insert(expected.begin(), "1 solid was cut out ");
        EXPECT_EQ(starts, expected);
    }
}

// There is no glass in a bar that a pane is drawn through.
TEST(GlassPanes, through_a_bar) {
    for (const bool flat : {false, true}) {
        Drawing drawing;
        drawRoom(drawing, 0, 3);
        drawing.box(rectangle(1.9, 2.1, 0.8, 2, -0.05), rectangle(1.9, 2.1, 0.8, 2, 0.05));
        if (flat)
            drawing.face("glass", hole(0));
        else
            drawing.slab(hole(-0.01, 0.03), hole(0.01, 0.03));
        const Building building = drawing.read();
        EXPECT_EQ(building.roomCount, 1u);
        EXPECT_NEAR(glassOf(building), 2.4 - 0.2 * 1.2, 1e-6);
    }
}

namespace {

void drawBarThrough(Drawing& drawing, double x0, double x1) {
    drawing.box(rectangle(x0, x1, 0.8, 2, -0.2), rectangle(x0, x1, 0.8, 2, -0.05));
}

} // namespace

// Drawn as it is, air would be joined to the outside within the bar, and walls would be taken for the room.
TEST(GlassPanes, flat_ones_that_fill_their_hole_but_for_a_bar_through_them) {
    for (const bool another : {false, true}) { // a room whose glass is right as it is drawn
        Drawing drawing;
        drawThickWalls(drawing);
        drawBarThrough(drawing, 1.9, 2.1);
        drawing.face("glass", hole(-0.1));
        if (another) {
            drawing.face("glass", rectangle(8, 9, 0, 1, 0));
            drawing.face("wall", turned(rectangle(8, 9, 0, 1, 1)));
            drawing.tube("wall", turned(rectangle(8, 9, 0, 1, 0)), turned(rectangle(8, 9, 0, 1, 1)));
        }
        const Building building = drawing.read();
        EXPECT_EQ(building.roomCount, another ? 2u : 1u);
        EXPECT_NEAR(glassOf(building), 2.4 - 0.2 * 1.2 + (another ? 1 : 0), 1e-6);
        EXPECT_NEAR(volume(meshBuilding(building, {500})),
                    30 + 2.4 * 0.1 - 0.2 * 1.2 * 0.05 + (another ? 1 : 0), 1e-4);
    }
}

// Side by side and touching, with a gap of 2 mm, as sliding windows, and flat.
TEST(GlassPanes, several_in_one_hole) {
    struct Halves {
        double left, right, shift;
        const char* repair;
    };
    for (const auto& [left, right, shift, repair] :
         {Halves{2, 2, 0, "1 slab of glass taken as a pane"},
          Halves{1.999, 2.001, 0, "2 slabs of glass taken as panes"},
          Halves{2.05, 1.95, 0.04, "2 slabs of glass taken as panes"}}) {
        Drawing drawing;
        drawThickWalls(drawing);
        drawing.slab(rectangle(1, left, 0.8, 2, -0.12), rectangle(1, left, 0.8, 2, -0.1));
        drawing.slab(rectangle(right, 3, 0.8, 2, -0.12 + shift), rectangle(right, 3, 0.8, 2, -0.1 + shift));
        const double depth = right < 2 ? 0.07 : 0.11; // of the larger one; of equal ones of the first
        expectPanes(drawing, 1, 2.4, 30 + 2.4 * (shift > 0 ? depth : 0.11), repair);
    }
    Drawing flat;
    drawThickWalls(flat);
    flat.face("glass", rectangle(1.004, 1.998, 0.804, 1.996, -0.1));
    flat.face("glass", rectangle(2.002, 2.996, 0.804, 1.996, -0.1));
    expectPanes(flat, 1, 2.4, 30 + 2.4 * 0.1, "2 panes taken to fill the hole");
}

TEST(GlassPanes, of_two_kinds_in_one_hole) {
    Drawing drawing;
    drawThickWalls(drawing);
    drawing.slab(rectangle(1, 1.7, 0.8, 2, -0.12), rectangle(1, 1.7, 0.8, 2, -0.1), "dark");
    drawing.slab(rectangle(1.7, 3, 0.8, 2, -0.13), rectangle(1.7, 3, 0.8, 2, -0.1));
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 1u);
    EXPECT_NEAR(glassOf(building), 2.4, 1e-6);
    EXPECT_NEAR(glassOf(building, false, "dark"), 0.7 * 1.2, 1e-6);
    EXPECT_NEAR(volume(meshBuilding(building, {500})), 30 + 2.4 * 0.115, 1e-4);
}

// By turns, in a wall without thickness and in the middle of a thick one.
TEST(GlassPanes, many_of_two_kinds_in_one_hole) {
    for (const auto& [columns, rows] : std::vector<std::pair<int, int>>{{6, 1}, {12, 1}, {4, 4}, {9, 7}})
        for (const bool thick : {false, true}) {
            Drawing drawing;
            if (thick)
                drawThickWalls(drawing);
            else
                drawRoom(drawing, 0, 3);
            const double z = thick ? -0.12 : -0.01, x = 2.0 / columns, y = 1.2 / rows;
            for (int i = 0; i < columns; ++i)
                for (int j = 0; j < rows; ++j) {
                    const auto side = [&](double at) {
                        return rectangle(1 + i * x, 1 + (i + 1) * x, 0.8 + j * y, 0.8 + (j + 1) * y, at);
                    };
                    drawing.slab(side(z), side(z + 0.02), (i + j) % 2 == 0 ? "dark" : "glass");
                }
            SCOPED_TRACE(fmt::format("{} {} {}", columns, rows, thick));
            const Building building = drawing.read();
            EXPECT_EQ(building.roomCount, 1u);
            EXPECT_NEAR(glassOf(building), 2.4, 1e-6);
            const int panes = columns * rows;
            EXPECT_NEAR(glassOf(building, false, "dark"), 2.4 * ((panes + 1) / 2) / panes, 1e-6);
            EXPECT_NEAR(volume(meshBuilding(building, {500})), 30 + (thick ? 2.4 * 0.11 : 0), 1e-4);
        }
}

namespace {

Corners across(double z0, double z1, double y0, double y1, double x) {
    return {{x, y0, z0}, {x, y0, z1}, {x, y1, z1}, {x, y1, z0}};
}

// 30 m3 with a hole 2 m wide on both sides of the corner at x = 4, z = 0.
void drawRoomWithOpenCorner(Drawing& drawing) {
    for (const auto& [y0, y1, end] : {std::array{0.0, 0.8, 0.0}, {0.8, 2.0, 2.0}, {2.0, 2.5, 0.0}}) {
        drawing.face("wall", rectangle(0, end == 0 ? 4 : 2, y0, y1, 0));
        drawing.face("wall", across(end, 3, y0, y1, 4));
    }
    drawing.face("wall", turned(rectangle(0, 4, 0, 2.5, 3)));
    drawing.face("wall", turned(across(0, 3, 0, 2.5, 0)));
    for (const double y : {0.0, 2.5}) drawing.face("wall", {{0, y, 0}, {4, y, 0}, {4, y, 3}, {0, y, 3}});
}

} // namespace

// One ends at the other, whose end is seen.
TEST(GlassPanes, round_a_corner_without_a_post) {
    Drawing drawing;
    drawRoomWithOpenCorner(drawing);
    drawing.slab(rectangle(2, 3.99, 0.8, 2, -0.01), rectangle(2, 3.99, 0.8, 2, 0.01));
    drawing.slab(across(-0.01, 2, 0.8, 2, 3.99), across(-0.01, 2, 0.8, 2, 4.01));
    expectPanes(drawing, 1, 4.8, 30, "2 slabs of glass taken as panes");
}

namespace {

void expectRefusal(Drawing& drawing, const std::string& why) {
    try {
        drawing.read();
        ADD_FAILURE() << "read: " << why;
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
}

} // namespace

// As drawn each would be a room that light passes.
TEST(GlassPanes, mitred_round_a_corner_are_refused_as_that) {
    Drawing drawing;
    drawRoomWithOpenCorner(drawing);
    drawing.slab(rectangle(2, 4.01, 0.8, 2, -0.01), rectangle(2, 3.99, 0.8, 2, 0.01));
    drawing.slab(across(0.01, 2, 0.8, 2, 3.99), across(-0.01, 2, 0.8, 2, 4.01));
    expectRefusal(drawing, "mitred");
}

// Not "a gap of 5e-16 m", which a pane in triangles without one of them leaves round itself.
TEST(GlassPanes, that_lack_a_triangle_are_refused_with_the_hole) {
    for (const size_t gone : {0u, 3u}) {
        Drawing drawing;
        drawRoom(drawing, 0, 3);
        const Corners border = hole(0);
        const glm::dvec3 middle = 0.25 * (border[0] + border[1] + border[2] + border[3]);
        for (size_t k = 0; k < 4; ++k)
            if (k != gone) drawing.face("glass", {border[k], border[(k + 1) % 4], middle});
        expectRefusal(drawing, "close the hole");
    }
}

// Where it would turn walls and air round, as where it only leaves the room open.
TEST(GlassPanes, that_fill_no_hole_are_refused_with_the_gap) {
    const auto refuse = [](const auto& draw, const std::string& why) {
        Drawing drawing;
        drawThickWalls(drawing);
        draw(drawing);
        expectRefusal(drawing, why);
    };
    refuse([](Drawing& d) { d.slab(hole(-0.12, -0.03), hole(-0.1, -0.03)); },
           ":139: a gap of 0.03 m is left between the glass and the hole");
    refuse(
        [](Drawing& d) {
            d.object("sash 3");
            d.slab(hole(-0.12, -0.03), hole(-0.1, -0.03));
        },
        "(object \"sash 3\"): a gap of 0.03 m");
    refuse([](Drawing& d) { d.slab(rectangle(1, 2.2, 0.8, 2, -0.12), rectangle(1, 2.2, 0.8, 2, -0.1)); },
           "the glass fills no hole, as a leaf that stands open");
    refuse([](Drawing& d) { d.face("glass", hole(-0.1, -0.03)); },
           "a gap of 0.03 m is left between the glass and the hole");
    refuse(
        [](Drawing& d) { // what is round it is the room
            d.face("glass", hole(-0.1));
            d.face("glass", rectangle(1, 3, 0.5, 2, 1.5));
        },
        "the glass fills no hole, as a leaf that stands open or a flat pane that stands free");
    refuse([](Drawing& d) { d.slab(hole(-0.3), hole(0.2)); },
           "the glass fills no hole, and no other glass bounds a room");
    refuse(
        [](Drawing& d) { // the pane stands in a frame that leaves a gap round it
            for (const auto& [x0, x1, y0, y1] : std::vector<std::array<double, 4>>{{1.02, 2.98, 0.82, 0.9},
                                                                                   {1.02, 2.98, 1.9, 1.98},
                                                                                   {1.02, 1.1, 0.9, 1.9},
                                                                                   {2.9, 2.98, 0.9, 1.9}})
                d.box(rectangle(x0, x1, y0, y1, -0.15), rectangle(x0, x1, y0, y1, -0.05));
            d.slab(rectangle(1.09, 2.91, 0.89, 1.91, -0.12), rectangle(1.09, 2.91, 0.89, 1.91, -0.1));
        },
        "the glass fills a hole but bounds no room");
    refuse(
        [](Drawing& d) { // most of the pane lies within what stands before it
            drawBarThrough(d, 1.2, 2.8);
            d.face("glass", hole(-0.1));
        },
        "the glass bounds no room, nor does any other");
}

// A top of glass is seen through; what stands on legs, or is no slab, is left out.
TEST(GlassPanes, that_stand_in_a_room_let_no_light_in) {
    const auto top = [](double y) { return Corners{{1, y, 1}, {2, y, 1}, {2, y, 2}, {1, y, 2}}; };
    for (const bool legs : {false, true}) {
        Drawing drawing;
        drawThickWalls(drawing);
        drawing.slab(hole(-0.12), hole(-0.1));
        drawing.slab(top(0.75), top(0.76));
        if (legs)
            drawing.box(Corners{{1.4, 0, 1.4}, {1.4, 0, 1.6}, {1.6, 0, 1.6}, {1.6, 0, 1.4}},
                        Corners{{1.4, 0.75, 1.4}, {1.4, 0.75, 1.6}, {1.6, 0.75, 1.6}, {1.6, 0.75, 1.4}});
        const Building building = drawing.read();
        EXPECT_EQ(building.roomCount, 1u);
        EXPECT_NEAR(glassOf(building), legs ? 2.4 : 4.4, 1e-6);
        EXPECT_NEAR(glassOf(building, true), 2.4, 1e-6);
        EXPECT_EQ(std::ranges::count_if(building.warnings,
                                        [](const auto& w) { return w.find("left out") != w.npos; }),
                  legs ? 1 : 0);
    }
    Drawing vase;
    drawThickWalls(vase);
    vase.slab(hole(-0.12), hole(-0.1));
    vase.slab(top(0.5), top(0.9));
    const Building building = vase.read();
    EXPECT_NEAR(glassOf(building), 2.4, 1e-6);
    EXPECT_EQ(building.warnings.size(), 1u);
    Drawing greenhouse; // beside it: a room
    drawThickWalls(greenhouse);
    greenhouse.slab(hole(-0.12), hole(-0.1));
    greenhouse.slab(rectangle(6, 8, 0, 2, 0), rectangle(6, 8, 0, 2, 2));
    EXPECT_EQ(greenhouse.read().roomCount, 2u);
}

namespace {

size_t leftOut(const Building& building, const std::string& what) {
    return std::ranges::count_if(building.warnings, [&](const auto& warning) {
        return warning.starts_with(what) && warning.find("left out") != warning.npos;
    });
}

void drawUpright(Drawing& drawing, double x0, double x1, double z0, double z1, double y0) {
    drawing.slab(rectangle(x0, x1, y0, y0 + 1, z0), rectangle(x0, x1, y0, y0 + 1, z1));
}

} // namespace

// On the floor or in the air; two that meet at a corner share an edge.
TEST(GlassPanes, that_touch_others_with_their_rim_stand_free) {
    for (const double y : {0.0, 0.5})
        for (const bool two : {false, true}) {
            Drawing drawing;
            drawThickWalls(drawing);
            drawing.slab(hole(-0.12), hole(-0.1));
            drawUpright(drawing, 1, 1.01, 1, 2, y);
            if (two) drawUpright(drawing, 1.01, 2, 1, 1.01, y);
            const Building building = drawing.read();
            EXPECT_EQ(building.roomCount, 1u);
            EXPECT_NEAR(glassOf(building), 2.4 + 2 * (two ? 1.99 : 1), 0.01);
            EXPECT_NEAR(glassOf(building, true), 2.4, 1e-6);
            EXPECT_TRUE(building.warnings.empty()) << fmt::format("{}", fmt::join(building.warnings, "; "));
        }
}

TEST(GlassPanes, that_cannot_stand_free_are_left_out) {
    const auto read = [](const auto& draw) {
        Drawing drawing;
        drawThickWalls(drawing);
        drawing.slab(hole(-0.12), hole(-0.1));
        draw(drawing);
        return drawing.read();
    };
    EXPECT_EQ(leftOut(read([](Drawing& d) { d.slab(hole(3), hole(2.99)); }), "1 body of glass"),
              1u);                          // a mirror
    EXPECT_EQ(leftOut(read([](Drawing& d) { // through one another
                          drawUpright(d, 1, 2, 1.5, 1.51, 0.5);
                          drawUpright(d, 1.5, 1.51, 1, 2, 0.5);
                      }),
                      "2 bodies of glass"),
              1u);
    const Building outside = read([](Drawing& d) { // between the room and another, in the open
        drawUpright(d, 6, 7, 1, 1.01, 0);
        drawUpright(d, 1, 2, 1, 1.01, 0);
        d.face("glass", rectangle(8, 9, 0, 1, 0));
        d.face("wall", turned(rectangle(8, 9, 0, 1, 1)));
        d.tube("wall", turned(rectangle(8, 9, 0, 1, 0)), turned(rectangle(8, 9, 0, 1, 1)));
    });
    EXPECT_EQ(outside.roomCount, 2u);
    EXPECT_EQ(leftOut(outside, "1 body of glass"), 1u);
    EXPECT_NEAR(glassOf(outside), 2.4 + 1 + 2, 0.01);
}

// They are made by the program: none of them looks the wrong way. A chamfer changes nothing.
TEST(GlassPanes, no_face_is_said_to_be_turned_over) {
    for (const bool over : {false, true}) {
        Drawing drawing;
        drawRoom(drawing, 0, 3);
        const std::vector<Corners> outlines{hole(-0.01, 0.02), hole(-0.005, 0.03), hole(0.005, 0.03),
                                            hole(0.01, 0.02)};
        drawing.face("glass", over ? turned(outlines[0]) : outlines[0]);
        for (size_t k = 0; k < 3; ++k) drawing.tube("glass", outlines[k], outlines[k + 1]);
        drawing.face("glass", over ? outlines[3] : turned(outlines[3]));
        const Building building = drawing.read();
        EXPECT_NEAR(glassOf(building), 2.4, 1e-6);
        EXPECT_EQ(building.repairs, std::vector<std::string>{"1 slab of glass taken as a pane"});
    }
}

// 5 cm of joint are a gap that light comes in by.
TEST(GlassPanes, that_leave_a_gap_are_refused) {
    Drawing drawing;
    drawRoom(drawing, 0, 3);
    drawing.slab(hole(-0.01, -0.05), hole(0.01, -0.05));
    EXPECT_THROW(drawing.read(), InputError);
}

TEST(GlassPanes, slabs_through_the_wall_between_two_rooms_is_glass_on_both_sides) {
    Drawing drawing;
    drawRoom(drawing, 0, 3);
    drawRoom(drawing, -0.2, -3.2);
    drawing.slab(hole(-0.2), hole(0));
    expectPanes(drawing, 2, 4.8, 60);
}

// The space over a ceiling of glass is no solid, though it takes a piece out of a room.
TEST(GlassPanes, across_a_room_part_two_rooms) {
    const auto level = [](double y) { return Corners{{0, y, 0}, {0, y, 3}, {4, y, 3}, {4, y, 0}}; };
    Drawing drawing;
    drawThickWalls(drawing);
    drawing.slab(hole(-0.12), hole(-0.1));
    drawing.slab(level(2.1), level(2.12));
    expectPanes(drawing, 2, 2.4 + 2 * 12, 30 + 2.4 * 0.11, "2 slabs of glass taken as panes");
}

// Each of three panes takes its part of the light: what lies between two of them is no solid.
TEST(GlassPanes, three_behind_one_another) {
    for (const bool flat : {false, true}) {
        Drawing drawing;
        drawThickWalls(drawing);
        for (const double z : {-0.2, -0.15, -0.1}) {
            if (flat)
                drawing.face("glass", hole(z));
            else
                drawing.slab(hole(z - 0.002), hole(z + 0.002));
        }
        const Building building = drawing.read();
        EXPECT_EQ(building.roomCount, 1u);
        EXPECT_NEAR(glassOf(building), 2.4, 1e-6);
        EXPECT_NEAR(glassOf(building, true), 2.4, 1e-6);
        EXPECT_NEAR(volume(meshBuilding(building, {500})), 30 + 2.4 * 0.1, 1e-4);
        EXPECT_TRUE(building.warnings.empty()) << fmt::format("{}", fmt::join(building.warnings, "; "));
    }
}

// But the inside of a wall between two rooms with a pane on each side, drawn without the sides of the hole,
// is.
TEST(GlassPanes, on_both_sides_of_a_wall_are_one) {
    Drawing drawing;
    drawing.face("wall", whole(0));
    drawing.face("wall", turned(whole(6.2)));
    drawing.tube("wall", turned(whole(0)), turned(whole(6.2)));
    drawing.ring(turned(whole(3)), turned(hole(3)));
    drawing.face("glass", turned(hole(3)));
    drawing.ring(whole(3.2), hole(3.2));
    drawing.face("glass", hole(3.2));
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 2u);
    EXPECT_NEAR(glassOf(building), 4.8, 1e-6);
    EXPECT_NEAR(glassOf(building, true), 0, 1e-6);
}

namespace {

// A room of 30 m3 whose wall at z = 0 is drawn in cells between these x and y; `open` of a cell's middle.
template<class Open>
void drawRoomOfCells(Drawing& drawing, const std::vector<double>& x, const std::vector<double>& y,
                     const Open& open) {
    for (size_t i = 0; i + 1 < x.size(); ++i)
        for (size_t j = 0; j + 1 < y.size(); ++j)
            if (!open(0.5 * (x[i] + x[i + 1]), 0.5 * (y[j] + y[j + 1])))
                drawing.face("wall", rectangle(x[i], x[i + 1], y[j], y[j + 1], 0));
    drawing.face("wall", turned(whole(3)));
    drawing.tube("wall", turned(whole(0)), turned(whole(3)));
}

} // namespace

// What lies between the arms is no part of the pane: a hole there is open.
TEST(GlassPanes, in_the_shape_of_an_L) {
    for (const bool another : {false, true}) {
        Drawing drawing;
        drawRoomOfCells(drawing, {0, 1, 2, 2.2, 2.4, 3, 4}, {0, 0.5, 1, 1.2, 1.4, 2, 2.5},
                        [&](double x, double y) {
                            const bool foot = x > 1 && x < 3 && y > 0.5 && y<1, stem = x> 1 && x < 2 &&
                                              y > 1 && y<2, between = x> 2.2 && x < 2.4 && y > 1.2 && y < 1.4;
                            return foot || stem || (another && between);
                        });
        const auto outline = [](double z) {
            return Corners{{0.99, 0.49, z}, {3.01, 0.49, z}, {3.01, 1.01, z},
                           {2.01, 1.01, z}, {2.01, 2.01, z}, {0.99, 2.01, z}};
        };
        drawing.face("glass", outline(0.01));
        drawing.face("glass", turned(outline(-0.01)));
        for (size_t k = 0; k < 6; ++k)
            drawing.face("glass", {outline(-0.01)[k], outline(-0.01)[(k + 1) % 6], outline(0.01)[(k + 1) % 6],
                                   outline(0.01)[k]});
        if (another)
            EXPECT_THROW(drawing.read(), InputError);
        else
            expectPanes(drawing, 1, 2, 30);
    }
}

// No pane: a block whose sides are far apart, one with a side that leans.
TEST(GlassPanes, other_bodies_of_glass_stay_as_they_were_drawn) {
    for (const Corners& other : {rectangle(1, 3, 0.8, 2, 0.5), rectangle(1.1, 3, 0.8, 2, 0.2)}) {
        Drawing drawing;
        drawRoom(drawing, 0, 3);
        drawing.slab(hole(0), other);
        const Building building = drawing.read();
        EXPECT_GT(glassOf(building), 2.4 * 1.05); // with its sides
        EXPECT_TRUE(std::ranges::any_of(building.warnings, [](const auto& warning) {
            return warning.find("a space of its own") != warning.npos;
        }));
    }
}
