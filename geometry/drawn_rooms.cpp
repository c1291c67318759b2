#include "geometry/drawn_rooms.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include <glm/geometric.hpp>

#include "geometry/outline_area.h"
#include "geometry/shell_nesting.h"

namespace heliodon::geometry {

std::vector<SoupFace> solidsAmong(const std::vector<SoupFace>& closed, const ModelRooms& rooms) {
    const std::set<uint32_t> used(rooms.source.begin(), rooms.source.end());
    std::vector<SoupFace> out;
    std::ranges::copy_if(closed, std::back_inserter(out),
                         [&](const SoupFace& face) { return !used.contains(face.surface); });
    return out;
}

bool lookIn(const std::vector<SoupFace>& faces, const ModelRooms& rooms) {
    std::map<uint32_t, glm::dvec3> drawn; // twice the area, by the face of the file
    for (const SoupFace& face : faces) drawn[face.surface] += areaVector(face.loops[0]);
    double inwards = 0;
    for (size_t f = 0; f < rooms.source.size(); ++f) {
        const glm::dvec3 area = areaVector(rooms.building.vertices, rooms.building.faces[f].loops[0]);
        inwards += glm::dot(drawn[rooms.source[f]], area) > 0 ? glm::length(area) : -glm::length(area);
    }
    return inwards > 0;
}

std::vector<bool> areInRooms(const ModelRooms& rooms, const std::vector<LooseGlass>& loose) {
    if (loose.empty()) return {};
    const Building& building = rooms.building;
    std::vector<std::pair<uint32_t, ShellTriangle>> all; // with its face in the file
    for (uint32_t f = 0; f < building.faces.size(); ++f)
        for (const auto& t : triangulateFace(building, building.faces[f]))
            all.push_back({rooms.source[f], ShellTriangle{building.vertices[t[0]], building.vertices[t[1]],
                                                          building.vertices[t[2]]}});
    std::vector<bool> inside;
    std::vector<ShellTriangle> others;
    for (const LooseGlass& glass : loose) {
        others.clear();
        for (const auto& [face, triangle] : all)
            if (std::ranges::find(glass.faces, face) == glass.faces.end()) others.push_back(triangle);
        inside.push_back(crossings(others, glass.middle) % 2 == 1);
    }
    return inside;
}

} // namespace heliodon::geometry
