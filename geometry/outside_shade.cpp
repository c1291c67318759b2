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
#include "geometry/facing.h"
#include "geometry/outline_area.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kLevel = 0.25;     // of a normal: sills, roofs and slopes of up to 75 degrees
constexpr size_t kMostFully = 1000; // triangles: of more, as of terrain, those that matter most
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

struct Side {
    std::vector<dvec3> corners;
    dvec3 normal; // out of the room
};

struct Piece {
    Triangle corners;
    std::array<uint32_t, 3> at; // of the welded faces
    uint32_t material;
    dvec3 normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
};

// The height from which on the triangle matters to the pane: part of it lies before that, and part of the
// pane before the triangle. Of `terrain` a slope below the pane's foot hides nothing but ground, and is about
// as bright as that; its back is hidden by the ground before it.
std::optional<double> mattersFrom(const Piece& piece, const Pane& pane, bool terrain, double tolerance) {
    const bool level = terrain && std::abs(piece.normal.y) > kLevel;
    if (level && boundsOf(piece.corners).high.y <= pane.foot + tolerance) return std::nullopt;
    if (!lookAtOneAnother(piece.corners, piece.normal, pane.corners, -pane.normal, tolerance))
        return std::nullopt;
    return level ? pane.foot : kEverywhere;
}

// The outer sides of the rooms' walls that may send light into a window.
std::vector<Side> sidesSeen(const Building& building, std::span<const Pane> panes, double tolerance) {
    std::vector<Side> sides;
    for (const Face& face : building.faces) {
        if (building.materials[face.material].isOpening()) continue;
        Side side;
        for (const uint32_t v : face.loops[0]) side.corners.push_back(building.vertices[v]);
        std::ranges::reverse(side.corners);
        side.normal = glm::normalize(areaVector(side.corners));
        if (std::ranges::any_of(panes, [&](const Pane& pane) {
                return lookAtOneAnother(side.corners, side.normal, pane.corners, -pane.normal, tolerance);
            }))
            sides.push_back(std::move(side));
    }
    return sides;
}

class Shade {
public:
    explicit Shade(std::vector<dvec3> vertices) { out_.vertices = std::move(vertices); }

    void add(const Piece& piece) {
        out_.triangles.insert(out_.triangles.end(), piece.at.begin(), piece.at.end());
        out_.material.push_back(piece.material);
    }
    void addFrom(double height, const Piece& piece) {
        clip<dvec3>(
            piece.corners, [&](dvec3 p) { return p.y - height; }, above_);
        const auto first = static_cast<uint32_t>(out_.vertices.size());
        out_.vertices.insert(out_.vertices.end(), above_.begin(), above_.end());
        for (uint32_t k = 1; k + 1 < above_.size(); ++k) {
            out_.triangles.insert(out_.triangles.end(), {first, first + k, first + k + 1});
            out_.material.push_back(piece.material);
        }
    }
    Occluders done() { return out_.triangles.empty() ? Occluders{} : std::move(out_); }

private:
    Occluders out_;
    std::vector<dvec3> above_;
};

} // namespace

Occluders outsideShade(std::span<const SoupFace> faces, const Building& building, double tolerance) {
    const std::vector<Pane> panes = panesOf(building);
    if (faces.empty() || panes.empty()) return {};
    const Building welded = weldFaces({faces.begin(), faces.end()}, 1, tolerance);
    std::vector<Piece> seen, others;
    for (const Face& face : welded.faces)
        for (const auto& t : triangulateFace(welded, face))
            others.push_back(
                {{welded.vertices[t[0]], welded.vertices[t[1]], welded.vertices[t[2]]}, t, face.material});
    const bool terrain = others.size() > kMostFully;
    Shade shade(welded.vertices);
    std::erase_if(others, [&](const Piece& piece) {
        std::optional<double> from; // the lowest
        for (const Pane& pane : panes)
            if (const auto height = mattersFrom(piece, pane, terrain, tolerance))
                from = std::min(from.value_or(*height), *height);
        if (!from) return false;
        if (boundsOf(piece.corners).low.y >= *from - tolerance)
            shade.add(piece);
        else
            shade.addFrom(*from, piece);
        seen.push_back(piece);
        return true;
    });
    if (terrain) return shade.done();
    const std::vector<Side> sides = sidesSeen(building, panes, tolerance);
    for (const Piece& piece : others) {
        const auto looksAt = [&](const auto& other) {
            return lookAtOneAnother(piece.corners, piece.normal, other.corners, other.normal, tolerance);
        };
        if (std::ranges::any_of(seen, looksAt) || std::ranges::any_of(sides, looksAt)) shade.add(piece);
    }
    return shade.done();
}

} // namespace heliodon::geometry
