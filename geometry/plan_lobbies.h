// A hole in an outer wall is filled, also where the space behind it has no other wall for itself: a lobby in
// a corner of a hall, a store with a door to the street.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/plan_arrangement.h"
#include "geometry/plan_lines.h"
#include "geometry/plan_paths.h"
#include "geometry/plan_walls.h"

namespace heliodon::geometry {

// Where holes are: between pieces of one straight side; face to face between those of a facade that are out
// of line, too; before a free end that another one faces, as where pieces end at walls square to the facade.
enum class LobbyHoles { betweenPieces, outOfLine, beforeEnds };

// The cells inside and those of spaces that open to the outside by holes alone and see enough of the walls
// beside each, as the outside does: none of a recess between wings, as wide as they are apart, nor of a court
// at the end of a passage. With the doors from these to rooms.
std::vector<bool> withLobbies(const PlanWalls& plan, const PlanLines& lines, const PlanArrangement& map,
                              const std::vector<bool>& solid, const std::vector<SeenWall>& seen,
                              const std::vector<bool>& inside, LobbyHoles holes);

// Of spaces of so many square inches and more that have holes as a lobby does, but see too little wall beside
// them for one, and more than a recess would that is as wide as its mouth: they are outside as they happen to
// be drawn. A sentence each, which names their walls.
std::vector<std::string> nearlyLobbies(const PlanWalls& plan, const PlanLines& lines,
                                       const PlanArrangement& map, const std::vector<bool>& solid,
                                       const std::vector<SeenWall>& seen, const std::vector<bool>& inside,
                                       double leastArea);

} // namespace heliodon::geometry
