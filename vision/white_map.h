// Where the table is in the picture, and the light that falls on its white.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "vision/plan_view.h"

namespace heliodon::vision {

enum class Ground : uint8_t { outside, besideTable, table };

// The table's disc and, about it, where the tops of walls at its edge can be.
struct TableRegion {
    int x0 = 0, y0 = 0, width = 0,
        height = 0;             // in the photograph; no width: the camera does not see the table
    std::vector<Ground> ground; // row-major
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
    // Colour, green 1, of a light that alone reaches the shadows, where it differs from the light elsewhere.
    std::optional<glm::vec3> secondLight;
    double noise = 0; // standard deviation of a pixel on the table over its value
};

WhiteMap findWhite(const PlanView& view, const TableRegion& region);

} // namespace heliodon::vision
