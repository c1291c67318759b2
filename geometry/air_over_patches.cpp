#include "geometry/air_over_patches.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "geometry/floors.h"

namespace heliodon::geometry {

namespace {

constexpr double kUpright = 1e-6; // of the normal's rise
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kThickest = 1; // metres of the building, from what one walks on to the ceiling beneath

} // namespace

// About 200 points or fewer, equally dense.
std::vector<glm::dvec3> AirOverPatches::pointsOn(const std::vector<size_t>& patches, double area) const {
    constexpr double kApart = 0.4; // building metres
    const double each = std::max(std::pow(kApart * scale_, 2), area / 200);
    std::vector<glm::dvec3> points;
    double due = 0.5;
    for (const size_t i : patches) {
        const std::vector<glm::dvec3> p = patchCorners(mesh_, i);
        for (size_t c = 2; c < p.size(); ++c) { // middles of n x n parts of each triangle
            const glm::dvec3 u = p[c - 1] - p[0], v = p[c] - p[0];
            due += 0.5 * glm::length(glm::cross(u, v)) / each;
            const double n = std::floor(std::sqrt(due));
            due -= n * n;
            for (double a = 0; a < n; ++a)
                for (double b = 0; a + b < n; ++b) {
                    points.push_back(p[0] + ((a + 1.0 / 3) * u + (b + 1.0 / 3) * v) / n);
                    if (a + b + 1 < n) points.push_back(p[0] + ((a + 2.0 / 3) * u + (b + 2.0 / 3) * v) / n);
                }
        }
    }
    return points;
}

// What is not upright, by where it is seen from above.
void AirOverPatches::arrange() {
    if (columns_) return;
    for (size_t i = 0; i < mesh_.patchCount(); ++i) {
        const double rise = patchNormal(mesh_, i).y;
        if (std::abs(rise) < kUpright) continue;
        Bounds box = boundsOf(patchCorners(mesh_, i));
        box.low.y = -kInfinite, box.high.y = kInfinite;
        boxes_.push_back(box);
        sloping_.emplace_back(i, rise > 0);
    }
    columns_.emplace(boxes_);
}

// The nearest height at which a ceiling or a floor, if given of this room, lies straight above p, or
// below.
double AirOverPatches::nearest(glm::dvec3 p, bool above, bool isFloor, uint32_t room) const {
    const double apart = 1e-4 * scale_;
    double best = above ? kInfinite : -kInfinite;
    columns_->anyHolding({p.x, 0, p.z}, {p.x, 0, p.z}, [&](uint32_t k) {
        if (sloping_[k].second != isFloor || (room != kNoRoom && mesh_.room[sloping_[k].first] != room))
            return false;
        const double h = heightAt(mesh_, sloping_[k].first, p.x, p.z, 1e-9 * scale_ * scale_);
        if (above && h > p.y + apart) best = std::min(best, h);
        if (!above && h < p.y - apart) best = std::max(best, h);
        return false;
    });
    return best;
}

Air AirOverPatches::of(const std::vector<size_t>& patches, double area) {
    arrange();
    const double metre = scale_;
    const uint32_t room = mesh_.room[patches[0]];
    double points = 0;
    Air air;
    for (const glm::dvec3 p : pointsOn(patches, area)) {
        ++points;
        if (nearest(p, false, true, room) > -kInfinite) ++air.over;
        if (nearest(p, true, false) < p.y + kHeadroom * metre) continue;
        ++air.free;
        const glm::dvec3 ceiling(p.x, nearest(p, false, false), p.z);
        if (ceiling.y < p.y - kThickest * metre) continue;
        const auto isHeadroom = [&](double floor) { return ceiling.y - floor >= kHeadroom * metre; };
        if (isHeadroom(nearest(ceiling, false, true))) ++air.walkedUnder;
        if (const double floor = nearest(ceiling, false, true, room); floor > -kInfinite && isHeadroom(floor))
            ++air.walkedUnderInRoom;
    }
    for (double* some : {&air.over, &air.free, &air.walkedUnder, &air.walkedUnderInRoom})
        *some *= area / (metre * metre) / std::max(points, 1.0);
    return air;
}

} // namespace heliodon::geometry
