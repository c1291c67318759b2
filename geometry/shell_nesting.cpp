#include "geometry/shell_nesting.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "geometry/triangle_box.h"

namespace heliodon::geometry {

namespace {

// Whether the outermost shell s is the outside of walls round the shells right within it.
bool isOutside(uint32_t s, const std::vector<std::vector<uint32_t>>& around,
               const std::vector<double>& volumes) {
    constexpr double kMostlyFilled = 0.5, kFilled = 0.125;
    double filled = 0;
    bool inwards = true, outwards = true; // those within
    for (size_t o = 0; o < around.size(); ++o)
        if (around[o].size() == 1 && around[o][0] == s) {
            filled += std::abs(volumes[o]);
            inwards = inwards && volumes[o] > 0;
            outwards = outwards && volumes[o] < 0;
        }
    if (volumes[s] > 0 && outwards) return false; // a room with solids, however large, drawn as they are
    const double share = filled / std::abs(volumes[s]);
    return share > kMostlyFilled || (share > kFilled && inwards && volumes[s] < 0);
}

// Of a shell that does not cross the other: where they touch, what lies on both says nothing.
bool isWithin(const std::vector<ShellTriangle>& shell, const std::vector<ShellTriangle>& other) {
    constexpr double kNear = 1e-5; // of a triangle's size
    constexpr size_t kTries = 50;
    const auto liesOn = [&](glm::dvec3 p) {
        return std::ranges::any_of(other, [&](const ShellTriangle& t) {
            return distance(t, p) <= kNear * (glm::length(t.b - t.a) + glm::length(t.c - t.a));
        });
    };
    glm::dvec3 p = shell.back().a;
    for (size_t k = 0; k < std::min(kTries, shell.size()) && liesOn(p); ++k) p = shell[k].middle();
    return crossings(other, p) % 2 == 1;
}

std::vector<bool> bodiesOutside(const std::vector<std::vector<uint32_t>>& around,
                                const std::vector<double>& volumes, const std::vector<bool>& hasGlass) {
    const size_t count = around.size();
    std::vector<bool> body(count, false), holds(count, false);
    bool windows = false; // of rooms that look inwards
    for (size_t s = 0; s < count; ++s) {
        windows |= around[s].empty() && volumes[s] > 0 && hasGlass[s];
        for (const uint32_t holder : around[s]) holds[holder] = true;
    }
    for (size_t s = 0; s < count; ++s)
        body[s] = windows && around[s].empty() && !holds[s] && volumes[s] < 0 && !hasGlass[s];
    return body;
}

} // namespace

double volumeWithin(const std::vector<ShellTriangle>& shell) {
    double sum = 0;
    const glm::dvec3 origin = shell.empty() ? glm::dvec3(0) : shell.back().a;
    for (const ShellTriangle& t : shell)
        sum -= glm::dot(t.a - origin, glm::cross(t.b - origin, t.c - origin)) / 6;
    return sum;
}

int crossings(const std::vector<ShellTriangle>& shell, glm::dvec3 p) {
    int count = 0;
    for (const ShellTriangle& t : shell) count += distanceTo(t, p, kOddWay).has_value();
    return count;
}

ShellNesting nestShells(const std::vector<std::vector<ShellTriangle>>& shells,
                        const std::vector<bool>& hasGlass) {
    ShellNesting out;
    const auto count = static_cast<uint32_t>(shells.size());
    std::vector<std::vector<uint32_t>> around(count);
    for (uint32_t s = 0; s < count; ++s)
        for (uint32_t o = 0; o < count; ++o)
            if (s != o && !shells[s].empty() && isWithin(shells[s], shells[o])) around[s].push_back(o);
    std::vector<double> volumes;
    for (const auto& shell : shells) volumes.push_back(volumeWithin(shell));
    out.room.assign(count, 0);
    std::vector<uint32_t> outsides;
    for (uint32_t s = 0; s < count; ++s)
        if (around[s].empty() && isOutside(s, around, volumes)) outsides.push_back(s);
    for (const uint32_t s : outsides) {
        out.room[s] = kNoRoom;
        for (auto& holders : around) std::erase(holders, s);
    }
    const std::vector<bool> body = bodiesOutside(around, volumes, hasGlass);
    for (uint32_t s = 0; s < count; ++s)
        if (around[s].size() % 2 == 0 && out.room[s] != kNoRoom && !body[s]) out.room[s] = out.rooms++;
    for (uint32_t s = 0; s < count; ++s)
        if (body[s]) out.room[s] = out.rooms + out.bodies++;
    for (uint32_t s = 0; s < count; ++s) {
        const bool solid = around[s].size() % 2 == 1;
        if (solid) {
            const uint32_t holder =
                *std::ranges::max_element(around[s], {}, [&](uint32_t o) { return around[o].size(); });
            out.room[s] = out.room[holder];
            out.solidsThatLookIn += volumes[s] > 0 && volumes[holder] > 0;
        }
        // Air is inside the shells of rooms and outside those of solids.
        out.inverted.push_back((volumes[s] > 0) == solid);
    }
    return out;
}

} // namespace heliodon::geometry
