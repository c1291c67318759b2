// Rooms lit by slots: straight and curved slots in a ceiling, a slot along a wall that is much
// larger than its opposite, and a gap through a wall to another room.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/building.h"

namespace heliodon::test {

// Corners in one place are one.
inline void addFace(geometry::Building& building, const std::vector<std::vector<glm::dvec3>>& loops,
                    uint32_t surface, uint32_t material) {
    geometry::Face face;
    face.material = material, face.surface = surface;
    for (const auto& corners : loops) {
        face.loops.emplace_back();
        for (const glm::dvec3 p : corners) {
            const auto at = std::ranges::find(building.vertices, p);
            face.loops.back().push_back(static_cast<uint32_t>(at - building.vertices.begin()));
            if (at == building.vertices.end()) building.vertices.push_back(p);
        }
    }
    building.faces.push_back(std::move(face));
}

struct SlottedRoom {
    enum class Kind { straight, curved, alongWall, betweenRooms };
    static constexpr std::array kNames{"straight", "curved", "along a wall", "between rooms"};

    geometry::Building building;
    std::string name;
    double width = 0;                         // of the slot, metres
    std::function<bool(glm::dvec3)> isInSlot; // with its walls
    glm::dvec3 low{0}, high{0};               // of the room that the slot lights

    SlottedRoom(Kind kind, uint32_t seed) : random_(seed) {
        width = between(0.06, 0.2);
        deep_ = between(0.2, 0.6);
        building.materials.resize(3);
        for (int m : {0, 2})
            building.materials[m].reflectance = glm::vec3(static_cast<float>(between(0.3, 0.9)));
        building.materials[1].transmittance = glm::vec3(0.88F);
        building.roomCount = 1;
        const double x = between(3, 6), z = between(3, 6), y = between(2.4, 3.5);
        low = {0, 0, 0}, high = {x, y, z};
        switch (kind) {
        case Kind::straight:
            underSlot(straightOutline());
            break;
        case Kind::curved:
            underSlot(curvedOutline());
            break;
        case Kind::alongWall:
            alongWall();
            break;
        case Kind::betweenRooms:
            betweenRooms();
            break;
        }
        name = kNames[static_cast<size_t>(kind)] + std::string(" ") + std::to_string(width).substr(0, 4) +
               " x " + std::to_string(deep_).substr(0, 4);
    }

    double between(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }

private:
    struct Side {
        glm::dvec2 from; // x, z
        uint32_t surface;
    };

    void add(const std::vector<std::vector<glm::dvec3>>& loops, uint32_t surface, uint32_t material = 0) {
        addFace(building, loops, surface, material);
    }

    // Counter-clockwise in (x, z) as (right, down the plan): walls of an outline that air fills.
    void walls(const std::vector<Side>& outline, double y0, double y1, uint32_t first, uint32_t material) {
        for (size_t k = 0; k < outline.size(); ++k) {
            const glm::dvec2 a = outline[k].from, b = outline[(k + 1) % outline.size()].from;
            add({{{a.x, y0, a.y}, {b.x, y0, b.y}, {b.x, y1, b.y}, {a.x, y1, a.y}}},
                first + outline[k].surface, material);
        }
    }
    static std::vector<glm::dvec3> at(const std::vector<Side>& outline, double y, bool reversed) {
        std::vector<glm::dvec3> points;
        for (const Side& side : outline) points.emplace_back(side.from.x, y, side.from.y);
        if (reversed) std::ranges::reverse(points);
        return points;
    }

    std::vector<Side> box() const {
        return {{{low.x, low.z}, 0}, {{high.x, low.z}, 1}, {{high.x, high.z}, 2}, {{low.x, high.z}, 3}};
    }
    std::vector<Side> straightOutline() {
        const double x0 = between(0.2, 0.4) * high.x, x1 = between(0.6, 0.9) * high.x,
                     z0 = between(0.2, 0.7) * high.z;
        return {{{x0, z0}, 0}, {{x1, z0}, 1}, {{x1, z0 + width}, 2}, {{x0, z0 + width}, 3}};
    }
    // Part of a ring.
    std::vector<Side> curvedOutline() {
        const double radius = 0.3 * std::min(high.x, high.z), span = between(0.5, 1.5) * std::numbers::pi,
                     start = between(0, 2 * std::numbers::pi);
        const glm::dvec2 middle(0.5 * high.x, 0.5 * high.z);
        const int n = 16;
        std::vector<Side> outline;
        const auto ring = [&](double r, double t) {
            return middle + r * glm::dvec2(std::cos(start + t * span), std::sin(start + t * span));
        };
        for (int k = 0; k <= n; ++k)
            outline.push_back({ring(radius + width, double(k) / n), k < n ? 0U : 1U});
        for (int k = n; k >= 0; --k) outline.push_back({ring(radius, double(k) / n), k > 0 ? 2U : 3U});
        return outline;
    }
    void underSlot(const std::vector<Side>& slot) {
        const double top = high.y + deep_;
        add({at(box(), 0, true)}, 0);
        add({at(box(), high.y, false), at(slot, high.y, true)}, 1);
        walls(box(), 0, high.y, 2, 0);
        walls(slot, high.y, top, 6, 2);
        add({at(slot, top, false)}, 10, 1);
        isInSlot = [y = high.y](glm::dvec3 p) { return p.y > y + 1e-6; };
    }
    void alongWall() {
        const double top = high.y + deep_, w = width, y = high.y;
        const glm::dvec3 h = high;
        add({at(box(), 0, true)}, 0);
        add({{{0, y, w}, {h.x, y, w}, {h.x, y, h.z}, {0, y, h.z}}}, 1);
        add({{{0, 0, 0}, {h.x, 0, 0}, {h.x, top, 0}, {0, top, 0}}}, 2);
        add({{{h.x, 0, 0}, {h.x, 0, h.z}, {h.x, y, h.z}, {h.x, y, w}, {h.x, top, w}, {h.x, top, 0}}}, 3);
        add({{{h.x, 0, h.z}, {0, 0, h.z}, {0, y, h.z}, {h.x, y, h.z}}}, 4);
        add({{{0, 0, h.z}, {0, 0, 0}, {0, top, 0}, {0, top, w}, {0, y, w}, {0, y, h.z}}}, 5);
        add({{{h.x, y, w}, {0, y, w}, {0, top, w}, {h.x, top, w}}}, 6, 2);
        add({{{0, top, 0}, {h.x, top, 0}, {h.x, top, w}, {0, top, w}}}, 7, 1);
        isInSlot = [y, w](glm::dvec3 p) { return p.y > y && p.z < w + 1e-6; };
    }
    // A room with a window, x < 0, beside the one of `high`.
    void betweenRooms() {
        const glm::dvec3 h = high;
        const double z0 = between(0.2, 0.8) * h.z, z1 = z0 + width, x0 = -deep_, x1 = x0 - between(2.5, 5);
        const std::vector<Side> outline{{{0, 0}, 0},  {{h.x, 0}, 1}, {{h.x, h.z}, 2}, {{0, h.z}, 3},
                                        {{0, z1}, 4}, {{x0, z1}, 5}, {{x0, h.z}, 6},  {{x1, h.z}, 7},
                                        {{x1, 0}, 8}, {{x0, 0}, 9},  {{x0, z0}, 10},  {{0, z0}, 11}};
        add({at(outline, 0, true)}, 0);
        add({at(outline, h.y, false)}, 1);
        for (size_t k = 0; k < outline.size(); ++k) {
            const glm::dvec2 a = outline[k].from, b = outline[(k + 1) % outline.size()].from;
            std::vector<std::vector<glm::dvec3>> loops{
                {{a.x, 0, a.y}, {b.x, 0, b.y}, {b.x, h.y, b.y}, {a.x, h.y, a.y}}};
            if (k == 7) { // x = x1, from h.z to 0
                const double y0 = 0.9, y1 = 2.1, a0 = 0.3 * h.z, a1 = 0.7 * h.z;
                const std::vector<glm::dvec3> pane{{x1, y0, a1}, {x1, y0, a0}, {x1, y1, a0}, {x1, y1, a1}};
                loops.emplace_back(pane.rbegin(), pane.rend());
                add({pane}, 20, 1);
            }
            add(loops, 2 + outline[k].surface, k == 4 || k == 10 ? 2 : 0);
        }
        isInSlot = [x0](glm::dvec3 p) { return p.x < 0 && p.x > x0; };
    }

    std::mt19937 random_;
    double deep_ = 0;
};

} // namespace heliodon::test
