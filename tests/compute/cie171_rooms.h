// Rooms of cases after CIE 171:2006. 4 x 4 x 3 m; sensors exactly on walls, floor and ceiling; black but
// where said. x east, y up, z south: z = 0 is the wall to the north, openings of facades are in z = 4.
#pragma once

#include <array>
#include <map>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "compute/daylight/glazing.h"
#include "compute/sensor_gather.h"
#include "geometry/patch_mesh.h"
#include "tests/daylight/csv.h"

namespace heliodon::test::cie171 {

using compute::Sensor;
using glm::dvec3;

enum Matter : uint32_t { black, opening, lamp };

struct Hall {
    geometry::PatchMesh mesh;
    Hall() {
        mesh.materials = {{"black"}, {"opening", glm::vec3(0), glm::vec3(1), 1}, {"lamp"}};
        mesh.materials[lamp].exitance = glm::vec3(1);
    }
    // A rectangle with its front to u x v.
    void add(dvec3 corner, dvec3 u, dvec3 v, Matter matter = black) {
        const auto first = static_cast<uint32_t>(mesh.vertices.size());
        for (const dvec3& p : {corner, corner + u, corner + u + v, corner + v}) mesh.vertices.push_back(p);
        const std::array corners{first, first + 1, first + 2, first + 3};
        mesh.addPatch(corners, matter, geometry::Role::projection, first, 0);
    }
    // The same with a hole from `low` to `high` (shares of u and v), filled or left free.
    void frame(dvec3 corner, dvec3 u, dvec3 v, glm::dvec2 low, glm::dvec2 high,
               const Matter* hole = nullptr) {
        const auto part = [&](double u0, double u1, double v0, double v1, Matter matter) {
            if (u1 > u0 && v1 > v0) add(corner + u0 * u + v0 * v, (u1 - u0) * u, (v1 - v0) * v, matter);
        };
        part(0, 1, 0, low.y, black);
        part(0, 1, high.y, 1, black);
        part(0, low.x, low.y, high.y, black);
        part(high.x, 1, low.y, high.y, black);
        if (hole) part(low.x, high.x, low.y, high.y, *hole);
    }
    void floor(Matter m = black) { add({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, m); }
    void ceiling() { add({0, 3, 0}, {4, 0, 0}, {0, 0, 4}); }
    void north() { add({0, 0, 0}, {4, 0, 0}, {0, 3, 0}); }
    void sides() {
        add({0, 0, 0}, {0, 3, 0}, {0, 0, 4});
        add({4, 0, 0}, {0, 0, 4}, {0, 3, 0});
    }
    void ceilingWith(double side, Matter matter) {
        const double low = 0.5 - side / 8, high = 0.5 + side / 8;
        frame({0, 3, 0}, {4, 0, 0}, {0, 0, 4}, {low, low}, {high, high}, &matter);
    }
    void south(glm::dvec2 low, glm::dvec2 high, const Matter* hole) { // in metres
        frame({0, 0, 4}, {0, 3, 0}, {4, 0, 0}, {low.y / 3, low.x / 4}, {high.y / 3, high.x / 4}, hole);
    }
};

inline constexpr Matter kOpening = opening, kLamp = lamp;
inline constexpr glm::dvec2 kSmallLow{1, 1}, kSmallHigh{3, 2}; // the opening of 2 x 1 m

inline Hall roof(double side) {
    Hall hall;
    hall.floor(), hall.north(), hall.sides();
    hall.south({0, 0}, {0, 0}, nullptr);
    hall.ceilingWith(side, opening);
    return hall;
}

inline Hall facade(bool small) {
    Hall hall;
    hall.floor(), hall.north(), hall.sides(), hall.ceiling();
    if (small)
        hall.south(kSmallLow, kSmallHigh, &kOpening);
    else
        hall.south({0, 0}, {4, 3}, &kOpening);
    return hall;
}

inline constexpr double kFar = 60; // metres to either side: as good as endless

// Outside belongs to the room: a porch under the mask, as high as the ceiling, open to the front and at its
// far ends.
inline Hall underMask(double width) {
    Hall hall;
    hall.floor(), hall.north(), hall.sides(), hall.ceiling();
    hall.south(kSmallLow, kSmallHigh, nullptr);
    const double left = 2 - kFar, all = 2 * kFar;
    hall.frame({left, 0, 4}, {all, 0, 0}, {0, 3, 0}, {(1 - left) / all, 1 / 3.0},
               {(3 - left) / all, 2 / 3.0});
    hall.add({left, 0, 4}, {0, 0, width}, {all, 0, 0});
    hall.add({left, 3, 4}, {all, 0, 0}, {0, 0, width});
    hall.add({left, 0, 4 + width}, {0, 3, 0}, {all, 0, 0}, opening);
    hall.add({left, 0, 4}, {0, 3, 0}, {0, 0, width}, opening);
    hall.add({left + all, 0, 4}, {0, 0, width}, {0, 3, 0}, opening);
    return hall;
}

// A yard 6 m deep before a wall, open above at the wall's height.
inline Hall beforeMask(double height) {
    Hall hall;
    hall.floor(), hall.north(), hall.sides(), hall.ceiling();
    hall.south(kSmallLow, kSmallHigh, nullptr);
    const double left = 2 - kFar, all = 2 * kFar;
    hall.frame({left, 0, 4}, {all, 0, 0}, {0, height, 0}, {(1 - left) / all, 1 / height},
               {(3 - left) / all, 2 / height});
    hall.add({left, 0, 4}, {0, 0, 6}, {all, 0, 0});
    hall.add({left, height, 4}, {all, 0, 0}, {0, 0, 6}, opening);
    hall.add({left, 0, 10}, {0, height, 0}, {all, 0, 0});
    hall.add({left, 0, 4}, {0, height, 0}, {0, 0, 6}, opening);
    hall.add({left + all, 0, 4}, {0, 0, 6}, {0, height, 0}, opening);
    return hall;
}

inline Sensor sensorAt(double y, double z) {
    return {{2, z, y}, z == 0 ? dvec3(0, 1, 0) : z == 3 ? dvec3(0, -1, 0) : dvec3(0, 0, 1)};
}

struct Case {
    std::string test, opening;
    bool operator<(const Case& other) const {
        return std::tie(test, opening) < std::tie(other.test, other.opening);
    }
};

inline geometry::PatchMesh roomOf(const Case& c) {
    geometry::PatchMesh mesh;
    if (c.test == "5.13")
        mesh = underMask(std::stod(c.opening.substr(4))).mesh;
    else if (c.test == "5.14")
        mesh = beforeMask(std::stod(c.opening.substr(4))).mesh;
    else if (c.test == "5.9" || c.test.starts_with("5.10"))
        mesh = roof(c.opening == "4x4" ? 4 : 1).mesh;
    else
        mesh = facade(c.opening == "2x1").mesh;
    const bool clear = c.test.ends_with("clear");
    if (clear || c.test == "5.10" || c.test == "5.12") {
        mesh.materials[opening].refractiveIndex = 1.52f;
        mesh.materials[opening].transmittance =
            glm::vec3(clear ? static_cast<float>(daylight::maximumTransmittance(1.52)) : 0.88f);
    }
    return mesh;
}

// Of the table cie171.csv: rows by room, and the places of its sensors, each once.
using Cases = std::map<Case, std::vector<size_t>>;

inline Cases casesOf(const Csv& table) {
    Cases cases;
    for (size_t row = 0; row < table.rows.size(); ++row)
        cases[{table.text(row, "test"), table.text(row, "opening")}].push_back(row);
    return cases;
}

struct Places {
    std::vector<Sensor> sensors;
    std::map<size_t, size_t> sensorOfRow;

    Places(const Csv& table, const std::vector<size_t>& rows) {
        std::map<std::pair<double, double>, size_t> known;
        for (const size_t row : rows) {
            const double y = table.number(row, "y"), z = table.number(row, "z");
            const auto [at, fresh] = known.try_emplace({y, z}, sensors.size());
            if (fresh) sensors.push_back(sensorAt(y, z));
            sensorOfRow[row] = at->second;
        }
    }
};

inline bool hasGround(const Case& c) {
    return c.test.starts_with("5.11") || c.test.starts_with("5.12");
}

// The rooms of 5.3, 5.6 and 5.7, with the exitance of what gives light.
struct Source {
    std::string test;
    geometry::PatchMesh mesh;
};

// A body in the air: its faces look outwards.
inline void addBody(Hall& hall, dvec3 low, dvec3 high) {
    const dvec3 size = high - low, x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    hall.add(low, z, y), hall.add(low + x, y, z);
    hall.add(low, x, z), hall.add(low + y, z, x);
    hall.add(low, y, x), hall.add(low + z, x, y);
}

// The screen of 5.7 stands `clear` metres off floor and walls; at 0 its faces there are left out.
inline std::vector<Source> sources(double clear = 0) {
    const auto made = [](const char* test, Hall hall, double exitance) {
        hall.mesh.materials[lamp].exitance = glm::vec3(static_cast<float>(exitance));
        return Source{test, std::move(hall.mesh)};
    };
    Hall source;
    source.floor(), source.north(), source.sides();
    source.south({0, 0}, {0, 0}, nullptr);
    source.ceilingWith(1, lamp);

    Hall reflector;
    reflector.floor(lamp), reflector.north(), reflector.sides(), reflector.ceiling();
    reflector.south({0, 0}, {0, 0}, nullptr);

    Hall obstructed;
    obstructed.floor(), obstructed.north(), obstructed.sides(), obstructed.ceiling();
    obstructed.south({0, 0}, {4, 3}, &kLamp);
    if (clear > 0) {
        addBody(obstructed, {clear, clear, 2.5}, {4 - clear, 1, 2.7});
    } else { // sides and top
        obstructed.add({0, 0, 2.5}, {0, 1, 0}, {4, 0, 0});
        obstructed.add({0, 0, 2.7}, {4, 0, 0}, {0, 1, 0});
        obstructed.add({0, 1, 2.5}, {0, 0, 0.2}, {4, 0, 0});
    }
    return {made("5.3", source, 1000 * std::numbers::pi), made("5.6", reflector, 100),
            made("5.7", obstructed, 100)};
}

} // namespace heliodon::test::cie171
