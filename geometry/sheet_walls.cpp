#include "geometry/sheet_walls.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace heliodon::geometry {

using glm::dvec3;

SheetWalls::SheetWalls(const std::vector<SoupFace>& faces, double tolerance)
    : faces_(flatFacesOf(weldedByNumber(faces, tolerance))), boxes_(boxesOf(faces_, tolerance)),
      tree_(boxes_), tolerance_(tolerance) {
    for (const FlatFace& face : faces_) material_.push_back(faces[face.surface].material);
}

double SheetWalls::nearest(dvec3 from, dvec3 way, double reach, double cosine) const {
    double least = std::numeric_limits<double>::infinity();
    tree_.anyAlong(from, way, reach, [&](uint32_t i) {
        if (std::abs(glm::dot(faces_[i].normal, way)) < cosine) return false;
        for (const ShellTriangle& t : faces_[i].triangles)
            if (const auto at = distanceTo(t, from, way); at && *at <= reach) least = std::min(least, *at);
        return false; // look at all
    });
    return least;
}

uint32_t SheetWalls::materialAt(dvec3 from, dvec3 way, double far) const {
    uint32_t out = 0;
    bool looksAway = false;
    tree_.anyAlong(from, way, far + tolerance_, [&](uint32_t i) {
        for (const ShellTriangle& t : faces_[i].triangles)
            if (const auto at = distanceTo(t, from, way);
                at && std::abs(*at - far) <= tolerance_ && !looksAway) {
                out = material_[i];
                looksAway = glm::dot(faces_[i].normal, way) > 0;
            }
        return looksAway;
    });
    return out;
}

std::optional<uint32_t> SheetWalls::faceAt(dvec3 from, dvec3 way, double reach) const {
    std::optional<uint32_t> out;
    tree_.anyAlong(from, way, reach, [&](uint32_t i) {
        if (std::abs(glm::dot(faces_[i].normal, way)) < kOnePlaneCosine) return false;
        for (const ShellTriangle& t : faces_[i].triangles)
            if (const auto at = distanceTo(t, from, way); at && *at <= reach) out = faces_[i].surface;
        return out.has_value();
    });
    return out;
}

std::vector<dvec3> SheetWalls::normalsAlong(dvec3 from, dvec3 to) const {
    std::vector<dvec3> out;
    for (const double part : {1e-3, 0.5, 1 - 1e-3}) {
        const dvec3 p = glm::mix(from, to, part);
        tree_.anyHolding(p, p, [&](uint32_t i) {
            const FlatFace& face = faces_[i];
            if (std::abs(face.height(from)) <= tolerance_ && std::abs(face.height(to)) <= tolerance_ &&
                std::ranges::any_of(face.triangles, [&](const ShellTriangle& t) {
                    return distanceTo(t, p + 2 * tolerance_ * face.normal, -face.normal).has_value();
                }))
                out.push_back(face.normal);
            return false; // look at all
        });
    }
    return out;
}

} // namespace heliodon::geometry
