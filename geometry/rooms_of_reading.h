// Faces of a model -> its rooms, beside what stands outside of them and with panes that stand within.
#pragma once

#include <cstdint>
#include <set>

#include "geometry/model_faces.h"
#include "geometry/model_reading.h"
#include "geometry/model_rooms.h"

namespace heliodon::geometry {

// As roomsOfModel(), and where that refuses: without open sheets that stand outside of all rooms, without the
// ground that runs on through them, and with room for the glass of panes that have one room on both sides.
// What is closed and too small for a room is left out. What was left out and what is guessed stands in the
// building's warnings. `made`: as roomsOfModel() has it. Throws InputError where there are no rooms; sets
// `reading.coveredPane` where such a pane is why. Cost: up to five times that of roomsOfModel().
ModelRooms roomsOfReading(ModelReading& reading, const ModelFaces& drawn, const std::set<uint32_t>& made);

} // namespace heliodon::geometry
