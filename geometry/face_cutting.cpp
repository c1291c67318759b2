#include "geometry/face_cutting.h"

#include <algorithm>
#include <utility>

namespace heliodon::geometry {

using glm::dvec3;

bool isCutBy(const FlatFace& convex, const FlatFace& other, double tolerance) {
    double most = 0, least = 0;
    std::vector<dvec3> ends;
    const std::vector<dvec3>& loop = convex.loops[0];
    for (size_t k = 0; k < loop.size(); ++k) {
        const double a = other.height(loop[k]), b = other.height(loop[(k + 1) % loop.size()]);
        most = std::max(most, a), least = std::min(least, a);
        if ((a >= 0) != (b >= 0))
            ends.push_back(loop[k] + a / (a - b) * (loop[(k + 1) % loop.size()] - loop[k]));
    }
    if (most <= tolerance || least >= -tolerance) return false;
    const dvec3 along = ends[1] - ends[0];
    return std::ranges::any_of(other.triangles, [&](const ShellTriangle& t) {
        const dvec3 normal = glm::cross(t.b - t.a, t.c - t.a);
        double from = 0, to = 1;
        for (const auto& [p, q] : {std::pair(t.a, t.b), {t.b, t.c}, {t.c, t.a}}) {
            const dvec3 inwards = glm::normalize(glm::cross(normal, q - p));
            const double height = glm::dot(ends[0] - p, inwards) + tolerance, rise = glm::dot(along, inwards);
            if (rise > 0)
                from = std::max(from, -height / rise);
            else if (rise < 0)
                to = std::min(to, -height / rise);
            else if (height < 0)
                return false;
        }
        // More than both edges' margins at a corner, or all of a small piece.
        const double enough = from <= 0 && to >= 1 ? 1 : 4;
        return (to - from) * glm::length(along) > enough * tolerance;
    });
}

std::vector<FlatFace> convexParts(const FlatFace& face) {
    const std::vector<dvec3>& loop = face.loops[0];
    const size_t n = loop.size();
    bool convex = face.loops.size() == 1;
    for (size_t k = 0; k < n; ++k)
        convex = convex && glm::dot(glm::cross(loop[(k + 1) % n] - loop[k], loop[(k + 2) % n] - loop[k]),
                                    face.normal) >= 0;
    if (convex) return {convexFace(loop, face.normal)};
    std::vector<FlatFace> out;
    for (const ShellTriangle& t : face.triangles) out.push_back(convexFace({t.a, t.b, t.c}, face.normal));
    return out;
}

Building unwelded(const std::vector<SoupFace>& faces) {
    Building out;
    for (const SoupFace& given : faces) {
        Face& face = out.faces.emplace_back();
        face.surface = static_cast<uint32_t>(&given - faces.data());
        for (const auto& loop : given.loops) {
            face.loops.emplace_back();
            for (const dvec3 p : loop) {
                face.loops.back().push_back(static_cast<uint32_t>(out.vertices.size()));
                out.vertices.push_back(p);
            }
        }
    }
    return out;
}

} // namespace heliodon::geometry
