#include "geometry/plane_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"
#include "geometry/segment_distance.h"

namespace heliodon::geometry {

namespace {

// Metres: outlines are straightened by up to 0.1 in against the walls behind them.
constexpr double kSkin = 0.0025;
constexpr double kNudge = 1e-7;    // metres
constexpr double kShortest = 1e-6; // metres
constexpr double kChord = 2e-4;    // metres: between the circle of the least n . d and its chords

// Parameters of a line, within 0 .. 1, between which something holds; empty when from >= to.
struct Interval {
    double from = 0, to = 1;
    bool empty() const { return from >= to; }
    // Keeps where value + t slope > 0. Most lines lie on one side of what they are asked for.
    void keep(double value, double slope) {
        const bool atStart = value > 0, atEnd = value + slope > 0;
        if (!atStart && !atEnd)
            to = from;
        else if (!atStart)
            from = std::max(from, -value / slope);
        else if (!atEnd)
            to = std::min(to, -value / slope);
    }
};

Interval insideOf(const ConvexOutline& outline, glm::dvec2 a, glm::dvec2 d) {
    Interval in;
    glm::dvec2 from = outline.points.back();
    for (const glm::dvec2 to : outline.points) {
        in.keep(cross(to - from, a - from), cross(to - from, d));
        if (in.empty()) break;
        from = to;
    }
    return in;
}

class OutlineFinder {
public:
    OutlineFinder(const PlaneView& view, const FlatBox& box, std::vector<Segment>& out)
        : view_(view), box_(box), out_(out) {}

    void find(std::span<const Segment> limit) {
        for (size_t s = 0; s < view_.shadows.size(); ++s) {
            glm::dvec2 from = view_.shadows[s].points.back();
            for (const glm::dvec2 to : view_.shadows[s].points) {
                add(from, to, s, kNone, true);
                from = to;
            }
        }
        const double size = glm::length(box_.high - box_.low);
        const glm::dvec2 middle = 0.5 * (box_.low + box_.high);
        for (size_t b = 0; b < view_.borders.size(); ++b) {
            const auto& [n, offset] = view_.borders[b];
            const double length = glm::length(n);
            if (length < 1e-12) continue;
            const glm::dvec2 on = middle + n * ((offset - glm::dot(n, middle)) / (length * length)),
                             along = glm::dvec2(-n.y, n.x) * (size / length);
            add(on - along, on + along, kNone, b, true);
        }
        if (std::isfinite(view_.reach)) addCircle();
        for (const Segment& line : limit) add(line[0], line[1], kNone, kNone, false);
    }

private:
    static constexpr size_t kNone = static_cast<size_t>(-1);

    void addCircle() {
        const double r = view_.reach;
        const glm::dvec2 far = glm::max(glm::abs(box_.low - view_.foot), glm::abs(box_.high - view_.foot));
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
        if (!FlatBox{glm::min(a, b), glm::max(a, b)}.meets(box_)) return;
        const glm::dvec2 d = b - a;
        Interval in;
        for (int c = 0; c < 2; ++c) {
            in.keep(a[c] - box_.low[c], d[c]);
            in.keep(box_.high[c] - a[c], -d[c]);
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
        const FlatBox kept = boxOf(std::array{a + in.from * d + outward, a + in.to * d + outward});
        hidden_.clear();
        for (size_t s = 0; s < view_.shadows.size(); ++s) {
            const ConvexOutline& shadow = view_.shadows[s];
            if (s == ownShadow || !kept.meets(shadow.box)) continue;
            Interval dark = insideOf(shadow, a + outward, d);
            dark.from = std::max(dark.from, in.from);
            dark.to = std::min(dark.to, in.to);
            if (dark.from <= in.from && dark.to >= in.to) return;
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
    const FlatBox& box_;
    std::vector<Segment>& out_;
    std::vector<Interval> hidden_;
};

bool allOutside(std::span<const glm::dvec2> hull, glm::dvec2 n, double offset) {
    return std::ranges::all_of(hull, [&](glm::dvec2 p) { return glm::dot(n, p) <= offset; });
}

double distanceTo(std::span<const glm::dvec2> hull, glm::dvec2 p) {
    double least = std::numeric_limits<double>::infinity();
    bool inside = true;
    for (size_t i = 0; i < hull.size(); ++i) {
        const glm::dvec2 a = hull[i], d = hull[(i + 1) % hull.size()] - a;
        inside = inside && cross(d, p - a) >= 0;
        least = std::min(least, distanceToSegment(p, a, a + d));
    }
    return inside ? 0 : least;
}

// Clockwise in the image, whose y runs down; empty when not all of it lies before the projector.
std::vector<glm::dvec2> imageOfHull(const PlaneFrame& plane, std::span<const glm::dvec2> hull,
                                    const OpticalDevice& projector) {
    std::vector<glm::dvec2> image;
    for (const glm::dvec2 p : hull) {
        const auto at = imageOf(plane.inSpace(p), projector);
        if (!at) return {};
        image.push_back(*at);
    }
    return image;
}

// Whether one side of the hull (clockwise) has all of the points beyond it.
bool liesBeside(std::span<const glm::dvec2> points, std::span<const glm::dvec2> hull) {
    glm::dvec2 from = hull.back();
    for (const glm::dvec2 to : hull) {
        if (std::ranges::all_of(points, [&](glm::dvec2 p) { return cross(to - from, p - from) >= 0; }))
            return true;
        from = to;
    }
    return false;
}

} // namespace

Beam::Beam(const OpticalDevice& device, std::span<const ConvexSolid> solids)
    : projector(device), centre(device.centre()), borders(pictureBorders(device)), casters(solids) {
    for (const ConvexSolid& solid : solids) outlines.push_back(imageOutline(solid, device));
}

bool PlaneView::reaches(glm::dvec2 p) const {
    if (!seen || glm::length(p - foot) >= reach) return false;
    for (const auto& [n, offset] : borders)
        if (glm::dot(n, p) <= offset) return false;
    return std::ranges::none_of(shadows, [&](const ConvexOutline& s) { return s.contains(p); });
}

PlaneView viewOfPlane(const PlaneFrame& plane, std::span<const glm::dvec2> hull, const Beam& beam,
                      double leastCosine) {
    PlaneView view;
    view.height = glm::dot(beam.centre - plane.origin, plane.normal);
    if (view.height <= 0) return view;
    view.foot = plane.flat(beam.centre);
    view.reach = leastCosine > 0 ? view.height * std::sqrt(1 / (leastCosine * leastCosine) - 1)
                                 : std::numeric_limits<double>::infinity();
    if (distanceTo(hull, view.foot) >= view.reach) return view;
    for (const glm::dvec3& n : beam.borders) {
        const glm::dvec2 flat(glm::dot(n, plane.u), glm::dot(n, plane.v));
        const double offset = glm::dot(n, beam.centre - plane.origin);
        if (allOutside(hull, flat, offset)) return view;
        if (!allOutside(hull, -flat, -offset)) view.borders.emplace_back(flat, offset);
    }
    if (std::ranges::all_of(hull, [&](glm::dvec2 p) { return glm::length(p - view.foot) < view.reach; }))
        view.reach = std::numeric_limits<double>::infinity();
    // Most solids are out of the way, which their images tell.
    const std::vector<glm::dvec2> image = imageOfHull(plane, hull, beam.projector);
    const FlatBox imageBox = boxOf(image), box = boxOf(hull);
    for (size_t c = 0; c < beam.casters.size(); ++c) {
        const ImageOutline* outline = beam.outlines[c] ? &*beam.outlines[c] : nullptr;
        if (outline && !image.empty() &&
            (!outline->box.meets(imageBox) || liesBeside(outline->points, image)))
            continue;
        ConvexOutline shadow = shadowOnPlane(beam.casters[c], outline, beam.centre, plane, kSkin, box);
        if (shadow.points.empty()) continue;
        if (std::ranges::all_of(hull, [&](glm::dvec2 p) { return shadow.contains(p); })) return view;
        view.shadows.push_back(std::move(shadow));
    }
    view.seen = true;
    return view;
}

void appendOutline(const PlaneView& view, const FlatBox& box, std::span<const Segment> limit,
                   std::vector<Segment>& out) {
    if (view.seen) OutlineFinder(view, box, out).find(limit);
}

} // namespace heliodon::geometry
