#include "geometry/dark_rooms.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/bounds.h"
#include "geometry/counted.h"
#include "geometry/disjoint_sets.h"
#include "geometry/ground_in_rooms.h"
#include "geometry/outline_area.h"
#include "geometry/room_measures.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kApart = 0.5;  // metres of building: thicker than walls between rooms
constexpr double kHigher = 1.0; // the same
constexpr double kLarger = 2;
constexpr double kOneWay = 0.5; // of its area: as SpacePart::looksIn() has it

struct DarkOrNot {
    Bounds box{dvec3(1e300), dvec3(-1e300)};
    bool hasGlass = false;
    uint32_t surface = 0;
    double area = 0, inwards = 0; // of opaque faces; less what looks out
    double volume = 0;

    bool looksIn() const { return inwards > kOneWay * area; }
    bool looksOut() const { return inwards < -kOneWay * area; }
};

} // namespace

std::vector<DoubtfulRoom> doubtfulRooms(const ModelRooms& rooms, const std::function<bool(uint32_t)>& isGlass,
                                        const std::function<dvec3(uint32_t)>& drawn,
                                        double worldPerBuilding) {
    const Building& building = rooms.building;
    if (building.roomCount < 2) return {};
    std::vector<DarkOrNot> all(building.roomCount);
    for (size_t f = building.faces.size(); f-- > 0;) {
        const Face& face = building.faces[f];
        DarkOrNot& room = all[face.room];
        room.surface = rooms.source[f];
        for (const uint32_t v : face.loops[0])
            room.box = {glm::min(room.box.low, building.vertices[v]),
                        glm::max(room.box.high, building.vertices[v])};
        if (isGlass(face.material)) {
            room.hasGlass = true;
            continue;
        }
        const dvec3 area = areaVector(building.vertices, face.loops[0]);
        room.area += glm::length(area);
        room.inwards += glm::dot(area, drawn(rooms.source[f])) < 0 ? -glm::length(area) : glm::length(area);
    }
    DarkOrNot light; // all that have glass
    const std::vector<RoomMeasures> measures = measureRooms(ownTriangles(building));
    DisjointSets near(building.roomCount);
    for (uint32_t r = 0; r < building.roomCount; ++r) {
        all[r].volume = measures[r].volume;
        for (uint32_t o = 0; o < r; ++o)
            if (all[r].box.isNear(all[o].box, kApart * worldPerBuilding)) near.join(r, o);
        if (!all[r].hasGlass) continue;
        light.hasGlass = true;
        light.box = united(light.box, all[r].box);
        light.volume += all[r].volume, light.area += all[r].area, light.inwards += all[r].inwards;
    }
    if (!light.hasGlass) return {};
    std::set<uint32_t> lit; // wholes that hang together
    for (uint32_t r = 0; r < building.roomCount; ++r)
        if (all[r].hasGlass) lit.insert(near.root(r));
    std::vector<DoubtfulRoom> out;
    for (uint32_t r = 0; r < building.roomCount; ++r) {
        const DarkOrNot& room = all[r];
        if (room.hasGlass || (isMuchLarger(room.box, light.box) && room.box.low.y < light.box.low.y))
            continue;
        if ((room.looksIn() && light.looksOut()) || (room.looksOut() && light.looksIn()))
            out.push_back({room.surface, "its faces look the other way than those of rooms with glass"});
        else if (!lit.contains(near.root(r)))
            out.push_back({room.surface, "it stands apart from all rooms with glass"});
        else if (room.box.high.y > light.box.high.y + kHigher * worldPerBuilding &&
                 room.volume > kLarger * light.volume)
            out.push_back({room.surface, "it is higher and larger than all rooms with glass"});
    }
    return out;
}

std::string warningOf(const std::vector<DoubtfulRoom>& rooms,
                      const std::function<std::string(uint32_t)>& place) {
    return fmt::format(
        "{} without glass {} taken as {} (the first, with the face at {}: {}): is it a neighbouring "
        "building or another solid? The faces of these have to look out of them, where those "
        "of rooms look in",
        counted(rooms.size(), "space"), rooms.size() == 1 ? "was" : "were",
        rooms.size() == 1 ? "a room" : "rooms", place(rooms[0].surface), rooms[0].why);
}

} // namespace heliodon::geometry
