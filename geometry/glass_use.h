// What the glass of a model bounds in its rooms, and what of it bounds none.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/face_soup.h"
#include "geometry/model_rooms.h"

namespace heliodon::geometry {

// Glass is what `isGlass` says of a material. Faces are told by their number in the file.

struct GlassUse {
    size_t panes = 0;              // faces that bound rooms
    std::vector<uint32_t> without; // those that bound none
};
GlassUse useOfGlass(const std::vector<SoupFace>& faces, const std::function<bool(uint32_t)>& isGlass,
                    const ModelRooms& rooms);

// One sentence; empty where there are none.
std::string warningOf(const GlassUse& use, const std::function<std::string(uint32_t)>& place);

// Square metres, of both sides of glass between rooms.
double areaOfGlass(const Building& building);

// A face of a room that has no others; none where each has.
std::optional<uint32_t> roomOfGlass(const ModelRooms& rooms, const std::function<bool(uint32_t)>& isGlass);

// Of such rooms side by side: light would pass each twice, and from one to the next.
std::optional<uint32_t> touchingRoomsOfGlass(const ModelRooms& rooms,
                                             const std::function<bool(uint32_t)>& isGlass);

} // namespace heliodon::geometry
