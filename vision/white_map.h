// Where the table is in the picture, and the light that falls on its white.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "vision/plan_view.h"
#include "vision/two_lights.h"

namespace heliodon::vision {

enum class Ground : uint8_t { outside, besideTable, table };

// The table's disc and, about it, where the tops of walls at its edge can be.
struct TableRegion {
    int x0 = 0, y0 = 0, width = 0,
        height = 0;             // in the photograph; no width: the camera does not see the table
    std::vector<Ground> ground; // row-major

    bool isTable(int x, int y) const { // 0, 0 first
        return ground[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)] ==
               Ground::table;
    }
};

// `overEdge`: inches that a wall may stick out over the table.
TableRegion findTable(const PlanView& view, double radiusInches, double overEdge);

constexpr int kBlock = 8; // pixels of the grid's squares

// Light on white per block of the region: of the blocks that look like the table, spread over those that do
// not.
struct WhiteMap {
    LightGrid grid; // its light is empty where nothing white and lit is where the table should be
    // What white card returns over what the table does, where the table has a colour of its own.
    std::optional<glm::vec3> card;
    bool darkTable = false; // card outshines it so much that its own colour is not known
    // Colour, green 1, of a light that alone reaches the shadows, where it differs from the light elsewhere.
    std::optional<glm::vec3> secondLight;
    // Where two lights of different colours each throw shadows: the grid's light follows those on the table,
    // `full` (per block) is without them.
    std::optional<TwoLights> lights;
    std::vector<glm::vec3> full;
    std::vector<char> open; // see MixedLight
    // Whether the table, or what is white in the light over it, may return that light in the block.
    bool isMixture(glm::vec3 seen, size_t block) const;
    double noise = 0; // standard deviation of a pixel on the table over its value
    // The same of what the paints are held against: what is brighter is less noisy, as the root of its light.
    double noiseOfWhite() const { return card ? noise / std::sqrt(static_cast<double>(card->g)) : noise; }
};

// White card on a table of another colour.
struct CardWhite {
    glm::vec3 overTable; // what it returns over what the table under the same light does, per channel
    glm::vec2 light;     // chroma of what it returns
};

const CardWhite kWhiteTable{glm::vec3(1), glm::vec2(0)}; // the table is as white as card

// `known`: card as it was seen where walls were found, or `kWhiteTable`; without, it is looked for.
WhiteMap findWhite(const PlanView& view, const TableRegion& region,
                   const std::optional<CardWhite>& known = std::nullopt);

} // namespace heliodon::vision
