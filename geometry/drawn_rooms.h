// Rooms of a model beside what was drawn.
#pragma once

#include <vector>

#include "geometry/face_soup.h"
#include "geometry/glass_panes.h"
#include "geometry/model_rooms.h"

namespace heliodon::geometry {

// What is closed and bounds no room.
std::vector<SoupFace> solidsAmong(const std::vector<SoupFace>& closed, const ModelRooms& rooms);

// Whether the faces of rooms are drawn so, most of their area.
bool lookIn(const std::vector<SoupFace>& faces, const ModelRooms& rooms);

// Of each whether its middle is in a room, itself left out.
std::vector<bool> areInRooms(const ModelRooms& rooms, const std::vector<LooseGlass>& loose);

} // namespace heliodon::geometry
