#include "geometry/kept_rooms.h"

#include <utility>

namespace heliodon::geometry {

std::vector<uint32_t> keepRooms(Building& building, const std::vector<bool>& kept) {
    std::vector<uint32_t> number(building.roomCount), stays;
    uint32_t rooms = 0;
    for (uint32_t r = 0; r < building.roomCount; ++r)
        if (kept[r]) number[r] = rooms++;
    std::vector<int32_t> place(building.faces.size(), kNoTwin);
    std::vector<Face> faces;
    for (uint32_t f = 0; f < building.faces.size(); ++f) {
        Face& face = building.faces[f];
        if (!kept[face.room]) continue;
        place[f] = static_cast<int32_t>(faces.size());
        face.room = number[face.room];
        faces.push_back(std::move(face));
        stays.push_back(f);
    }
    for (Face& face : faces)
        if (face.twin != kNoTwin) face.twin = place[static_cast<size_t>(face.twin)];
    building.faces = std::move(faces);
    building.roomCount = rooms;
    return stays;
}

} // namespace heliodon::geometry
