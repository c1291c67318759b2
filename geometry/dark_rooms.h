// Rooms without glass that may be none: neighbouring buildings, other solids and the ground, where their
// faces look into them.
#pragma once

#include <string>
#include <vector>

#include "geometry/model_rooms.h"
#include "geometry/raw_model.h"

namespace heliodon::geometry {

// Of those without glass, where others have some: a block whose faces look the way theirs do is drawn as a
// room beside them is. Two things tell rooms: a floor of a material that no other face of theirs has, as
// floors of rooms with glass have it (not one face below both), and a name of their own that begins with "room" (of their objects).
// What is as large and low as the ground (isMuchLarger()) has a warning each. `tolerance`: world metres that
// it reaches below rooms. Cost: rooms squared, and faces.
std::vector<std::string> warningsOfDarkRooms(const ModelRooms& rooms, const RawModel& model,
                                             double worldPerBuilding, double tolerance);

} // namespace heliodon::geometry
