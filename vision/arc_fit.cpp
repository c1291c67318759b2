// Curved walls (section 4.1): back-projected first, since a circle is not one in the picture; a circle
// through all points splits the edges in an inner and an outer set; both are fitted anew with one centre.
// Ours measures the edges at sub-pixel level.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "vision/edges.h"
#include "vision/median.h"
#include "vision/pieces.h"
#include "vision/wall_fit.h"

namespace heliodon::vision {
namespace {

struct Circle {
    glm::dvec2 centre{};
    double radius = 0;
    double off = 0; // root mean square distance of the points that it stands for
};

// I. Kasa, "A circle fitting procedure and its error analysis" (1976): linear least squares.
std::optional<Circle> throughPoints(const std::vector<glm::dvec2>& points) {
    glm::dvec2 mean{};
    for (const auto& p : points) mean += p / static_cast<double>(points.size());
    glm::dmat3 normal(0);
    glm::dvec3 right(0);
    for (const auto& point : points) {
        const glm::dvec2 p = point - mean;
        const glm::dvec3 row(p, 1);
        normal += glm::outerProduct(row, row);
        right += glm::dot(p, p) * row;
    }
    if (std::abs(glm::determinant(normal)) < 1e-9) return std::nullopt;
    const glm::dvec3 solution = glm::inverse(normal) * right;
    const glm::dvec2 c = 0.5 * glm::dvec2(solution);
    const double squared = solution.z + glm::dot(c, c);
    if (!(squared > 0)) return std::nullopt;
    return Circle{c + mean, std::sqrt(squared), 0};
}

// Root mean square of the points' distances from the circle.
double distanceFrom(const Circle& circle, const std::vector<glm::dvec2>& points) {
    double squares = 0;
    for (const auto& p : points) {
        const double off = glm::distance(p, circle.centre) - circle.radius;
        squares += off * off / static_cast<double>(points.size());
    }
    return std::sqrt(squares);
}

// Middles of the strip, in slices across its long axis.
std::vector<glm::dvec2> sliceMeans(const std::vector<glm::dvec2>& points) {
    const Pca pca = principalAxes(points);
    constexpr size_t kSlices = 16;
    std::array<glm::dvec3, kSlices> sums{};
    for (const auto& p : points) {
        const double s = glm::dot(p - pca.mean, pca.axis);
        const double share = (s - pca.low) / std::max(pca.high - pca.low, 1e-9);
        sums[std::min(kSlices - 1, static_cast<size_t>(share * kSlices))] += glm::dvec3(p, 1);
    }
    std::vector<glm::dvec2> out;
    for (const auto& sum : sums)
        if (sum.z > 0) out.push_back(glm::dvec2(sum) / sum.z);
    return out;
}

// The strip's centre line. Through all points for a long arc; a short one is thicker than it is bent, which
// would draw that circle together, so there through the slices' middles: whichever lies closer to the points.
std::optional<Circle> centreCircle(const std::vector<glm::dvec2>& points) {
    std::optional<Circle> best;
    for (const auto& on : {points, sliceMeans(points)}) {
        auto circle = throughPoints(on);
        if (!circle || circle->radius < 0.75 || circle->radius > 200) continue;
        circle->off = distanceFrom(*circle, points);
        if (!best || circle->off < best->off) best = circle;
    }
    return best;
}

struct Rings {
    glm::dvec2 centre{};
    double inner = 0, outer = 0;
};

double medianDistance(const std::vector<glm::dvec2>& points, glm::dvec2 centre) {
    std::vector<double> distances;
    for (const auto& p : points) distances.push_back(glm::distance(p, centre));
    return median(std::move(distances));
}

// Gauss-Newton on both rings at once; `inner` and `outer` are points on them.
void refine(Rings& rings, const std::vector<glm::dvec2>& inner, const std::vector<glm::dvec2>& outer,
            double outlier) {
    for (int round = 0; round < 8; ++round) {
        double limit = round < 3 ? outlier : 0.5 * outlier;
        // The radii eliminate themselves: each is the mean distance of its points.
        double xx = 0, xy = 0, yy = 0, rx = 0, ry = 0;
        for (const auto* points : {&inner, &outer}) {
            double& radius = points == &inner ? rings.inner : rings.outer;
            radius = medianDistance(*points, rings.centre); // a moved centre changes it by as much
            double n = 0, sum = 0;
            glm::dvec2 direction{};
            for (const auto& p : *points) {
                const double d = glm::distance(p, rings.centre);
                if (std::abs(d - radius) > limit) continue;
                n += 1, sum += d, direction += (p - rings.centre) / d;
            }
            if (n < 3) continue;
            radius = sum / n;
            direction /= n;
            for (const auto& p : *points) {
                const double d = glm::distance(p, rings.centre);
                if (std::abs(d - radius) > limit) continue;
                const glm::dvec2 g = (p - rings.centre) / d - direction;
                xx += g.x * g.x, xy += g.x * g.y, yy += g.y * g.y;
                rx += g.x * (d - radius), ry += g.y * (d - radius);
            }
        }
        const double det = xx * yy - xy * xy;
        if (det < 1e-12) return;
        const glm::dvec2 step((yy * rx - xy * ry) / det, (xx * ry - xy * rx) / det);
        rings.centre += step;
        if (round > 4 && glm::length(step) < 1e-6) return;
    }
}

glm::dvec2 direction(double angle) {
    return {std::cos(angle), std::sin(angle)};
}

// Counter-clockwise from `first` to `second`, the stretch that holds the points: what is left of the largest
// gap.
std::pair<double, double> angularExtent(const std::vector<glm::dvec2>& points, glm::dvec2 centre) {
    std::vector<double> angles;
    for (const auto& p : points) angles.push_back(std::atan2(p.y - centre.y, p.x - centre.x));
    std::sort(angles.begin(), angles.end());
    double gap = angles.front() + 2 * std::numbers::pi - angles.back();
    double low = angles.front(), high = angles.back();
    for (size_t i = 1; i < angles.size(); ++i)
        if (angles[i] - angles[i - 1] > gap)
            gap = angles[i] - angles[i - 1], low = angles[i], high = angles[i - 1] + 2 * std::numbers::pi;
    return {low, high};
}

// What is known of an arc, and how it is measured.
struct ArcProbe {
    const std::vector<glm::dvec2>& points; // its paint, plan
    const PlanView& view;
    double height, half, pixel; // of the wall, half its thickness, a pixel: inches
    EdgeLook look;
};

struct RingPoints {
    std::vector<glm::dvec2> inner, outer;
};

// The paint's edges along `n` rays from the centre.
RingPoints edgesOf(const ArcProbe& arc, const Rings& rings, int n) {
    RingPoints out;
    const auto [low, high] = angularExtent(arc.points, rings.centre);
    const double middle = 0.5 * (rings.inner + rings.outer);
    for (int i = 1; i < n; ++i) {
        const glm::dvec2 radial = direction(low + (high - low) * i / n);
        for (const double sign : {-1.0, 1.0}) {
            EdgeProbe probe;
            probe.outward = sign * radial;
            probe.at = rings.centre + (middle + sign * arc.half) * radial;
            probe.lateral = 1.2 * arc.pixel * turnedLeft(radial);
            probe.height = arc.height;
            probe.look = arc.look;
            const auto edge = findEdge(arc.view, probe);
            if (!edge || std::abs(*edge) > 0.14) continue;
            (sign < 0 ? out.inner : out.outer).push_back(probe.at + *edge * probe.outward);
        }
    }
    return out;
}

// The angle at which the paint ends; `sign`: 1 counter-clockwise.
double refinedEnd(const ArcProbe& arc, const Rings& rings, double angle, double sign) {
    const double radius = 0.5 * (rings.inner + rings.outer);
    EdgeProbe probe;
    probe.outward = sign * turnedLeft(direction(angle));
    probe.at = rings.centre + radius * direction(angle);
    probe.lateral = 0.12 * direction(angle);
    probe.lateralSamples = 7;
    probe.height = arc.height;
    const auto edge = findEdge(arc.view, probe);
    return angle + (edge && std::abs(*edge) < 0.15 ? sign * *edge / radius : 0);
}

std::vector<glm::dvec2> outlineOf(const ArcProbe& probe, glm::dvec2 centre, double radius, double a0,
                                  double a1) {
    std::vector<glm::dvec2> out;
    const int corners = std::max(4, static_cast<int>((a1 - a0) * 12));
    for (const double side : {probe.half, -probe.half})
        for (int i = 0; i <= corners; ++i) {
            const double a = side > 0 ? a0 + (a1 - a0) * i / corners : a1 - (a1 - a0) * i / corners;
            out.push_back(probe.view.pixel(centre + (radius + side) * direction(a), probe.height));
        }
    return out;
}

ArcProbe probeOf(const Chain& chain, const std::vector<glm::dvec2>& points, const PlanView& view,
                 const DetectOptions& options, EdgeLook look) {
    const double height = heightOf(chain.paint);
    return {points, view, height, 0.5 * options.wallThickness, 1 / view.pixelsPerInch(points.front(), height),
            look};
}

struct MeasuredRings {
    Rings rings;
    double seen = 0; // share of the edges that were looked for
    double width() const { return rings.outer - rings.inner; }
};

std::optional<MeasuredRings> measureRings(const ArcProbe& probe, const DetectOptions& options) {
    const auto circle = centreCircle(probe.points);
    if (!circle || circle->off > 1.35 * stripSpread(probe.view, probe.points.front(), probe.height, options))
        return std::nullopt;
    MeasuredRings out{{circle->centre, circle->radius - probe.half, circle->radius + probe.half}, 0};
    const auto [low, high] = angularExtent(probe.points, out.rings.centre);
    const double length = (high - low) * circle->radius;
    if (length < options.shortestWall - 2 * options.unpaintedEnd) return std::nullopt;
    const int n = std::max(8, static_cast<int>(length / (3 * probe.pixel)));
    for (int pass = 0; pass < 3; ++pass) {
        const auto [inner, outer] = edgesOf(probe, out.rings, n);
        out.seen = static_cast<double>(inner.size() + outer.size()) / (2.0 * (n - 1));
        if (inner.size() < 4 || outer.size() < 4) return std::nullopt;
        const glm::dvec2 before = out.rings.centre;
        refine(out.rings, inner, outer, (pass == 0 ? 4 : 2) * probe.pixel);
        if (pass > 0 && glm::distance(before, out.rings.centre) < 0.02) break;
    }
    return out;
}

std::optional<geometry::Arc> fitArc(const Chain& chain, const std::vector<glm::dvec2>& points,
                                    const PlanView& view, const DetectOptions& options, EdgeLook look) {
    const ArcProbe probe = probeOf(chain, points, view, options, look);
    const auto measured = measureRings(probe, options);
    if (!measured || !isWallThickness(measured->width(), view, points.front(), probe.height, options))
        return std::nullopt;
    const Rings& rings = measured->rings;
    geometry::Arc arc;
    arc.center = rings.centre;
    arc.radius = 0.5 * (rings.inner + rings.outer);
    const auto [low, high] = angularExtent(points, rings.centre);
    const double end = options.unpaintedEnd / arc.radius;
    const double a0 = refinedEnd(probe, rings, low, -1) - end, a1 = refinedEnd(probe, rings, high, 1) + end;
    arc.a0Deg = a0 * 180 / std::numbers::pi, arc.a1Deg = a1 * 180 / std::numbers::pi;
    arc.thickness = options.wallThickness;
    arc.heightClass = heightClassOf(chain.paint);
    arc.detection.confidence = std::clamp(0.4 + 0.6 * measured->seen, 0.0, 1.0);
    arc.detection.outlinePx = outlineOf(probe, arc.center, arc.radius, a0, a1);
    return arc;
}

std::vector<glm::dvec2> pointsOf(const Chain& chain, const PlanView& view) {
    std::vector<glm::dvec2> points;
    for (const Component* piece : chain.pieces)
        for (const auto& p : planPoints(*piece, view, heightOf(chain.paint))) points.push_back(p);
    return points;
}

} // namespace

std::optional<double> arcWidth(const Chain& chain, const PlanView& view, const DetectOptions& options) {
    constexpr double kSeen = 0.6;
    const auto points = pointsOf(chain, view);
    const auto measured = measureRings(probeOf(chain, points, view, options, EdgeLook::light), options);
    if (!measured || measured->seen < kSeen) return std::nullopt;
    return measured->width();
}

std::optional<geometry::Arc> fitArc(const Chain& chain, const PlanView& view, const DetectOptions& options) {
    const auto points = pointsOf(chain, view);
    for (const EdgeLook look : {EdgeLook::light, EdgeLook::colour, EdgeLook::encoded})
        if (auto arc = fitArc(chain, points, view, options, look)) return arc;
    return std::nullopt;
}

} // namespace heliodon::vision
