// Models whose coordinates are rounded: what touched does so within that.
#include "geometry/last_decimal.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "geometry/input_error.h"
#include "tests/geometry/sheet_drawing.h"

namespace heliodon::geometry {

namespace {

class Rounded {
public:
    Rounded(double turn, double step) : turn_(turn), step_(step) {}

    // To single precision, that far from the origin.
    static Rounded single(double turn, double away) {
        Rounded out(turn, 0);
        out.away_ = away;
        return out;
    }

    // A turned room with a table and two cupboards; returns its volume.
    double furnished() {
        room();
        solid({1, 0.72, 2}, {1.2, 0.03, 0.7});
        for (const double x : {1.05, 2.1})
            for (const double z : {2.05, 2.6}) solid({x, 0, z}, {0.05, 0.72, 0.05});
        solid({0, 0, 1}, {0.6, 2, 0.6});
        solid({3.4, 0, 4.4}, {0.6, 2, 0.6});
        return 50 - 0.03 * 0.7 * 1.2 - 4 * 0.05 * 0.05 * 0.72 - 2 * 0.6 * 0.6 * 2;
    }

    void room(double gap = 0) {
        const std::array<dvec3, 4> wall{dvec3(0), {4, 0, 0}, {4, 2.5, 0}, {0, 2.5, 0}},
            pane{dvec3(1, 0.8, 0), {3, 0.8, 0}, {3, 2, 0}, {1, 2, 0}};
        const auto sides = Drawing::sidesOf(dvec3(0), {4, 2.5, 5});
        for (size_t k = 0; k < 5; ++k) {
            const auto& [o, u, v] = sides[k];
            const dvec3 off = k == 1 ? dvec3(0, gap, 0) : dvec3(0);
            face("wall", {o + off, o + u + off, o + u + v + off, o + v + off});
        }
        for (size_t k = 0; k < 4; ++k) face("wall", {wall[k], wall[(k + 1) % 4], pane[(k + 1) % 4], pane[k]});
        face("glass", {pane.begin(), pane.end()});
    }
    void solid(dvec3 low, dvec3 size) {
        for (const auto& [o, u, v] : Drawing::sidesOf(low, size)) face("wall", {o, o + v, o + u + v, o + u});
    }
    Building read() { return drawing_->read(); }
    // As a node far from the origin whose mesh says so, and that takes it back there and turns it.
    Building readGltf() const {
        const std::string stem = testing::TempDir() + fmt::format("last-decimal-{}", getpid());
        std::string json = R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "scene": 0,)";
        json += fmt::format(
            R"("nodes": [{{"mesh": 0, "rotation": [0, 0.6, 0, 0.8], "translation": [{}, 0, 3]}}],)",
            0.28 * -away_);
        std::string views, accessors, primitives;
        std::ofstream out(stem + ".bin", std::ios::binary);
        size_t at = 0;
        for (size_t m = 0; m < 2; ++m) {
            const auto& points = triangles_[m];
            out.write(reinterpret_cast<const char*>(points.data()),
                      static_cast<std::streamsize>(points.size() * sizeof points[0]));
            const char* comma = m == 0 ? "," : "";
            views += fmt::format(R"({{"buffer": 0, "byteOffset": {}, "byteLength": {}}}{})", at,
                                 12 * points.size(), comma);
            accessors +=
                fmt::format(R"({{"bufferView": {}, "componentType": 5126, "count": {}, "type": "VEC3"}}{})",
                            m, points.size(), comma);
            primitives +=
                fmt::format(R"({{"attributes": {{"POSITION": {}}}, "material": {}}}{})", m, m, comma);
            at += 12 * points.size();
        }
        json += fmt::format(R"("buffers": [{{"uri": "last-decimal-{}.bin", "byteLength": {}}}],
            "bufferViews": [{}], "accessors": [{}], "meshes": [{{"primitives": [{}]}}],)",
                            getpid(), at, views, accessors, primitives);
        json +=
            R"("materials": [{"name": "wall", "pbrMetallicRoughness": {"baseColorFactor": [0.6, 0.6, 0.6, 1]}},
            {"name": "glass", "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.8}}}],
            "extensionsUsed": ["KHR_materials_transmission"]})";
        out.close();
        std::ofstream(stem + ".gltf") << json;
        Building building = importModel(stem + ".gltf", UpAxis::y);
        for (const char* ending : {".gltf", ".bin"}) std::filesystem::remove(stem + ending);
        return building;
    }

private:
    void face(const char* material, std::vector<dvec3> corners) {
        for (dvec3& p : corners) {
            const dvec3 turned(std::cos(turn_) * p.x + std::sin(turn_) * p.z + 0.37, p.y + 0.123,
                               std::cos(turn_) * p.z - std::sin(turn_) * p.x);
            p = step_ > 0 ? step_ * glm::round(turned / step_)
                          : dvec3(glm::vec3(turned + dvec3(away_, 0, away_)));
        }
        auto& triangles = triangles_[material == std::string("glass")];
        for (size_t k = 1; k + 1 < corners.size(); ++k)
            for (const size_t corner : {size_t{0}, k, k + 1}) triangles.emplace_back(corners[corner]);
        drawing_->face(material, std::move(corners));
    }

    std::unique_ptr<Drawing> drawing_ = std::make_unique<Drawing>(false);
    std::array<std::vector<glm::vec3>, 2> triangles_; // of walls and glass
    double turn_, step_, away_ = 0;
};

bool saysRounded(const Building& building) {
    return std::ranges::any_of(building.warnings, [](const std::string& warning) {
        return warning.starts_with("coordinates are rounded to ");
    });
}

} // namespace

TEST(LastDecimal, is_that_of_all_coordinates) {
    const std::vector<dvec3> points{{1.253, -3.141, 0}, {0.5, 0.001, 2}},
        typed{{1.25, -3, 0}, {0.5, 0.001, 2}};
    EXPECT_NEAR(lastDecimal(points, 1e-6), 0.001, 1e-12);
    EXPECT_EQ(lastDecimal(typed, 1e-6), 0);
    EXPECT_EQ(lastDecimal(points, 0.002), 0);
    EXPECT_EQ(lastDecimal(std::vector{dvec3(2, 3, 4)}, 1e-6), 1);
    EXPECT_EQ(lastDecimal(std::vector{dvec3(1.0 / 3, 3, 4)}, 1e-6), 0);
    EXPECT_NEAR(lastDecimal(std::vector{dvec3(0.1f, 12.3f, 4)}, 1e-6), 0.1, 1e-12); // single precision
}

TEST(LastDecimal, bits_are_those_of_the_largest_coordinates) {
    std::vector<dvec3> far, exact, typed;
    for (int k = 0; k < 20; ++k) {
        exact.emplace_back(3000 + 0.137 * k, 0.3 * k, -4000 - 0.211 * k);
        far.emplace_back(glm::vec3(exact.back()));
        typed.emplace_back(4000 + k, 3, 4);
    }
    EXPECT_EQ(lastBit(far, 1e-6), std::ldexp(1.0, -12)); // 4000 to 24 bits
    EXPECT_EQ(lastBit(far, 1e-3), 0);
    EXPECT_EQ(lastBit(exact, 1e-6), 0);
    EXPECT_EQ(lastBit(typed, 1e-6), 0);
}

// As programs that keep single precision write a building which stands where its site is.
TEST(LastDecimal, rooms_far_from_the_origin_close_within_the_last_bit) {
    int told = 0;
    for (const double away : {1000.0, 4000.0})
        for (const double turn : {0.2, 0.5, 0.8, 1.1}) {
            SCOPED_TRACE(testing::Message() << away << ' ' << turn);
            Rounded model = Rounded::single(turn, away);
            const double meant = model.furnished();
            const Building building = model.read();
            EXPECT_EQ(building.roomCount, 1u);
            EXPECT_NEAR(volume(meshBuilding(building, {300})), meant, 1e-5 * away);
            told += saysRounded(building);
            EXPECT_NEAR(volume(meshBuilding(model.readGltf(), {300})), meant, 1e-5 * away);
        }
    EXPECT_GE(told, 2); // others close as they are
}

TEST(LastDecimal, rooms_that_close_though_the_last_bit_is_coarse_are_warned_of) {
    for (const auto& [away, step] : {std::pair(5000000.5, "to 0.5 m"), {1000.5, ""}}) {
        Drawing drawing(false);
        drawing.room(away, -1, true);
        const Building building = drawing.read();
        EXPECT_EQ(building.roomCount, 1u);
        ASSERT_EQ(building.warnings.size(), *step ? 1u : 0u) << away;
        for (const std::string& warning : building.warnings)
            EXPECT_NE(warning.find(step), std::string::npos) << warning;
    }
}

// .glb holds single precision.
TEST(LastDecimal, rooms_far_off_are_written_where_they_are) {
    Drawing drawing(false);
    drawing.room(0, -1, true), ground(drawing);
    const Building near = drawing.read();
    ASSERT_FALSE(near.outside.triangles.empty());
    for (const dvec3 away : {dvec3(5000000.3, 60, 400000.7), {0, 1000.3, 0}}) {
        Building far = near;
        for (dvec3& p : far.vertices) p += away;
        for (dvec3& p : far.outside.vertices) p += away;
        const PatchMesh mesh = meshBuilding(far, {300});
        const std::string file = testing::TempDir() + fmt::format("far-off-{}.glb", getpid());
        writeModel(mesh, file);
        const PatchMesh read = readPatches(file);
        const Building again = importModel(file);
        std::filesystem::remove(file);
        ASSERT_EQ(read.patchCount(), mesh.patchCount());
        for (size_t c = 0; c < mesh.corners.size(); ++c)
            EXPECT_LT(glm::distance(read.vertices[read.corners[c]], mesh.vertices[mesh.corners[c]]), 1e-6);
        ASSERT_EQ(again.outside.triangles.size(), far.outside.triangles.size());
        EXPECT_TRUE(again.warnings.empty()) << again.warnings[0];
        for (size_t c = 0; c < far.outside.triangles.size(); ++c) {
            const dvec3 of = again.outside.vertices[again.outside.triangles[c]];
            EXPECT_TRUE(std::ranges::any_of(far.outside.vertices,
                                            [&](dvec3 p) { return glm::distance(p, of) < 5e-6; }));
        }
    }
}

// A table, a cupboard against a wall and one in a corner, turned: their corners are off walls and floor.
TEST(LastDecimal, furniture_stands_on_floors_within_it) {
    int told = 0;
    for (const double step : {1e-3, 1e-4})
        for (const double turn : {0.2, 0.5, 0.8, 1.1}) {
            Rounded model(turn, step);
            const double meant = model.furnished();
            const Building building = model.read();
            EXPECT_EQ(building.roomCount, 1u);
            EXPECT_NEAR(volume(meshBuilding(building, {300})), meant, 30 * step);
            told += saysRounded(building);
        }
    EXPECT_GE(told, 4); // others close as they are
}

// Against a wall, or 5 mm sunk into it: only that is said.
TEST(LastDecimal, furniture_runs_into_walls_that_it_is_drawn_into) {
    for (int k = 1; k < 30; ++k)
        for (const bool sunk : {false, true}) {
            SCOPED_TRACE(testing::Message() << k << ' ' << sunk);
            Rounded model(0.05 * k, 1e-4);
            model.room();
            model.solid({sunk ? -0.005 : 0, 1.4, 1}, {0.4, 0.6, 0.7});
            model.solid({sunk ? 3.6 : 3.595, 0, 3}, {0.405, 2, 0.6});
            const Building building = model.read();
            EXPECT_NEAR(volume(meshBuilding(building, {300})),
                        50 - 0.6 * 0.7 * (sunk ? 0.395 : 0.4) - 2 * 0.6 * (sunk ? 0.4 : 0.405), 3e-3);
            EXPECT_EQ(std::ranges::any_of(building.warnings,
                                          [](const std::string& warning) {
                                              return warning.find(" through walls") != std::string::npos;
                                          }),
                      sunk);
        }
}

TEST(LastDecimal, gaps_that_are_wider_stay_open) {
    for (const auto& [step, gap] : {std::pair(1e-3, 0.004), {1e-4, 0.001}}) {
        Rounded model(0.3, step);
        model.room(gap);
        EXPECT_THROW(model.read(), InputError);
    }
}

} // namespace heliodon::geometry
