// What the light solvers hand to drawing and to tables: one moment of light on a PatchMesh.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "geometry/luminance.h"
#include "shaders/io/glow.io.h"

namespace heliodon::compute {

// Illuminance over a triangle, at the places of a grid: corner 0 + (i (corner 1 - corner 0) + j (corner 2 -
// corner 0)) / kCells, i + j <= kCells, row by row of j; linear between them.
struct PatchGlow {
    static constexpr int kCells = io::kGlowCells;
    uint32_t patch = 0;
    std::array<glm::vec3, io::kGlowPlaces> lux{};

    // Where the places lie, or what is there of values that are linear between corners.
    template<class V> static std::array<V, io::kGlowPlaces> places(V corner0, V corner1, V corner2) {
        using Number = typename V::value_type;
        std::array<V, io::kGlowPlaces> all;
        size_t place = 0;
        for (int j = 0; j <= kCells; ++j)
            for (int i = 0; i + j <= kCells; ++i)
                all[place++] = corner0 + (Number(i) * (corner1 - corner0) + Number(j) * (corner2 - corner0)) /
                                             Number(kCells);
        return all;
    }

    // At a place along the edges from corner 0 to 1 and to 2, 0 to 1 each; as shaders/glow.frag has it.
    glm::vec3 at(glm::vec2 place) const {
        const auto value = [&](int i, int j) {
            return lux[static_cast<size_t>(j * (2 * kCells + 3 - j) / 2 + i)];
        };
        const glm::vec2 scaled = float(kCells) * glm::clamp(place, 0.0F, 1.0F);
        const int j = std::min(static_cast<int>(scaled.y), kCells - 1),
                  i = std::min(static_cast<int>(scaled.x), kCells - 1 - j);
        const glm::vec2 share = scaled - glm::vec2(i, j);
        if (share.x + share.y > 1 && i + j < kCells - 1) {
            const glm::vec3 far = value(i + 1, j + 1);
            return far + (1 - share.x) * (value(i, j + 1) - far) + (1 - share.y) * (value(i + 1, j) - far);
        }
        const glm::vec3 base = value(i, j);
        return base + share.x * (value(i + 1, j) - base) + share.y * (value(i, j + 1) - base);
    }

    glm::vec3 mean() const {
        glm::vec3 sum(0);
        size_t place = 0;
        for (int j = 0; j <= kCells; ++j)
            for (int i = 0; i + j <= kCells; ++i) {
                const int sides = (i == 0) + (j == 0) + (i + j == kCells);
                sum += (sides == 0 ? 6.0f : sides == 1 ? 3.0f : 1.0f) * lux[place++]; // triangles around it
            }
        return sum / (3.0f * kCells * kCells);
    }
};

// sum += times more, place by place; what `sum` lacks was zero.
void addTimes(std::vector<glm::vec3>& sum, glm::vec3 times, const std::vector<glm::vec3>& more);

// Illuminance that varies within patches too much for a value per patch. Who draws takes the means off,
// draws what is left smoothly, and adds corners and grids.
struct LightDetail {
    std::vector<glm::vec3> mean;    // per patch, of both that follow; empty where there is none
    std::vector<glm::vec3> corners; // as PatchMesh::corners, linear between; one value where a surface's meet
    std::vector<PatchGlow> grids;   // on top of that, in the order of patches; may be negative

    void add(const LightDetail& other, glm::vec3 times = glm::vec3(1));
};

// Lux per linear Rec. 709 channel; one entry per patch.
struct Lighting {
    std::vector<glm::vec3> exitance;       // B = E + rho H, all light that leaves the patch into the room
    std::vector<glm::vec3> sunIlluminance; // direct sun on the patch, behind glass, averaged over the patch;
                                           // all zero without sun
    glm::dvec3 sunDirection{0};            // unit, world, towards the sun; zero when no sun is modelled
    glm::vec3 sunNormalIlluminance{0};     // outside, on a plane facing the sun
    // Behind some of the exitance: what the sky gives straight (compute/sky_detail.h) and what sunlit patches
    // nearby send on (compute/sun_glow.h). Empty with TransportOptions::forPictures off.
    LightDetail detail;
    std::vector<glm::vec3> ownScatter; // exitance that projectors leave out, as the physical model sends
                                       // it back by itself (engine/passes/own_scatter.h); or empty
};

using geometry::photometric;

} // namespace heliodon::compute
