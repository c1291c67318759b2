#include "geometry/glass_use.h"

#include <set>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/counted.h"
#include "geometry/outline_area.h"

namespace heliodon::geometry {

namespace {

std::vector<bool> areGlass(const Building& building, const std::function<bool(uint32_t)>& isGlass) {
    std::vector<bool> are(building.roomCount, true);
    for (const Face& face : building.faces)
        if (!isGlass(face.material)) are[face.room] = false;
    return are;
}

} // namespace

GlassUse useOfGlass(const std::vector<SoupFace>& faces, const std::function<bool(uint32_t)>& isGlass,
                    const ModelRooms& rooms) {
    std::set<uint32_t> glass;
    for (const SoupFace& face : faces)
        if (isGlass(face.material)) glass.insert(face.surface);
    const std::set<uint32_t> used(rooms.source.begin(), rooms.source.end());
    GlassUse out;
    for (const uint32_t f : glass) {
        if (used.contains(f))
            ++out.panes;
        else
            out.without.push_back(f);
    }
    return out;
}

std::string warningOf(const GlassUse& use, const std::function<std::string(uint32_t)>& place) {
    if (use.without.empty()) return {};
    const bool one = use.without.size() == 1;
    return fmt::format("{} of glass (the first at {}) {} no room and {} left out: it stands outside, or the "
                       "space behind it is open elsewhere, as by a gap round a frame",
                       counted(use.without.size(), "face"), place(use.without[0]), one ? "bounds" : "bound",
                       one ? "was" : "were");
}

double areaOfGlass(const Building& building) {
    double area = 0;
    for (const Face& face : building.faces)
        if (building.materials[face.material].isOpening())
            area += 0.5 * glm::length(areaVector(building.vertices, face.loops[0]));
    return area;
}

std::optional<uint32_t> roomOfGlass(const ModelRooms& rooms, const std::function<bool(uint32_t)>& isGlass) {
    const std::vector<bool> isBody = areGlass(rooms.building, isGlass);
    for (size_t f = 0; f < rooms.source.size(); ++f)
        if (isBody[rooms.building.faces[f].room]) return rooms.source[f];
    return std::nullopt;
}

std::optional<uint32_t> touchingRoomsOfGlass(const ModelRooms& rooms,
                                             const std::function<bool(uint32_t)>& isGlass) {
    const Building& building = rooms.building;
    const std::vector<bool> isBody = areGlass(building, isGlass);
    for (size_t f = 0; f < building.faces.size(); ++f) {
        const Face& face = building.faces[f];
        if (face.twin != kNoTwin && isBody[face.room] &&
            isBody[building.faces[static_cast<size_t>(face.twin)].room])
            return rooms.source[f];
    }
    return std::nullopt;
}

} // namespace heliodon::geometry
