#include "geometry/faces_on_faces.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/disjoint_sets.h"
#include "geometry/face_soup.h"
#include "geometry/outline_area.h"
#include "geometry/ray_crossing.h"
#include "geometry/shell_faces.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

std::vector<dvec3> pointsOf(const Building& building, const std::vector<uint32_t>& loop) {
    std::vector<dvec3> points;
    for (const uint32_t v : loop) points.push_back(building.vertices[v]);
    return points;
}

// In the face's outline and none of its holes; of a point in its plane.
bool isIn(const Building& building, const Face& face, const dvec3& p) {
    const dvec3 size = glm::abs(areaVector(building.vertices, face.loops[0]));
    const int drop = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int u = (drop + 1) % 3, v = (drop + 2) % 3;
    bool in = false;
    for (const auto& border : face.loops)
        for (size_t i = 0; i < border.size(); ++i) {
            const dvec3 a = building.vertices[border[i]],
                        b = building.vertices[border[(i + 1) % border.size()]];
            if (rayCrosses({p[u], p[v]}, {a[u], a[v]}, {b[u], b[v]})) in = !in;
        }
    return in;
}

std::vector<Bounds> boxesOf(const Building& building) {
    std::vector<Bounds> boxes;
    for (const Face& face : building.faces) boxes.push_back(boundsOf(pointsOf(building, face.loops[0])));
    return boxes;
}

} // namespace

FacesOnFaces::FacesOnFaces(const Building& building, double offPlane)
    : building_(building), offPlane_(offPlane), box_(boxesOf(building)), tree_(box_) {
    DisjointSets sets(building.faces.size());
    for (const auto& [edge, around] : facesOfEdges(building)) {
        hasOpenEdges_ |= around.size() == 1;
        for (const uint32_t f : around) sets.join(f, around[0]);
    }
    boxOfBody_.assign(building.faces.size(), {dvec3(HUGE_VAL), dvec3(-HUGE_VAL)});
    for (uint32_t f = 0; f < building.faces.size(); ++f) {
        body_.push_back(sets.root(f));
        boxOfBody_[body_[f]] = united(boxOfBody_[body_[f]], box_[f]);
    }
}

bool FacesOnFaces::liesInPlane(const Face& face, const std::vector<dvec3>& points) const {
    const dvec3 n = glm::normalize(areaVector(building_.vertices, face.loops[0])),
                origin = building_.vertices[face.loops[0][0]];
    return std::ranges::all_of(
        points, [&](const dvec3& p) { return std::abs(glm::dot(p - origin, n)) <= offPlane_; });
}

bool FacesOnFaces::isWithinOne(uint32_t f) const {
    const auto& loop = building_.faces[f].loops[0];
    const std::vector<dvec3> points = pointsOf(building_, loop);
    return tree_.anyHolding(box_[f].low + offPlane_, box_[f].high - offPlane_, [&](uint32_t g) {
        const Face& other = building_.faces[g];
        const auto isCornerOf = [&](uint32_t v) { // those of a hole are not inside either
            return std::ranges::any_of(other.loops, [&](const auto& border) {
                return std::ranges::find(border, v) != border.end();
            });
        };
        return g != f && liesInPlane(other, points) && std::ranges::none_of(loop, isCornerOf) &&
               std::ranges::all_of(points, [&](const dvec3& p) { return isIn(building_, other, p); });
    });
}

bool FacesOnFaces::isOfBodyOn(uint32_t f) const {
    const std::vector<dvec3> points = pointsOf(building_, building_.faces[f].loops[0]);
    const Bounds& own = boxOfBody_[body_[f]];
    const auto holdsBody = [&](const Bounds& box) {
        return glm::all(glm::lessThanEqual(box.low, own.low + offPlane_)) &&
               glm::all(glm::greaterThanEqual(box.high, own.high - offPlane_));
    };
    return std::ranges::any_of(triangulateFace(building_, building_.faces[f]), [&](const auto& t) {
        const dvec3 middle =
            (building_.vertices[t[0]] + building_.vertices[t[1]] + building_.vertices[t[2]]) / 3.0;
        return tree_.anyHolding(middle + offPlane_, middle - offPlane_, [&](uint32_t g) {
            const Face& other = building_.faces[g];
            return body_[g] != body_[f] && holdsBody(boxOfBody_[body_[g]]) && liesInPlane(other, points) &&
                   isIn(building_, other, middle);
        });
    });
}

} // namespace heliodon::geometry
