#include "geometry/plane_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>

#include "geometry/bounds.h"
#include "geometry/perpendicular.h"

namespace heliodon::geometry {

namespace {

constexpr double kSkin =
    0.0025; // metres: outlines are straightened by up to 0.1 in against the walls behind them
constexpr double kNudge = 1e-7;    // metres
constexpr double kShortest = 1e-6; // metres
constexpr double kChord = 2e-4;    // metres: between the circle of the least n . d and its chords

// Parameters of a line between which something holds; empty when from >= to.
struct Interval {
    double from = 0, to = 1;
    bool empty() const { return from >= to; }
    // Keeps where value + t slope > 0.
    void keep(double value, double slope) {
        if (slope > 0)
            from = std::max(from, -value / slope);
        else if (slope < 0)
            to = std::min(to, -value / slope);
        else if (value <= 0)
            to = from;
    }
};

Interval insideOf(const ConvexOutline& outline, glm::dvec2 a, glm::dvec2 d) {
    Interval in;
    for (size_t i = 0, n = outline.points.size(); i < n && !in.empty(); ++i) {
        const glm::dvec2 p = outline.points[i], e = outline.points[i + 1 < n ? i + 1 : 0] - p;
        in.keep(cross(e, a - p), cross(e, d));
    }
    return in;
}

class OutlineFinder {
public:
    OutlineFinder(const PlaneView& view, glm::dvec2 low, glm::dvec2 high, std::vector<Segment>& out)
        : view_(view), low_(low), high_(high), out_(out) {}

    void find() {
        for (size_t s = 0; s < view_.shadows.size(); ++s) {
            const auto& points = view_.shadows[s].points;
            for (size_t i = 0; i < points.size(); ++i)
                add(points[i], points[(i + 1) % points.size()], s, kNone, true);
        }
        const double size = glm::length(high_ - low_);
        const glm::dvec2 middle = 0.5 * (low_ + high_);
        for (size_t b = 0; b < view_.borders.size(); ++b) {
            const auto& [n, offset] = view_.borders[b];
            const double length = glm::length(n);
            if (length < 1e-12) continue;
            const glm::dvec2 on = middle + n * ((offset - glm::dot(n, middle)) / (length * length)),
                             along = glm::dvec2(-n.y, n.x) * (size / length);
            add(on - along, on + along, kNone, b, true);
        }
        if (std::isfinite(view_.reach)) addCircle();
    }

private:
    static constexpr size_t kNone = static_cast<size_t>(-1);

    void addCircle() {
        const double r = view_.reach;
        const glm::dvec2 far = glm::max(glm::abs(low_ - view_.foot), glm::abs(high_ - view_.foot));
        if (glm::length(far) <= r) return;
        const double parts = std::ceil(std::numbers::pi / std::acos(1 - std::min(0.5, kChord / r)));
        const auto at = [&](double k) {
            const double angle = 2 * std::numbers::pi * k / parts;
            return view_.foot + r * glm::dvec2(std::cos(angle), std::sin(angle));
        };
        glm::dvec2 last = at(0);
        for (double k = 1; k <= parts; ++k) {
            const glm::dvec2 next = at(k);
            add(last, next, kNone, kNone, false);
            last = next;
        }
    }

    // What of the segment lies in the box, the picture and the circle, and in no shadow but its own.
    void add(glm::dvec2 a, glm::dvec2 b, size_t ownShadow, size_t ownBorder, bool inCircle) {
        const glm::dvec2 d = b - a;
        Interval in;
        for (int c = 0; c < 2; ++c) {
            in.keep(a[c] - low_[c], d[c]);
            in.keep(high_[c] - a[c], -d[c]);
        }
        for (size_t k = 0; k < view_.borders.size() && !in.empty(); ++k)
            if (k != ownBorder) {
                const auto& [n, offset] = view_.borders[k];
                in.keep(glm::dot(n, a) - offset, glm::dot(n, d));
            }
        if (inCircle && std::isfinite(view_.reach)) keepInCircle(a, d, in);
        const double length = glm::length(d);
        if (in.empty() || (in.to - in.from) * length < kShortest) return;
        // Of two shadows that share an edge from either side, neither has it for an outline; of two that have
        // it on the same side, both.
        const glm::dvec2 outward =
            ownShadow == kNone ? glm::dvec2(0) : kNudge / length * glm::dvec2(d.y, -d.x);
        hidden_.clear();
        for (size_t s = 0; s < view_.shadows.size(); ++s) {
            const ConvexOutline& shadow = view_.shadows[s];
            if (s == ownShadow || std::max(a.x, b.x) <= shadow.low.x || std::max(a.y, b.y) <= shadow.low.y ||
                std::min(a.x, b.x) >= shadow.high.x || std::min(a.y, b.y) >= shadow.high.y)
                continue;
            Interval dark = insideOf(shadow, a + outward, d);
            dark.from = std::max(dark.from, in.from);
            dark.to = std::min(dark.to, in.to);
            if (!dark.empty()) hidden_.push_back(dark);
        }
        std::ranges::sort(hidden_, {}, &Interval::from);
        hidden_.push_back({in.to, in.to});
        for (double at = in.from; const Interval& dark : hidden_) {
            if ((dark.from - at) * length > kShortest) out_.push_back({a + at * d, a + dark.from * d});
            at = std::max(at, dark.to);
        }
    }

    void keepInCircle(glm::dvec2 a, glm::dvec2 d, Interval& in) const {
        const glm::dvec2 p = a - view_.foot;
        const double dd = glm::dot(d, d), pd = glm::dot(p, d),
                     root = pd * pd - dd * (glm::dot(p, p) - view_.reach * view_.reach);
        if (root <= 0 || dd == 0) {
            in.to = in.from;
            return;
        }
        in.from = std::max(in.from, (-pd - std::sqrt(root)) / dd);
        in.to = std::min(in.to, (-pd + std::sqrt(root)) / dd);
    }

    const PlaneView& view_;
    glm::dvec2 low_, high_;
    std::vector<Segment>& out_;
    std::vector<Interval> hidden_;
};

bool allOutside(std::span<const glm::dvec2> hull, glm::dvec2 n, double offset) {
    return std::ranges::all_of(hull, [&](glm::dvec2 p) { return glm::dot(n, p) <= offset; });
}

FlatBox boxOf(std::span<const glm::dvec2> hull) {
    FlatBox box{hull[0], hull[0]};
    for (const glm::dvec2 p : hull) {
        box.low = glm::min(box.low, p);
        box.high = glm::max(box.high, p);
    }
    return box;
}

double distanceTo(std::span<const glm::dvec2> hull, glm::dvec2 p) {
    double least = std::numeric_limits<double>::infinity();
    bool inside = true;
    for (size_t i = 0; i < hull.size(); ++i) {
        const glm::dvec2 a = hull[i], d = hull[(i + 1) % hull.size()] - a;
        inside = inside && cross(d, p - a) >= 0;
        const double t = std::clamp(glm::dot(p - a, d) / glm::dot(d, d), 0.0, 1.0);
        least = std::min(least, glm::length(p - a - t * d));
    }
    return inside ? 0 : least;
}

} // namespace

ShadowCaster::ShadowCaster(ConvexSolid s) : solid(std::move(s)) {
    centre = boundsOf(solid.corners).centre();
    for (const glm::dvec3& p : solid.corners) radius = std::max(radius, glm::length(p - centre));
}

bool PlaneView::reaches(glm::dvec2 p) const {
    if (!seen || glm::length(p - foot) >= reach) return false;
    for (const auto& [n, offset] : borders)
        if (glm::dot(n, p) <= offset) return false;
    return std::ranges::none_of(shadows, [&](const ConvexOutline& s) { return s.contains(p); });
}

PlaneView viewOfPlane(const PlaneFrame& plane, std::span<const glm::dvec2> hull, glm::dvec3 projector,
                      const std::array<glm::dvec3, 4>& pictureBorders, double leastCosine,
                      std::span<const ShadowCaster> casters) {
    PlaneView view;
    view.height = glm::dot(projector - plane.origin, plane.normal);
    if (view.height <= 0) return view;
    view.foot = plane.flat(projector);
    view.reach = leastCosine > 0 ? view.height * std::sqrt(1 / (leastCosine * leastCosine) - 1)
                                 : std::numeric_limits<double>::infinity();
    if (distanceTo(hull, view.foot) >= view.reach) return view;
    for (const glm::dvec3& n : pictureBorders) {
        const glm::dvec2 flat(glm::dot(n, plane.u), glm::dot(n, plane.v));
        const double offset = glm::dot(n, projector - plane.origin);
        if (allOutside(hull, flat, offset)) return view;
        view.borders.emplace_back(flat, offset);
    }
    // Outward normals of the pyramid from the projector over the hull.
    std::vector<glm::dvec3> sides;
    for (size_t i = 0; i < hull.size(); ++i)
        sides.push_back(glm::normalize(glm::cross(plane.inSpace(hull[i]) - projector,
                                                  plane.inSpace(hull[(i + 1) % hull.size()]) - projector)));
    const FlatBox box = boxOf(hull);
    for (const ShadowCaster& caster : casters) {
        // Which solids are out of the way, first by the balls round them.
        const glm::dvec3 c = caster.centre - projector;
        if (glm::dot(caster.centre - plane.origin, plane.normal) + caster.radius <= kSkin) continue;
        if (std::ranges::any_of(sides, [&](const glm::dvec3& n) { return glm::dot(n, c) > caster.radius; }))
            continue;
        const auto& corners = caster.solid.corners;
        const auto beyond = [&](const glm::dvec3& n) {
            return std::ranges::all_of(corners,
                                       [&](const glm::dvec3& p) { return glm::dot(n, p - projector) >= 0; });
        };
        const auto low = [&](const glm::dvec3& p) {
            return glm::dot(p - plane.origin, plane.normal) <= kSkin;
        };
        if (std::ranges::all_of(corners, low) || std::ranges::any_of(sides, beyond)) continue;
        ConvexOutline shadow = shadowOnPlane(caster.solid, projector, plane, kSkin, box);
        if (shadow.points.empty()) continue;
        if (std::ranges::all_of(hull, [&](glm::dvec2 p) { return shadow.contains(p); })) return view;
        view.shadows.push_back(std::move(shadow));
    }
    view.seen = true;
    return view;
}

void appendOutline(const PlaneView& view, glm::dvec2 low, glm::dvec2 high, std::vector<Segment>& out) {
    if (view.seen) OutlineFinder(view, low, high, out).find();
}

} // namespace heliodon::geometry
