// Panes on the two sides of walls: as the file says, or as they stand.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/glass_mark.h"
#include "geometry/input_error.h"
#include "geometry/mesher.h"
#include "geometry/model_file.h"
#include "geometry/twin_faces.h"
#include "tests/geometry/mesh_volume.h"

using namespace heliodon::geometry;

namespace {

// Two rooms 0.2 m apart with panes in the wall between from each of `panes` on, 1 m wide, 1.2 m high and on
// the far side `height`; there the wall under them is in two parts.
std::string twoRoomsWithPanes(double height, const std::vector<double>& panes = {1}) {
    const std::string file = testing::TempDir() + "panes.obj";
    std::ofstream(std::string(testing::TempDir()) + "panes.mtl")
        << "newmtl wall\nKd 0.5 0.5 0.5\nnewmtl glass\nKd 0 0 0\nTf 0.8 0.8 0.8\nNi 1.52\n";
    std::ofstream out(file);
    out << "mtllib panes.mtl\n";
    int next = 1;
    const auto face = [&](const char* material, const std::vector<glm::dvec3>& corners) {
        for (const glm::dvec3& p : corners) out << fmt::format("v {:.9g} {:.9g} {:.9g}\n", p.x, p.y, p.z);
        out << "usemtl " << material << "\nf";
        for (size_t k = 0; k < corners.size(); ++k) out << ' ' << next++;
        out << '\n';
    };
    for (const bool far : {false, true}) {
        const double x = far ? 4.2 : 4, end = far ? 8 : 0, top = far ? 0.8 + height : 2;
        const auto wall = [&](double y0, double y1, double z0, double z1, const char* material = "wall") {
            face(material, {{x, y0, z0}, {x, y1, z0}, {x, y1, z1}, {x, y0, z1}});
        };
        wall(0, 0.8, 0, far ? 1.5 : 3);
        if (far) wall(0, 0.8, 1.5, 3);
        double to = 0; // of the pane before
        for (const double z : panes) {
            wall(0.8, top, to, z);
            wall(0.8, top, z, z + 1, "glass");
            to = z + 1;
        }
        wall(0.8, top, to, 3);
        wall(top, 2.5, 0, 3);
        face("wall", {{end, 0, 0}, {end, 2.5, 0}, {end, 2.5, 3}, {end, 0, 3}});
        for (const double y : {0.0, 2.5}) face("wall", {{x, y, 0}, {end, y, 0}, {end, y, 3}, {x, y, 3}});
        for (const double z : {0.0, 3.0}) face("wall", {{x, 0, z}, {end, 0, z}, {end, 2.5, z}, {x, 2.5, z}});
    }
    return file;
}

// One that says so; none where it is empty.
void expectWarning(const Building& building, const std::string& warning) {
    ASSERT_EQ(building.warnings.size(), warning.empty() ? 0u : 1u) << fmt::format("{}", building.warnings);
    for (const std::string& said : building.warnings)
        EXPECT_NE(said.find(warning), std::string::npos) << said;
}
std::string textOf(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

} // namespace

TEST(GlassPairs, panes_are_twins_though_only_one_has_a_corner_in_an_edge) {
    const Building building = importModel(twoRoomsWithPanes(1.2));
    EXPECT_EQ(building.roomCount, 2u);
    const PatchMesh mesh = meshBuilding(building, {800});
    double area = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        if (mesh.twin[i] == kNoTwin) continue;
        const auto j = static_cast<size_t>(mesh.twin[i]);
        area += patchArea(mesh, i);
        EXPECT_NEAR(glm::length(patchCentroid(mesh, i) - patchCentroid(mesh, j)), 0.2, 1e-9);
    }
    EXPECT_NEAR(area, 2 * 1.2, 1e-9);
    EXPECT_NEAR(volume(mesh), (4 + 3.8) * 2.5 * 3, 1e-9 * 58.5);
}

// What a file of our own says of its panes; in one that was changed since, numbers may be those of walls or
// of the window beside.
TEST(GlassPairs, panes_are_twins_as_the_file_says_or_where_it_cannot_be_so_as_they_stand) {
    const auto paired = [](const std::string& lines, const std::string& warning = "") {
        const std::string file = twoRoomsWithPanes(1.2, {0.3, 1.7}); // of 25 faces
        std::ofstream(file, std::ios::app) << lines << '\n';
        const Building building = importModel(file);
        expectWarning(building, warning);
        for (const Face& face : building.faces) {
            if (face.twin < 0) continue;
            const Face& other = building.faces[static_cast<size_t>(face.twin)];
            EXPECT_NEAR(glm::length(shiftBetween(building, face, other)), 0.2, 1e-6) << lines;
        }
        return std::ranges::count_if(building.faces, [](const Face& face) { return face.twin >= 0; });
    };
    EXPECT_EQ(paired("twins of 25"), 0);
    EXPECT_EQ(paired("twins of 25\ntwins 3 16"), 2);
    EXPECT_EQ(paired("twins of 25 3 16\ntwins 5 18"), 4);
    // Crosswise, named twice, walls, none at all.
    for (const char* pairs : {"3 18 5 16", "3 16 3 18", "1 11", "5 4000000000"})
        EXPECT_EQ(paired(fmt::format("twins of 25 {}", pairs), "no two sides of a wall"), 4) << pairs;
    // Of a file that had one window less, or none.
    for (const char* before : {"twins of 21 3 16", "twins of 17"})
        EXPECT_EQ(paired(before, "not 25: it was found by shape and place"), 4) << before;
    for (const char* bad : {"glass 4", "glass x 0 0 0", "glass 4 0 0", "glass 4 0 0 nan"})
        EXPECT_THROW(paired(fmt::format("twins of 25 {}", bad)), InputError) << bad;
    for (const char* bad : {"5", "0 5", "5 x", "-5 16", "1.5 16"})
        EXPECT_THROW(paired(fmt::format("twins of 25\ntwins {}", bad)), InputError) << bad;
    for (const char* bad : {"twins", "twins 3 16", "twins of", "twins of x", "twins of -1"})
        EXPECT_THROW(paired(bad), InputError) << bad;
}

// With as many faces as before.
TEST(GlassPairs, panes_are_twins_as_they_stand_where_walls_became_glass_since_the_file_was_written) {
    const std::string file = twoRoomsWithPanes(1.2, {0.3, 1.7}), glass = "usemtl glass";
    std::ofstream(testing::TempDir() + "panes.mtl", std::ios::app) << "newmtl shut\nKd 0.4 0.4 0.4\n";
    const std::string opened = textOf(file);
    std::string shut = opened; // the first pane of each room
    const size_t first = shut.find(glass), third = shut.find(glass, shut.find(glass, first + 1) + 1);
    for (const size_t at : {first, third}) shut.replace(at, glass.size(), "usemtl shut "); // as long
    std::ofstream(file) << shut;
    const PatchMesh faces = readPatches(file);
    std::vector<size_t> glassFaces;
    for (size_t f = 0; f < faces.patchCount(); ++f)
        if (faces.materials[faces.material[f]].isOpening()) glassFaces.push_back(f);
    const auto [panes, place, checksum] =
        glassMark(faces.vertices, faces.corners, faces.firstCorner, glassFaces);
    EXPECT_EQ(panes, 2u);
    const auto paired = [&](const std::string& model, const std::string& warning) {
        std::ofstream(file) << model
                            << fmt::format("twins of 25 glass {} {} {} {}\ntwins 5 18\n", panes, place.x,
                                           place.y, place.z);
        const Building building = importModel(file);
        expectWarning(building, warning);
        return std::ranges::count_if(building.faces, [](const Face& face) { return face.twin >= 0; });
    };
    EXPECT_EQ(paired(shut, ""), 2);
    EXPECT_EQ(paired(opened, "it is of 2 panes, not 4"), 4);
}

// Upright panes 0.1 m wide in rows on two walls of a hall of 20 by 8 by 12 m, as many on each.
struct HallOfPanes {
    std::vector<glm::dvec3> vertices{{0, 0, 0}, {20, 8, 12}, {20, 0, 0}}; // the hall's own face
    std::vector<uint32_t> corners{0, 1, 2}, firstCorner{0, 3};
    std::vector<size_t> panes;

    HallOfPanes() {
        for (uint32_t k = 0; k < 2000; ++k) {
            const glm::dvec3 at(0.15 * (k / 2 % 125) + 0.3, k / 250 + 0.2, k % 2 * 12);
            for (const glm::dvec3 d : {glm::dvec3(0, 0, 0), {0.1, 0, 0}, {0.1, 0.7, 0}, {0, 0.7, 0}}) {
                corners.push_back(static_cast<uint32_t>(vertices.size()));
                vertices.push_back(at + d);
            }
            panes.push_back(firstCorner.size() - 1);
            firstCorner.push_back(static_cast<uint32_t>(corners.size()));
        }
    }

    GlassMark mark() const { return glassMark(vertices, corners, firstCorner, panes); }
    template<class Move> HallOfPanes moved(Move move) const {
        HallOfPanes out = *this;
        for (glm::dvec3& p : out.vertices) p = move(p);
        return out;
    }
    // Of the pane's four corners.
    HallOfPanes with(size_t pane, glm::dvec3 shift) const {
        HallOfPanes out = *this;
        for (uint32_t c = firstCorner[panes[pane]]; c < firstCorner[panes[pane] + 1]; ++c)
            out.vertices[corners[c]] += shift;
        return out;
    }
};

TEST(GlassMark, one_pane_of_two_thousand_that_moved_is_seen) {
    const HallOfPanes hall;
    const GlassMark mark = hall.mark();
    ASSERT_EQ(mark.panes, 2000u);
    for (const size_t pane : {0u, 1u, 777u, 1999u})
        for (const glm::dvec3 shift : {glm::dvec3(0.05, 0, 0), {0, -0.05, 0}, {0, 0, 0.05}})
            EXPECT_FALSE(hall.with(pane, shift).mark().agrees(mark)) << pane;
    HallOfPanes turned = hall; // the file has them in another order
    std::ranges::swap(turned.panes[3], turned.panes[1500]);
    EXPECT_FALSE(turned.mark().agrees(mark));
}

TEST(GlassMark, rounding_and_other_axes_change_nothing) {
    const HallOfPanes hall;
    const GlassMark mark = hall.mark();
    const auto rounded = [](glm::dvec3 p) { // on a table 0.2 m across, off the origin
        return glm::round((p / 100.0 + glm::dvec3(0.31234567, 0, -2)) * 1e6) / 1e6;
    };
    EXPECT_TRUE(hall.moved(rounded).mark().agrees(mark));
    const auto swapped = [](glm::dvec3 p) { return glm::dvec3(p.x, -p.z, p.y); };
    EXPECT_TRUE(hall.moved(swapped).mark().agrees(mark));
    EXPECT_FALSE(hall.with(777, {0, 0.05, 0}).moved(swapped).mark().agrees(mark));
}

TEST(GlassMark, those_of_older_files_hold_by_panes_and_place) {
    const HallOfPanes hall;
    const std::vector<double> numbers = numbersOf(hall.mark());
    ASSERT_EQ(numbers.size(), 7u);
    const auto older = glassMark(std::span(numbers).first(4)), same = glassMark(numbers);
    ASSERT_TRUE(older && same);
    EXPECT_FALSE(older->checksum);
    EXPECT_TRUE(older->agrees(hall.mark()));
    EXPECT_TRUE(same->agrees(hall.mark()));
    EXPECT_FALSE(older->agrees(hall.moved([](glm::dvec3 p) { return p.z > 11 ? p + 0.1 : p; }).mark()));
    for (const size_t count : {0u, 3u, 5u, 6u}) EXPECT_FALSE(glassMark(std::span(numbers).first(count)));
}

TEST(GlassPairs, panes_are_twins_as_they_stand_where_rooms_were_moved_since_the_file_was_written) {
    const std::string file = twoRoomsWithPanes(1.2, {0.3, 1.7});
    const PatchMesh mesh = meshBuilding(importModel(file), {200});
    const auto halves = std::ranges::count_if(mesh.twin, [](int32_t twin) { return twin != kNoTwin; });
    ASSERT_GE(halves, 4);
    writeModel(mesh, file);
    const std::string text = textOf(file);
    const auto paired = [&](const auto& moved, const std::string& warning) {
        std::istringstream lines(text);
        std::string out;
        for (std::string line; std::getline(lines, line);) {
            glm::dvec3 p{0};
            out += std::sscanf(line.c_str(), "v %lf %lf %lf", &p.x, &p.y, &p.z) == 3 ? moved(p) : line;
            out += '\n';
        }
        std::ofstream(file) << out;
        const Building building = importModel(file);
        expectWarning(building, warning);
        return std::ranges::count_if(building.faces, [](const Face& face) { return face.twin >= 0; });
    };
    for (const double shift : {-0.1, 0.05, 2.0}) { // of the far room; 2 m are no wall
        const auto moved = [&](glm::dvec3 p) {
            return fmt::format("v {} {} {}", p.x > 4.1 ? p.x + shift : p.x, p.y, p.z);
        };
        EXPECT_EQ(paired(moved, "the glass stood elsewhere in the model"), shift < 1 ? halves : 0) << shift;
    }
    // All of it is where it was: six decimals of metres on the table, off the origin.
    const auto rounded = [](glm::dvec3 p) {
        return fmt::format("v {:.6f} {:.6f} {:.6f}", p.x / 12 + 5, p.y / 12, p.z / 12 - 2);
    };
    EXPECT_EQ(paired(rounded, ""), halves);
}

TEST(GlassPairs, panes_that_are_nearly_opposite_are_reported_whether_the_file_names_them_or_not) {
    const auto reported = [](double height, const char* line) {
        const std::string file = twoRoomsWithPanes(height, {0.3, 1.7});
        std::ofstream(file, std::ios::app) << line << '\n';
        const Building building = importModel(file);
        expectWarning(building, "");
        return std::ranges::count(building.repairs,
                                  "2 panes taken as one with what is nearly opposite in the wall");
    };
    for (const char* line : {"", "twins of 25 3 16 5 18"}) {
        EXPECT_EQ(reported(1.2, line), 0) << line;
        EXPECT_EQ(reported(1.15, line), 1) << line;
    }
}

TEST(GlassPairs, panes_are_twins_as_a_gltf_says) {
    const std::string file = testing::TempDir() + "panes.glb";
    const PatchMesh mesh = meshBuilding(importModel(twoRoomsWithPanes(1.2, {0.3, 1.7})), {200});
    writeModel(mesh, file);
    std::ifstream in(file, std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(in), {});
    const auto wordAt = [&](size_t at) {
        uint32_t word = 0;
        std::memcpy(&word, bytes.data() + at, sizeof word);
        return word;
    };
    const size_t end = 20 + wordAt(12);
    nlohmann::json root = nlohmann::json::parse(bytes.substr(20, end - 20));
    const nlohmann::json twins = root["asset"]["extras"]["twins"];
    ASSERT_EQ(twins["of"], mesh.patchCount());
    const auto all = static_cast<ptrdiff_t>(twins["pairs"].size());
    ASSERT_GE(all, 8);
    const auto paired = [&](const nlohmann::json& said, const std::string& warning = "") {
        root["asset"]["extras"]["twins"] = said;
        std::string text = root.dump();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        std::string out = bytes.substr(0, 20) + text + bytes.substr(end);
        const auto size = static_cast<uint32_t>(out.size()), length = static_cast<uint32_t>(text.size());
        std::memcpy(out.data() + 8, &size, sizeof size);
        std::memcpy(out.data() + 12, &length, sizeof length);
        std::ofstream(file, std::ios::binary) << out;
        const Building building = importModel(file);
        expectWarning(building, warning);
        return std::ranges::count_if(building.faces, [](const Face& face) { return face.twin >= 0; });
    };
    EXPECT_EQ(paired(twins), all);
    const auto with = [&](const char* key, const nlohmann::json& value) {
        nlohmann::json out = twins;
        out[key] = value;
        return out;
    };
    EXPECT_EQ(paired(with("pairs", nlohmann::json::array())), 0);
    nlohmann::json pairs = {static_cast<double>(twins["pairs"][0]), static_cast<double>(twins["pairs"][1])};
    EXPECT_EQ(paired(with("pairs", pairs)), 2); // 12.0
    EXPECT_EQ(paired(with("of", 12), "it is of 12 faces"), all);
    nlohmann::json older = twins;
    older.erase("glass");
    EXPECT_EQ(paired(older), all);
    nlohmann::json glass = twins["glass"];
    glass[3] = static_cast<double>(glass[3]) + 1e-3;
    EXPECT_EQ(paired(with("glass", glass), "the glass stood elsewhere"), all);
    for (const char* bad : {"4", "[4, 0, 0]", "[4.5, 0, 0, 0]", R"([4, 0, 0, "x"])"})
        EXPECT_THROW(paired(with("glass", nlohmann::json::parse(bad))), InputError) << bad;
    pairs = {twins["pairs"][0], twins["pairs"][1], twins["pairs"][0], twins["pairs"][3]};
    EXPECT_EQ(paired(with("pairs", pairs), "no two sides of a wall"), all);
    for (const char* bad : {"[1]", R"([1, "2"])", "[1, -2]", "[1, 2.5]", R"("1 2")", "3"})
        EXPECT_THROW(paired(with("pairs", nlohmann::json::parse(bad))), InputError) << bad;
    for (const char* bad : {"false", "[1, 2]", R"({"pairs": [1, 2]})", R"({"of": -1})", R"({"of": "x"})"})
        EXPECT_THROW(paired(nlohmann::json::parse(bad)), InputError) << bad;
}

TEST(GlassPairs, panes_of_different_shapes_in_one_wall_are_refused_by_name) {
    try {
        importModel(twoRoomsWithPanes(1.0));
        ADD_FAILURE() << "light would be lost between the panes";
    } catch (const InputError& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find("other side of its wall"), std::string::npos) << text;
        EXPECT_NE(text.find("panes.obj:"), std::string::npos) << text;
        EXPECT_NE(text.find("also"), std::string::npos) << text; // both panes
    }
}
