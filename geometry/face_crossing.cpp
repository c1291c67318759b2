#include "geometry/face_crossing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "geometry/segment_distance.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kParallel = 1e-6; // sine: planes that meet nowhere

// Of triangles of a face that another one's plane crosses, not only touches, where that is: `origin` plus
// lengths along `way`, of both planes.
struct Stretch {
    dvec3 origin;
    double from, to;
};

std::vector<Stretch> stretchesOn(const FlatFace& face, const FlatFace& plane, dvec3 way, double tolerance) {
    std::vector<Stretch> out;
    for (const ShellTriangle& t : face.triangles) {
        const std::array corner{t.a, t.b, t.c};
        const std::array height{plane.height(t.a), plane.height(t.b), plane.height(t.c)};
        if (std::ranges::max(height) <= tolerance || std::ranges::min(height) >= -tolerance) continue;
        std::optional<Stretch> on;
        for (size_t k = 0; k < 3; ++k) {
            const double a = height[k], b = height[(k + 1) % 3];
            if ((a > 0) == (b > 0)) continue;
            const dvec3 p = corner[k] + a / (a - b) * (corner[(k + 1) % 3] - corner[k]);
            const double along = glm::dot(p, way);
            if (!on) on = Stretch{p - along * way, along, along};
            on->from = std::min(on->from, along), on->to = std::max(on->to, along);
        }
        out.push_back(*on); // some height is above, some below
    }
    return out;
}

double toBorder(const FlatFace& face, dvec3 p) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& loop : face.loops) least = std::min(least, distanceToLoop(p, loop));
    return least;
}

} // namespace

bool facesCross(const FlatFace& one, const FlatFace& other, double tolerance) {
    const dvec3 line = glm::cross(one.normal, other.normal);
    if (!(glm::length(line) > kParallel)) return false;
    const dvec3 way = glm::normalize(line);
    const std::vector<Stretch> onOther = stretchesOn(other, one, way, tolerance);
    for (const Stretch& a : stretchesOn(one, other, way, tolerance))
        for (const Stretch& b : onOther) {
            const double from = std::max(a.from, b.from), to = std::min(a.to, b.to);
            if (to - from <= 2 * tolerance) continue;
            const dvec3 middle = a.origin + 0.5 * (from + to) * way;
            if (toBorder(one, middle) > tolerance && toBorder(other, middle) > tolerance) return true;
        }
    return false;
}

bool isWithin(const TriangleRays& shell, const ShellTriangle& t, double tolerance) {
    const dvec3 normal = glm::normalize(glm::cross(t.b - t.a, t.c - t.a));
    return std::ranges::all_of(std::array{2.0, -2.0}, [&](double sides) {
        return shell.enclose(t.middle() + sides * tolerance * normal);
    });
}

} // namespace heliodon::geometry
