// Rooms without glass that may be none: neighbouring buildings and other solids whose faces look into them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/model_rooms.h"

namespace heliodon::geometry {

struct DoubtfulRoom {
    uint32_t surface; // of its first face, its number in the file
    const char* why;  // "its faces look ..."
};

// Of those without glass (`isGlass` of a material), where others have some: drawn the other way round than
// these, with no way over neighbours within half a metre to them, or higher than all of them and twice as
// large. `drawn`: of a face of the file the normal as drawn, of any length. What may be the ground, below
// them, is not among them. Cost: rooms squared, and faces.
std::vector<DoubtfulRoom> doubtfulRooms(const ModelRooms& rooms, const std::function<bool(uint32_t)>& isGlass,
                                        const std::function<glm::dvec3(uint32_t)>& drawn,
                                        double worldPerBuilding);

std::string warningOf(const std::vector<DoubtfulRoom>& rooms,
                      const std::function<std::string(uint32_t)>& place);

} // namespace heliodon::geometry
