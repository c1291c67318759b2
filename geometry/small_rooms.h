// Closed spaces too small for a room, as the hollows of frames and what is between parts that nearly touch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/model_rooms.h"

namespace heliodon::geometry {

constexpr double kLeastRoom = 0.1;                 // cubic metres of building
inline double leastRoom(double worldPerBuilding) { // cubic world metres
    return kLeastRoom * worldPerBuilding * worldPerBuilding * worldPerBuilding;
}

struct SmallRooms {
    size_t left = 0;      // out of the rooms
    uint32_t surface = 0; // of a face of one, its number in the file
};

// Of less than `least` (cubic metres), where no pane joins them with a larger one, as it does what is between
// two panes; none where there is no larger one.
SmallRooms leaveOutSmall(ModelRooms& rooms, double least);

bool areAllSmall(const Building& building, double least);
// As what is between the panes of double glazing, where the rooms before them are open.
bool areAllBetweenPanes(const Building& building, double least);

} // namespace heliodon::geometry
