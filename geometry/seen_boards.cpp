#include "geometry/seen_boards.h"

#include <algorithm>
#include <map>

#include <glm/geometric.hpp>

#include "geometry/box_tree.h"
#include "geometry/face_cutting.h"
#include "geometry/flat_faces.h"
#include "geometry/outline_area.h"
#include "geometry/ray_triangle.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kLeastSeen = 0.45; // of both sides and the rims

} // namespace

bool areBoardsSeen(const std::vector<SoupFace>& boards, const Building& building, double tolerance) {
    if (boards.empty()) return true;
    const std::vector<FlatFace> seen = flatFacesOf(building);
    const std::vector<Bounds> boxes = boxesOf(seen, tolerance);
    const BoxTree tree(boxes);
    std::map<uint32_t, std::pair<double, double>> areas; // per sheet: seen, and all
    for (const FlatFace& side : flatFacesOf(unwelded(boards))) {
        if (side.triangles.empty()) continue;
        const dvec3 p = largestTriangle(side).middle();
        const bool isSeen = tree.anyHolding(p, p, [&](uint32_t i) {
            const FlatFace& face = seen[i];
            return building.faces[face.face].material == boards[side.surface].material &&
                   glm::dot(face.normal, side.normal) > kOnePlaneCosine &&
                   std::ranges::any_of(face.triangles, [&](const ShellTriangle& t) {
                       const auto far = distanceTo(t, p + 2 * tolerance * side.normal, -side.normal);
                       return far && *far < 4 * tolerance;
                   });
        });
        auto& [some, all] = areas[boards[side.surface].surface];
        const double area = glm::length(areaVector(side.loops[0]));
        some += isSeen ? area : 0, all += area;
    }
    return std::ranges::all_of(areas, [](const auto& entry) {
        const auto& [some, all] = entry.second;
        return some >= kLeastSeen * all;
    });
}

} // namespace heliodon::geometry
