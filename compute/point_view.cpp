// Lambert, Photometria, 1760, theorem XVI: the form factor of a polygon is a sum over its edges of the angle
// that the edge spans times the cosine of its plane.
#include "compute/point_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "geometry/bounds.h"
#include "geometry/clip_polygon.h"
#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

// The part of a convex polygon where dot(p, normal) >= offset (or <= with `sign` -1).
void cut(std::span<const dvec3> polygon, dvec3 normal, double offset, double sign,
         PointView::Polygon& result) {
    geometry::clip<dvec3>(
        polygon, [&](const dvec3& p) { return sign * (glm::dot(p, normal) - offset); }, result);
}

double areaOf(std::span<const dvec3> polygon) {
    return 0.5 * glm::length(geometry::areaVector(polygon));
}

constexpr double kLeastOfExtent = 1e-9;

// Over Blockers::tolerance(): how far off its own plane the front of a wall hides nothing, which may be parts
// of itself, however corners are rounded, and how far before a point on a wall a front lies in that wall.
constexpr double kSameOverLeast = kSamePlane / kLeastOfExtent, kOneOverLeast = kOnePlane / kLeastOfExtent;

double samePlane(const Blockers& blockers) {
    return blockers.tolerance() * kSameOverLeast;
}

// Behind more cones than these a part is first cut by the one in the middle of their list, which often stands
// in the middle of the rest too: both sides are left with about half of them, and fewer pieces come of it.
constexpr size_t kMostInOrder = 64;

constexpr double kTanPiBy8 = 0.41421356237309503;
constexpr double kOneDirection = 1e-13; // sine

// atan(z) / z up to z = tan(pi / 8), of z * z: interpolated at Chebyshev's nodes, to double precision.
double arcOverTangent(double w) {
    constexpr std::array<double, 12> k{1,
                                       -0.33333333333333121,
                                       0.19999999999940893,
                                       -0.14285714279250245,
                                       0.11111110744919658,
                                       -0.090908968090640266,
                                       0.076920453309022252,
                                       -0.066629518136291907,
                                       0.058468782973308722,
                                       -0.05035102456601552,
                                       0.037965257453865933,
                                       -0.017805397205419446};
    const double w2 = w * w, w4 = w2 * w2;
    const double low = (k[0] + k[1] * w) + (k[2] + k[3] * w) * w2,
                 middle = (k[4] + k[5] * w) + (k[6] + k[7] * w) * w2,
                 high = (k[8] + k[9] * w) + (k[10] + k[11] * w) * w2;
    return low + (middle + high * w4) * w4;
}

// Angle over sine, within 1e-15 of itself, in two fifths of the time of std::atan2 with root and quotient:
// most edges look small. 0 where there is no angle.
double arcOverSine(double sineSquare, double cosine) {
    if (cosine > 0 && sineSquare <= kTanPiBy8 * kTanPiBy8 * cosine * cosine) {
        const double inverse = 1 / cosine;
        return arcOverTangent(sineSquare * (inverse * inverse)) * inverse;
    }
    if (!(sineSquare > 0)) return 0;
    const double sine = std::sqrt(sineSquare), across = std::abs(cosine);
    const double most = std::max(sine, across), least = std::min(sine, across);
    const bool turned = least > kTanPiBy8 * most; // by pi / 4
    const double z = turned ? (least - most) / (least + most) : least / most;
    double arc = z * arcOverTangent(z * z) + (turned ? std::numbers::pi / 4 : 0);
    if (sine > across) arc = std::numbers::pi / 2 - arc;
    return (cosine < 0 ? std::numbers::pi - arc : arc) / sine;
}

bool allBelow(std::span<const dvec3> polygon, dvec3 normal, double offset) {
    return std::all_of(polygon.begin(), polygon.end(),
                       [&](const dvec3& p) { return glm::dot(p, normal) <= offset; });
}

} // namespace

uint32_t roomOfPoint(const geometry::PatchMesh& mesh, dvec3 position, dvec3 normal) {
    const dvec3 across = geometry::perpendicular(normal), other = glm::cross(normal, across);
    double size = 0;
    for (const dvec3& v : mesh.vertices) size = std::max(size, glm::length(v - mesh.vertices[0]));
    // Slanted by odd amounts, so that rays along walls and into corners are rare.
    for (const glm::dvec2 slant : {glm::dvec2(0.0137, 0.0071), glm::dvec2(0.31, 0.17),
                                   glm::dvec2(-0.29, 0.53), glm::dvec2(0.7, -0.9)}) {
        const dvec3 direction = glm::normalize(normal + slant.x * across + slant.y * other);
        double nearest = std::numeric_limits<double>::infinity();
        uint32_t room = geometry::kNoRoom;
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            const auto corners = mesh.patch(i);
            const dvec3 area = geometry::patchAreaVector(mesh, i);
            const double slope = glm::dot(area, direction);
            if (slope == 0) continue;
            const double height = glm::dot(mesh.vertices[corners[0]] - position, area), t = height / slope,
                         whole = glm::length(area);
            // Two rooms may share a wall without thickness: its front counts.
            const double together = 1e-7 * size;
            if (t <= together || t >= nearest + together) continue;
            // The wall that the point lies on, were it a hair behind it.
            if (std::abs(height) <= kSamePlane * size * whole && glm::dot(area, normal) > 0.999 * whole)
                continue;
            const dvec3 p = position + t * direction;
            bool inside = true;
            for (size_t k = 0; k < corners.size() && inside; ++k) {
                const dvec3 a = mesh.vertices[corners[k]];
                inside = glm::dot(glm::cross(mesh.vertices[corners[(k + 1) % corners.size()]] - a, p - a),
                                  area) >= 0;
            }
            if (!inside) continue;
            if (slope < 0)
                room = mesh.room[i];
            else if (t < nearest - together)
                room = geometry::kNoRoom;
            nearest = std::min(nearest, t);
        }
        if (room != geometry::kNoRoom) return room;
    }
    return geometry::kNoRoom;
}

Blockers::Blockers(const geometry::PatchMesh& mesh) {
    tolerance_ = kLeastOfExtent * geometry::boundsOf(mesh.vertices).diagonal();
    for (ConvexRegion& region : blockingRegions(mesh, 16)) add(std::move(region));
}

void Blockers::add(ConvexRegion region) {
    const geometry::Bounds box = geometry::boundsOf(region.corners);
    balls_.push_back({box.centre(), 0.5 * box.diagonal()});
    regions_.push_back(std::move(region));
}

Blockers Blockers::between(std::span<const dvec3> points) const {
    Blockers some;
    some.tolerance_ = tolerance_;
    const geometry::Bounds box = geometry::boundsOf(points);
    for (const ConvexRegion& region : regions_) {
        if (!geometry::boundsOf(region.corners).isNear(box, 0)) continue;
        const dvec3 normal = normalOf(region);
        bool before = false, behind = false;
        for (const dvec3& p : points) {
            const double height = glm::dot(normal, p - region.corners[0]);
            before |= height > tolerance_, behind |= height < -tolerance_;
        }
        if (before && behind) some.add(region);
    }
    return some;
}

PointView::PointView(const Blockers& blockers, dvec3 position, dvec3 normal, uint32_t room)
    : PointView(blockers, position, normal) {
    addCones(blockers, room, {});
}

PointView PointView::through(const Blockers& blockers, const Polygon& frame, uint32_t room) const {
    PointView view(blockers, position_, normal_);
    view.frame_ = frame_;
    const auto add = [&](dvec3 normal, double offset) {
        view.frame_.push_back({normal, offset, offset + glm::dot(position_, normal)});
    };
    const auto cone = coneOf(frame);
    if (cone) {
        for (const dvec3& side : cone->sides) add(side, 0);
        add(cone->normal, cone->distance - samePlane(blockers));
    }
    if (room != geometry::kNoRoom) view.addCones(blockers, room, cone ? frame : Polygon{});
    return view;
}

std::optional<PointView::Cone> PointView::coneOf(std::span<const dvec3> corners) const {
    Cone cone;
    const dvec3 area = geometry::areaVector(corners);
    if (area == dvec3(0)) return std::nullopt;
    cone.normal = glm::normalize(area);
    cone.distance = glm::dot(cone.normal, corners[0]);
    if (std::abs(cone.distance) <= least_) return std::nullopt;
    const double side = cone.distance > 0 ? 1 : -1;
    cone.normal *= side, cone.distance *= side;
    cone.isFront = side < 0;
    cone.beyond = cone.distance + (cone.isFront ? kSameOverLeast * least_ : least_);
    for (size_t k = 0; k < corners.size(); ++k) {
        const dvec3 a = corners[k], b = corners[(k + 1) % corners.size()], across = side * glm::cross(a, b);
        // What cutting left of an edge, in one direction but for rounding, bounds nothing.
        if (glm::length(across) > kOneDirection * glm::length(a) * glm::length(b))
            cone.sides.push_back(glm::normalize(across));
    }
    return cone;
}

void PointView::addCones(const Blockers& blockers, uint32_t room, std::span<const dvec3> frame) {
    // What stands before the frame has hidden parts of it already, and what stands beside all that it shows
    // hides nothing.
    const bool isFramed = !frame_.empty();
    const Side behind = isFramed ? frame_.back() : Side{};
    const double before = behind.offset + 2 * samePlane(blockers);
    const auto standsBeside = [&](std::span<const dvec3> corners) {
        const double side = glm::dot(geometry::areaVector(corners), corners[0]) > 0 ? 1 : -1;
        for (size_t k = 0; k < corners.size(); ++k)
            if (allBelow(frame, side * glm::cross(corners[k], corners[(k + 1) % corners.size()]), 0))
                return true;
        return false;
    };
    Polygon corners, beyond;
    for (size_t k = 0; k < blockers.regions().size(); ++k) {
        const ConvexRegion& region = blockers.regions()[k];
        if (region.room != room) continue;
        const auto [centre, radius] = blockers.balls()[k];
        const double height = isFramed ? glm::dot(behind.normal, centre - position_) - before : 0;
        if (height < -radius - least_) continue;
        corners.clear();
        for (const dvec3& corner : region.corners) corners.push_back(corner - position_);
        if (isFramed && height < radius + least_) {
            cut(corners, behind.normal, before, 1, beyond);
            if (beyond.empty()) continue;
            corners.swap(beyond);
        }
        if (allBelow(corners, normal_, least_) || (!frame.empty() && standsBeside(corners))) continue;
        auto cone = coneOf(corners);
        // The wall that the point lies on hides nothing, were the point a hair behind it.
        if (cone && !(cone->distance <= (cone->isFront ? kOneOverLeast : kSameOverLeast) * least_ &&
                      std::abs(glm::dot(cone->normal, normal_)) > 0.999))
            cones_.push_back(std::move(*cone));
    }
}

bool PointView::mayHide(const Cone& cone, std::span<const dvec3> polygon) const {
    if (allBelow(polygon, cone.normal, cone.beyond)) return false;
    return std::none_of(cone.sides.begin(), cone.sides.end(),
                        [&](const dvec3& side) { return allBelow(polygon, side, least_); });
}

std::vector<PointView::Cone> PointView::conesOf(std::span<const Polygon* const> polygons) const {
    std::vector<Cone> cones;
    Polygon corners;
    for (const Polygon* polygon : polygons) {
        corners.clear();
        for (const dvec3& p : *polygon) corners.push_back(p - position_);
        if (std::optional<Cone> cone = coneOf(corners)) cones.push_back(std::move(*cone));
    }
    return cones;
}

void PointView::keepLit(std::span<const Cone> cones, std::vector<Polygon>& parts) const {
    std::vector<const Cone*> before;
    for (const Cone& cone : cones) before.push_back(&cone);
    for (Polygon& part : std::exchange(parts, {})) keepLit(std::move(part), before, 0, parts);
}

void PointView::hideBeyond(std::span<const Polygon* const> polygons, std::vector<Polygon>& parts) const {
    std::vector<Cone> cones = conesOf(polygons);
    for (Cone& cone : cones) cone.normal = dvec3(0), cone.distance = cone.beyond = -1; // all parts are beyond
    keepLit(cones, parts);
}

PointView::Hiding PointView::hidingBehind(std::span<const Polygon* const> polygons) const {
    Hiding hiding;
    hiding.cones_ = conesOf(polygons);
    for (Cone& cone : hiding.cones_)
        cone.beyond = cone.distance + kSameOverLeast * least_; // walls have two sides
    return hiding;
}

void PointView::hideBehind(const Hiding& hiding, std::vector<Polygon>& parts) const {
    keepLit(hiding.cones_, parts);
}

// Nothing where the cone's planes only touch the part.
PointView::Reach PointView::reachOf(const Cone& cone, std::span<const dvec3> part) const {
    if (!mayHide(cone, part)) return Reach::nothing;
    const auto within = [&](const dvec3& side, double offset) {
        return std::ranges::all_of(part, [&](const dvec3& p) { return glm::dot(p, side) >= offset; });
    };
    const bool all = within(cone.normal, cone.distance) &&
                     std::ranges::all_of(cone.sides, [&](const dvec3& side) { return within(side, 0); });
    return all ? Reach::all : Reach::some;
}

void PointView::keepLit(Polygon&& part, std::vector<const Cone*>& before, size_t from,
                        std::vector<Polygon>& lit) const {
    const size_t end = before.size();
    const auto leave = [&] { before.resize(end); };
    for (size_t k = from; k < end; ++k) {
        const Reach reach = reachOf(*before[k], part);
        if (reach == Reach::all) return leave();
        if (reach == Reach::some) before.push_back(before[k]);
    }
    const size_t count = before.size() - end;
    if (count == 0) {
        lit.push_back(std::move(part));
        return;
    }
    if (count > kMostInOrder) std::swap(before[end], before[end + count / 2]);
    const Cone& cone = *before[end];
    Polygon in, out;
    const auto keep = [&] {
        if (out.size() >= 3 && areaOf(out) > least_ * least_) keepLit(std::move(out), before, end + 1, lit);
    };
    cut(part, cone.normal, cone.distance, -1, out);
    keep();
    cut(part, cone.normal, cone.distance, 1, in);
    part.swap(in);
    for (const dvec3& side : cone.sides) {
        if (part.empty()) break;
        cut(part, side, 0, -1, out);
        keep();
        cut(part, side, 0, 1, in);
        part.swap(in);
    }
    leave();
}

bool PointView::mayShow(std::span<const dvec3> polygon) const {
    return std::none_of(frame_.begin(), frame_.end(), [&](const Side& side) {
        return std::all_of(polygon.begin(), polygon.end(),
                           [&](const dvec3& p) { return glm::dot(p, side.normal) < side.inWorld; });
    });
}

bool PointView::mayShow(dvec3 centre, double radius) const {
    return std::ranges::none_of(frame_, [&](const Side& side) {
        return glm::dot(centre, side.normal) + radius < side.inWorld - least_;
    });
}

double PointView::unhinderedFactor(std::span<const dvec3> polygon) const {
    double sum = 0;
    dvec3 a = polygon.back();
    for (const dvec3& b : polygon) {
        const dvec3 c = glm::cross(a, b - a); // a x b, exact for short edges
        sum += arcOverSine(glm::dot(c, c), glm::dot(a, b)) * glm::dot(c, normal_);
        a = b;
    }
    return std::abs(sum) / (2 * std::numbers::pi);
}

double PointView::openFactor(std::span<const dvec3> polygon, Polygon& above) const {
    cut(polygon, normal_, glm::dot(position_, normal_), 1, above);
    if (above.empty()) return 0;
    for (dvec3& p : above) p -= position_;
    return unhinderedFactor(above);
}

PointView::Glance PointView::glance(std::span<const dvec3> polygon, Local& local) const {
    if (polygon.size() > local.size()) return Glance::unclear;
    bool below = true, above = true;
    for (size_t k = 0; k < polygon.size(); ++k) {
        local[k] = polygon[k] - position_;
        const double height = glm::dot(local[k], normal_);
        below &= height <= 0, above &= height >= 0;
    }
    if (below) return Glance::nothing;
    const std::span<const dvec3> here(local.data(), polygon.size());
    const bool all =
        above && frame_.empty() &&
        std::none_of(cones_.begin(), cones_.end(), [&](const Cone& cone) { return mayHide(cone, here); });
    return all ? Glance::all : Glance::unclear;
}

bool PointView::isHindered(std::span<const dvec3> polygon) const {
    Local local;
    if (!frame_.empty() || polygon.size() > local.size()) return true;
    for (size_t k = 0; k < polygon.size(); ++k) local[k] = polygon[k] - position_;
    const std::span<const dvec3> here(local.data(), polygon.size());
    return std::ranges::any_of(cones_, [&](const Cone& cone) { return mayHide(cone, here); });
}

double PointView::factor(std::span<const dvec3> polygon) const {
    Local local;
    const Glance seen = glance(polygon, local);
    if (seen == Glance::nothing) return 0;
    if (seen == Glance::all) return unhinderedFactor({local.data(), polygon.size()});
    std::vector<Polygon> parts;
    return factor(polygon, parts);
}

double PointView::factor(std::span<const dvec3> polygon, std::vector<Polygon>& parts) const {
    Local seen;
    const Glance first = glance(polygon, seen);
    if (first == Glance::all) { // most; the part keeps its memory
        parts.resize(1);
        parts[0].assign(seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(polygon.size()));
        return unhinderedFactor(parts[0]);
    }
    parts.clear();
    if (first == Glance::nothing || !mayShow(polygon)) return 0;
    Polygon local, above;
    if (polygon.size() <= seen.size()) {
        cut({seen.data(), polygon.size()}, normal_, 0, 1, above);
    } else {
        for (const dvec3& p : polygon) local.push_back(p - position_);
        cut(local, normal_, 0, 1, above);
    }
    for (const Side& side : frame_) {
        if (above.empty()) return 0;
        cut(above, side.normal, side.offset, 1, local);
        above.swap(local);
    }
    if (above.empty()) return 0;
    std::vector<const Cone*> before;
    for (const Cone& cone : cones_) before.push_back(&cone);
    keepLit(std::move(above), before, 0, parts);
    double sum = 0;
    for (const Polygon& part : parts) sum += unhinderedFactor(part);
    return sum;
}

} // namespace heliodon::compute
