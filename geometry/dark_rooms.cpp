#include "geometry/dark_rooms.h"

#include <algorithm>
#include <set>
#include <string>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/bounds.h"
#include "geometry/counted.h"
#include "geometry/disjoint_sets.h"
#include "geometry/ground_in_rooms.h"
#include "geometry/lower_case.h"
#include "geometry/outline_area.h"
#include "geometry/room_measures.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kApart = 0.5;  // metres of building: thicker than walls between rooms
constexpr double kHigher = 1.0; // the same
constexpr double kLarger = 2;
constexpr double kOneWay = 0.5; // of its area: as SpacePart::looksIn() has it
constexpr double kLevel = 0.9;  // of a normal

struct DarkOrNot {
    Bounds box{dvec3(1e300), dvec3(-1e300)};
    bool hasGlass = false;
    uint32_t surface = 0;         // of its first face, its number in the file
    double area = 0, inwards = 0; // of opaque faces; less what looks out
    double volume = 0;
    std::set<uint32_t> floors, others; // materials
    std::set<uint32_t> floorFaces;     // their numbers in the file
    std::set<std::string> names;       // of objects

    bool looksIn() const { return inwards > kOneWay * area; }
    bool looksOut() const { return inwards < -kOneWay * area; }
};

std::vector<DarkOrNot> roomsByGlass(const ModelRooms& rooms, const RawModel& model) {
    const Building& building = rooms.building;
    std::vector<DarkOrNot> all(building.roomCount);
    for (size_t f = building.faces.size(); f-- > 0;) {
        const Face& face = building.faces[f];
        DarkOrNot& room = all[face.room];
        const uint32_t drawn = rooms.source[f];
        room.surface = drawn;
        room.names.insert(model.object[model.group[drawn]].name);
        for (const uint32_t v : face.loops[0])
            room.box = {glm::min(room.box.low, building.vertices[v]),
                        glm::max(room.box.high, building.vertices[v])};
        if (model.materials[face.material].isOpening()) {
            room.hasGlass = true;
            continue;
        }
        const dvec3 normal = areaVector(building.vertices, face.loops[0]);
        const double area = glm::length(normal);
        const bool isFloor = normal.y > kLevel * area;
        (isFloor ? room.floors : room.others).insert(face.material);
        if (isFloor) room.floorFaces.insert(drawn);
        room.area += area;
        room.inwards += glm::dot(normal, areaVector(model.vertices, model.face(drawn))) < 0 ? -area : area;
    }
    const std::vector<RoomMeasures> measures = measureVolumes(ownTriangles(building));
    for (uint32_t r = 0; r < building.roomCount; ++r) {
        all[r].volume = measures[r].volume;
        for (const uint32_t material : all[r].others) all[r].floors.erase(material);
    }
    return all;
}

// All that have glass as one.
DarkOrNot litAmong(const std::vector<DarkOrNot>& rooms) {
    DarkOrNot light;
    for (const DarkOrNot& room : rooms) {
        if (!room.hasGlass) continue;
        light.hasGlass = true;
        light.box = united(light.box, room.box);
        light.volume += room.volume, light.area += room.area, light.inwards += room.inwards;
        light.floors.insert(room.floors.begin(), room.floors.end());
        light.floorFaces.insert(room.floorFaces.begin(), room.floorFaces.end());
        light.names.insert(room.names.begin(), room.names.end());
    }
    return light;
}

// Per room, whether it hangs together with one that has glass.
std::vector<bool> areNearGlass(const std::vector<DarkOrNot>& rooms, double apart) {
    const auto count = static_cast<uint32_t>(rooms.size());
    DisjointSets near(count);
    for (uint32_t r = 0; r < count; ++r)
        for (uint32_t o = 0; o < r; ++o)
            if (rooms[r].box.isNear(rooms[o].box, apart)) near.join(r, o);
    std::set<uint32_t> lit; // wholes that hang together
    for (uint32_t r = 0; r < count; ++r)
        if (rooms[r].hasGlass) lit.insert(near.root(r));
    std::vector<bool> out;
    for (uint32_t r = 0; r < count; ++r) out.push_back(lit.contains(near.root(r)));
    return out;
}

bool isSaidToBeRoom(const DarkOrNot& room, const DarkOrNot& light) {
    const auto meet = [](const auto& some, const auto& others) {
        return std::ranges::any_of(some, [&](const auto& one) { return others.contains(one); });
    };
    // One face under both may be the ground.
    if (meet(room.floors, light.floors) && !meet(room.floorFaces, light.floorFaces)) return true;
    return !meet(room.names, light.names) && std::ranges::all_of(room.names, [](const std::string& name) {
        return lowered(name).starts_with("room");
    });
}

std::string warningOf(size_t count, const std::string& place, const char* why) {
    return fmt::format(
        "{} without glass {} taken as {} (the first, with the face at {}: {}): is it a neighbouring "
        "building or another solid? The faces of these have to look out of them, where those "
        "of rooms look in (an object with a name that begins with \"room\" is one)",
        counted(count, "space"), count == 1 ? "was" : "were", count == 1 ? "a room" : "rooms", place, why);
}

} // namespace

std::vector<std::string> warningsOfDarkRooms(const ModelRooms& rooms, const RawModel& model,
                                             double worldPerBuilding, double tolerance) {
    if (rooms.building.roomCount < 2) return {};
    const std::vector<DarkOrNot> all = roomsByGlass(rooms, model);
    const DarkOrNot light = litAmong(all);
    if (!light.hasGlass) return {};
    const std::vector<bool> nearGlass = areNearGlass(all, kApart * worldPerBuilding);
    std::vector<std::string> out;
    size_t doubtful = 0;
    const DarkOrNot* first = nullptr;
    const char* whyFirst = nullptr;
    const auto whyNone = [&](const DarkOrNot& room, bool isNear) {
        if ((room.looksIn() && light.looksOut()) || (room.looksOut() && light.looksIn()))
            return "its faces look the other way than those of rooms with glass";
        if (!isNear) return "it stands apart from all rooms with glass";
        if (room.box.high.y > light.box.high.y + kHigher * worldPerBuilding &&
            room.volume > kLarger * light.volume)
            return "it is higher and larger than all rooms with glass";
        return "a solid beside rooms with glass may be drawn just so";
    };
    for (size_t r = 0; r < all.size(); ++r) {
        const DarkOrNot& room = all[r];
        if (room.hasGlass) continue;
        if (isMuchLarger(room.box, light.box) && room.box.low.y < light.box.low.y - tolerance) {
            out.push_back(fmt::format(
                "a space without glass (of {} and others), much larger than all rooms with glass and "
                "reaching below them, was taken as a room: is it the ground, with faces that look in?",
                model.place(room.surface)));
            continue;
        }
        if (isSaidToBeRoom(room, light)) continue;
        const char* why = whyNone(room, nearGlass[r]);
        if (doubtful++ == 0) first = &room, whyFirst = why;
    }
    if (first) out.push_back(warningOf(doubtful, model.place(first->surface), whyFirst));
    return out;
}

} // namespace heliodon::geometry
