// White card on a table of another colour.
#pragma once

#include <optional>

#include <glm/vec3.hpp>

#include "vision/white_map.h"

namespace heliodon::vision {

// Least of `overTable` where a table is too dark for the colour of the light on it.
constexpr float kDarkTable = 5;

// What card returns over what the table under the same light does, per channel; `table`: light that the bare
// table returns. None on a white table. Walls' faces and ends and the rings of tokens are card: brighter than
// a table of another colour in every channel and of one chroma, which no paint is. Light may do that too, and
// the grain of wood, but they lie anywhere; card lies next to painted tops, and on a coloured table outshines
// all that has the table's chroma there. So does card on a black table, of the table's chroma as it is. One
// pass over the table in the photograph; for the table's chroma and each other that is bright enough, on a
// white table seldom any, three passes over its samples, two distance transforms and one labelling.
std::optional<CardWhite> findCard(const PlanView& view, const TableRegion& region, const LightGrid& table);

// Whether a fifth of the table or more returns that light, or nearly: then what does so elsewhere is no card
// on a table of another colour, but stands in a light that the table there is shaded from.
bool tableReturns(const PlanView& view, const TableRegion& region, glm::vec3 light);

} // namespace heliodon::vision
