#include "geometry/small_rooms.h"

#include <algorithm>
#include <set>

#include "geometry/disjoint_sets.h"
#include "geometry/kept_rooms.h"
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
    std::vector<bool> kept(building.roomCount);
    for (uint32_t r = 0; r < building.roomCount; ++r)
        kept[r] = large.empty() || large.contains(joined.root(r));
    out.left = static_cast<size_t>(std::ranges::count(kept, false));
    if (out.left == 0) return out;
    const std::vector<uint32_t> stays = keepRooms(building, kept);
    size_t first = 0; // that goes
    while (first < stays.size() && stays[first] == first) ++first;
    out.surface = rooms.source[first];
    std::vector<uint32_t> source;
    for (const uint32_t f : stays) source.push_back(rooms.source[f]);
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
