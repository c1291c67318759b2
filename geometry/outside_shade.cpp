#include "geometry/outside_shade.h"

#include <algorithm>
#include <array>
#include <vector>

#include <glm/geometric.hpp>

#include "geometry/outline_area.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kLooksUp = 0.9; // sine: sills and roofs that slope by up to 25 degrees

struct Pane {
    std::vector<dvec3> corners;
    dvec3 normal; // into the room
};

std::vector<Pane> panesOf(const Building& building) {
    std::vector<Pane> out;
    for (const Face& face : building.faces) {
        if (face.twin != kNoTwin || !building.materials[face.material].isOpening()) continue;
        Pane pane;
        for (const uint32_t v : face.loops[0]) pane.corners.push_back(building.vertices[v]);
        pane.normal = glm::normalize(areaVector(pane.corners));
        out.push_back(std::move(pane));
    }
    return out;
}

// Whether part of the triangle lies before the pane, and part of the pane before the triangle; but what looks
// up from below the pane hides nothing but ground, and is about as bright as that.
bool mayShade(const std::array<dvec3, 3>& triangle, const Pane& pane, double tolerance) {
    const dvec3 normal = glm::normalize(glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]));
    const auto height = [](dvec3 p) { return p.y; };
    if (normal.y > kLooksUp && std::ranges::max(triangle, {}, height).y <=
                                   std::ranges::min(pane.corners, {}, height).y + tolerance)
        return false;
    return std::ranges::any_of(
               triangle, [&](dvec3 p) { return glm::dot(pane.corners[0] - p, pane.normal) > tolerance; }) &&
           std::ranges::any_of(pane.corners,
                               [&](dvec3 p) { return glm::dot(p - triangle[0], normal) > tolerance; });
}

} // namespace

Occluders outsideShade(std::span<const SoupFace> faces, const Building& building, double tolerance) {
    Occluders out;
    if (faces.empty()) return out;
    const std::vector<Pane> panes = panesOf(building);
    if (panes.empty()) return out;
    const Building welded = weldFaces({faces.begin(), faces.end()}, 1, tolerance);
    for (const Face& face : welded.faces)
        for (const auto& t : triangulateFace(welded, face)) {
            const std::array<dvec3, 3> corners{welded.vertices[t[0]], welded.vertices[t[1]],
                                               welded.vertices[t[2]]};
            if (std::ranges::any_of(panes,
                                    [&](const Pane& pane) { return mayShade(corners, pane, tolerance); }))
                out.triangles.insert(out.triangles.end(), t.begin(), t.end());
        }
    if (!out.triangles.empty()) out.vertices = welded.vertices;
    return out;
}

} // namespace heliodon::geometry
