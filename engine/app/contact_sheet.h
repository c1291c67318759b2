// Days and hours side by side in one picture, as figure 11 of the paper has them.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/passes/false_colour.h"
#include "engine/passes/picture.h"

namespace heliodon::app {

// `cells`: row by row, rows.size() x columns.size() pictures of one size. Labels stand left of rows and above
// columns; `title` over all; a false-colour legend, where there is one, at the right.
passes::Image8 contactSheet(std::span<const passes::Image8> cells, const std::vector<std::string>& rows,
                            const std::vector<std::string>& columns, const std::string& title,
                            const std::optional<passes::FalseScale>& legend = {});

} // namespace heliodon::app
