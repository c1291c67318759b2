#include "geometry/outside_shade.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <glm/geometric.hpp>

#include "geometry/bounds.h"
#include "geometry/clip_polygon.h"
#include "geometry/outline_area.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kLevel = 0.25; // of a normal: sills, roofs and slopes of up to 75 degrees
constexpr double kEverywhere = -std::numeric_limits<double>::infinity();

using Triangle = std::array<dvec3, 3>;

struct Pane {
    std::vector<dvec3> corners;
    dvec3 normal; // into the room
    double foot = 0;
};

std::vector<Pane> panesOf(const Building& building) {
    std::vector<Pane> out;
    for (const Face& face : building.faces) {
        if (face.twin != kNoTwin || !building.materials[face.material].isOpening()) continue;
        Pane pane;
        for (const uint32_t v : face.loops[0]) pane.corners.push_back(building.vertices[v]);
        pane.normal = glm::normalize(areaVector(pane.corners));
        pane.foot = boundsOf(pane.corners).low.y;
        out.push_back(std::move(pane));
    }
    return out;
}

// The height from which on the triangle may hide something that matters from the pane: part of it lies before
// that, and part of the pane before the triangle. But a slope below the pane's foot hides nothing but ground,
// and is about as bright as that; its back is hidden by the ground before it.
std::optional<double> shadesFrom(const Triangle& triangle, const Pane& pane, double tolerance) {
    const dvec3 normal = glm::normalize(glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]));
    const bool level = std::abs(normal.y) > kLevel;
    if (level && boundsOf(triangle).high.y <= pane.foot + tolerance) return std::nullopt;
    if (std::ranges::none_of(
            triangle, [&](dvec3 p) { return glm::dot(pane.corners[0] - p, pane.normal) > tolerance; }) ||
        std::ranges::none_of(pane.corners,
                             [&](dvec3 p) { return glm::dot(p - triangle[0], normal) > tolerance; }))
        return std::nullopt;
    return level ? pane.foot : kEverywhere;
}

} // namespace

Occluders outsideShade(std::span<const SoupFace> faces, const Building& building, double tolerance) {
    Occluders out;
    if (faces.empty()) return out;
    const std::vector<Pane> panes = panesOf(building);
    if (panes.empty()) return out;
    const Building welded = weldFaces({faces.begin(), faces.end()}, 1, tolerance);
    out.vertices = welded.vertices;
    std::vector<dvec3> above;
    for (const Face& face : welded.faces)
        for (const auto& t : triangulateFace(welded, face)) {
            const Triangle corners{welded.vertices[t[0]], welded.vertices[t[1]], welded.vertices[t[2]]};
            std::optional<double> from; // the lowest
            for (const Pane& pane : panes)
                if (const auto height = shadesFrom(corners, pane, tolerance))
                    from = std::min(from.value_or(*height), *height);
            if (!from) continue;
            if (boundsOf(corners).low.y >= *from - tolerance) {
                out.triangles.insert(out.triangles.end(), t.begin(), t.end());
                out.material.push_back(face.material);
                continue;
            }
            clip<dvec3>(
                corners, [&](dvec3 p) { return p.y - *from; }, above);
            const auto first = static_cast<uint32_t>(out.vertices.size());
            out.vertices.insert(out.vertices.end(), above.begin(), above.end());
            for (uint32_t k = 1; k + 1 < above.size(); ++k) {
                out.triangles.insert(out.triangles.end(), {first, first + k, first + k + 1});
                out.material.push_back(face.material);
            }
        }
    return out.triangles.empty() ? Occluders{} : out;
}

} // namespace heliodon::geometry
