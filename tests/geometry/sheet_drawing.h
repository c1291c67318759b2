// Sheets beside a room of 4 by 5 by 2.5 m with a window at z = 0, drawn as a model.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <tuple>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "geometry/mesher.h"
#include "geometry/model_file.h"
#include "tests/geometry/mesh_volume.h"

namespace heliodon::geometry {

using glm::dvec3;

class Drawing {
public:
    double deep = 5;                 // rooms are
    double turned = 0;               // radians, about the vertical
    bool twoSided = false;           // each face once a side
    bool triangles = false;          // as most programs write
    const char* floor = "wall";      // the material of rooms' floors
    std::function<bool()> turnsFace; // asked for each

    // All faces turned over: drawn to be seen from outside, as some programs do. In so many units a metre.
    explicit Drawing(bool over, double units = 1) : over_(over), units_(units) {
        std::ofstream(testing::TempDir() + name_ + ".mtl")
            << "newmtl wall\nKd .6 .6 .6\nnewmtl paint\nKd .1 .2 .3\nnewmtl glass\nTf .8 .8 .8\nNi 1.52\n";
        out_ << "mtllib " << name_ << ".mtl\n";
    }
    ~Drawing() {
        for (const char* ending : {".mtl", ".obj"})
            std::filesystem::remove(testing::TempDir() + name_ + ending);
    }
    Drawing(const Drawing&) = delete;
    Drawing& operator=(const Drawing&) = delete;

    void object(const char* name) { out_ << "o " << name << '\n'; }

    void face(const char* material, std::vector<dvec3> corners) {
        if (triangles && corners.size() > 3) {
            for (size_t k = 1; k + 1 < corners.size(); ++k)
                face(material, {corners[0], corners[k], corners[k + 1]});
            return;
        }
        if (over_ != (turnsFace && turnsFace())) std::ranges::reverse(corners);
        out_ << "usemtl " << material << '\n';
        for (const dvec3& corner : corners) {
            const double c = std::cos(turned), s = std::sin(turned);
            const dvec3 p =
                units_ * dvec3(c * corner.x + s * corner.z, corner.y, c * corner.z - s * corner.x);
            out_ << fmt::format("v {:.9g} {:.9g} {:.9g}\n", p.x, p.y, p.z);
        }
        out_ << "f";
        for (size_t k = 0; k < corners.size(); ++k) out_ << ' ' << next_++;
        if (twoSided) {
            out_ << "\nf";
            for (int k = 1; k <= static_cast<int>(corners.size()); ++k) out_ << ' ' << next_ - k;
        }
        out_ << '\n';
    }
    // By corner and edges, that look in: floor, ceiling, left, right, back, front.
    static std::array<std::array<dvec3, 3>, 6> sidesOf(dvec3 o, dvec3 size) {
        const dvec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
        return {{{o, z, x}, {o + y, x, z}, {o, y, z}, {o + x, z, y}, {o + z, y, x}, {o, x, y}}};
    }

    // Looks along u x v.
    void sheet(dvec3 o, dvec3 u, dvec3 v, const char* material = "wall") {
        face(material, {o, o + u, o + u + v, o + v});
    }

    // sidesOf(), each smaller by `gap` all round, without that of number `without`.
    void room(double left, int without, bool window, double gap = 0, double base = 0, double sill = 0.8) {
        const dvec3 o(left, base, 0), x(4, 0, 0), y(0, 2.5, 0);
        const auto sides = sidesOf(o, {4, 2.5, deep});
        for (int k = 0; k < (window ? 5 : 6); ++k) {
            const auto [at, u, v] = sides[static_cast<size_t>(k)];
            const dvec3 du = gap * glm::normalize(u), dv = gap * glm::normalize(v);
            if (k != without) sheet(at + du + dv, u - 2.0 * du, v - 2.0 * dv, k == 0 ? floor : "wall");
        }
        if (!window) return;
        const std::array<dvec3, 4> wall{o, o + x, o + x + y, o + y},
            pane{o + dvec3(1, sill, 0), o + dvec3(3, sill, 0), o + dvec3(3, 2, 0), o + dvec3(1, 2, 0)};
        for (size_t k = 0; k < 4; ++k) face("wall", {wall[k], wall[(k + 1) % 4], pane[(k + 1) % 4], pane[k]});
        face("glass", {pane.begin(), pane.end()});
    }

    Building read(std::optional<double> worldPerBuilding = {}) {
        const std::string file = testing::TempDir() + name_ + ".obj";
        std::ofstream(file) << out_.str();
        return importModel(file, UpAxis::y, {.worldPerBuilding = worldPerBuilding});
    }

private:
    static inline int made_ = 0;
    const std::string name_ = fmt::format("sheets-{}-{}", getpid(), made_++); // tests run beside one another
    std::ostringstream out_;
    bool over_;
    double units_;
    int next_ = 1;
};

inline void ground(Drawing& drawing, double y = 0) {
    drawing.sheet({-20, y, -20}, {0, 0, 45}, {44, 0, 0});
}

// With a gate, on the ground.
inline void fence(Drawing& drawing, double height) {
    ground(drawing);
    const dvec3 up(0, height, 0), x(1, 0, 0), z(0, 0, 1);
    drawing.sheet({-6, 0, -6}, 16.0 * x, up), drawing.sheet({-6, 0, 11}, 16.0 * x, up);
    drawing.sheet({-6, 0, -6}, 17.0 * z, up);
    drawing.sheet({10, 0, -6}, 7.0 * z, up), drawing.sheet({10, 0, 2}, 9.0 * z, up);
}

inline void solid(Drawing& drawing, dvec3 o, dvec3 size, bool looksIn = false) {
    const dvec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    for (const auto& [at, u, v] : {std::tuple(o, x, z), std::tuple(o + y, z, x), std::tuple(o, y, x),
                                   std::tuple(o, z, y), std::tuple(o + x, y, z), std::tuple(o + z, x, y)})
        looksIn ? drawing.sheet(at, v, u) : drawing.sheet(at, u, v);
}

// Round 4 by 2.5 by 5 m, running into one another, with a pane in the middle of its wall.
inline void solidWalls(Drawing& drawing) {
    for (const auto& [low, high] : {std::pair<dvec3, dvec3>({-0.2, -0.2, -0.2}, {4.2, 0, 5.2}),
                                    {{-0.2, 2.5, -0.2}, {4.2, 2.7, 5.2}},
                                    {{-0.2, -0.1, -0.2}, {0, 2.6, 5.2}},
                                    {{4, -0.1, -0.2}, {4.2, 2.6, 5.2}},
                                    {{-0.1, -0.1, 5}, {4.1, 2.6, 5.2}},
                                    {{-0.1, -0.1, -0.2}, {1, 2.6, 0}},
                                    {{3, -0.1, -0.2}, {4.1, 2.6, 0}},
                                    {{0.9, -0.1, -0.2}, {3.1, 0.8, 0}},
                                    {{0.9, 2, -0.2}, {3.1, 2.6, 0}}})
        solid(drawing, low, high - low);
    drawing.face("glass", {{1, 0.8, -0.1}, {3, 0.8, -0.1}, {3, 2, -0.1}, {1, 2, -0.1}});
}

inline void solidGround(Drawing& drawing, bool looksIn = false) { // up to y = 0
    solid(drawing, {-20, -3, -20}, {44, 3, 45}, looksIn);
}

inline void attic(Drawing& drawing) { // one gable is open
    drawing.sheet({0, 2.5, 0}, {4, 0, 0}, {0, 1.5, 2.5}),
        drawing.sheet({0, 2.5, 5}, {4, 0, 0}, {0, 1.5, -2.5});
    drawing.face("wall", {{0, 2.5, 0}, {0, 2.5, 5}, {0, 4, 2.5}});
}

inline void expectOutside(Drawing& drawing, const std::string& what, const std::string& count,
                          bool shades = true) {
    SCOPED_TRACE(what);
    const Building building = drawing.read();
    EXPECT_EQ(building.roomCount, 1u);
    EXPECT_NEAR(volume(meshBuilding(building, {300})), 50, 1e-4);
    EXPECT_EQ(building.outside.triangles.empty(), !shades);
    EXPECT_TRUE(std::ranges::any_of(building.warnings, [&](const std::string& warning) {
        return warning.starts_with(count + " open face") &&
               warning.find("stand outside") != std::string::npos;
    }));
}

using Sheets = std::function<void(Drawing&)>;

} // namespace heliodon::geometry
