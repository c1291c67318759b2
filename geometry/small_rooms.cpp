#include "geometry/small_rooms.h"

#include <algorithm>
#include <set>

#include "geometry/disjoint_sets.h"
#include "geometry/room_measures.h"

namespace heliodon::geometry {

SmallRooms leaveOutSmall(ModelRooms& rooms, double least) {
    Building& building = rooms.building;
    const std::vector<RoomMeasures> measures = measureVolumes(ownTriangles(building));
    DisjointSets joined(building.roomCount);
    for (const Face& face : building.faces)
        if (face.twin != kNoTwin) joined.join(face.room, building.faces[static_cast<size_t>(face.twin)].room);
    std::set<uint32_t> large; // roots
    for (uint32_t r = 0; r < measures.size(); ++r)
        if (measures[r].volume >= least) large.insert(joined.root(r));
    SmallRooms out;
    std::vector<uint32_t> number(building.roomCount, kNoRoom);
    uint32_t kept = 0;
    for (uint32_t r = 0; r < building.roomCount; ++r)
        if (large.empty() || large.contains(joined.root(r))) number[r] = kept++;
    out.left = building.roomCount - kept;
    if (out.left == 0) return out;
    std::vector<int32_t> place(building.faces.size(), kNoTwin); // of faces that stay
    std::vector<Face> faces;
    std::vector<uint32_t> source;
    for (size_t f = 0; f < building.faces.size(); ++f) {
        Face& face = building.faces[f];
        if (number[face.room] == kNoRoom) {
            if (faces.size() == f) out.surface = rooms.source[f];
            continue;
        }
        place[f] = static_cast<int32_t>(faces.size());
        face.room = number[face.room];
        faces.push_back(std::move(face));
        source.push_back(rooms.source[f]);
    }
    for (Face& face : faces)
        if (face.twin != kNoTwin) face.twin = place[static_cast<size_t>(face.twin)];
    building.faces = std::move(faces);
    building.roomCount = kept;
    rooms.source = std::move(source);
    return out;
}

bool areAllSmall(const Building& building, double least) {
    return std::ranges::all_of(measureVolumes(ownTriangles(building)),
                               [&](const RoomMeasures& room) { return room.volume < least; });
}

bool areAllBetweenPanes(const Building& building, double least) {
    return std::ranges::all_of(measureVolumes(ownTriangles(building)), [&](const RoomMeasures& room) {
        return room.volume < least && 2 * room.openings > room.surface;
    });
}

} // namespace heliodon::geometry
