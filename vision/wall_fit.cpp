// Section 4.1, "estimate the 3D positions of planar wall primitives". Ours differs: both sides are measured
// at sub-pixel level in plan inches, at the height that the colour states, so that the lens does not bend
// them; the line goes through the middles of the two sides, where what widens the strip evenly (blur, a
// marker's fold) cancels.
#include "vision/wall_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "vision/bare_paint.h"
#include "vision/edges.h"
#include "vision/median.h"
#include "vision/pieces.h"

namespace heliodon::vision {
namespace {

using geometry::Detection;
using geometry::HeightClass;
using geometry::WindowMarker;

struct Span {
    double low = 0, high = 0;
    const Component* marker = nullptr; // null: the wall's own paint
};

// A line in plan with positions along it.
struct Axis {
    glm::dvec2 origin{}, along{1, 0};
    glm::dvec2 at(double s, double t = 0) const { return origin + s * along + t * turnedLeft(along); }
};

Span spanOf(const Component& component, const Axis& axis, const PlanView& view, double height) {
    std::vector<double> s;
    for (const auto& p : planPoints(component, view, height))
        s.push_back(glm::dot(p - axis.origin, axis.along));
    const auto [low, high] = std::minmax_element(s.begin(), s.end());
    return {*low, *high, nullptr};
}

// Without a fringe of a pixel or two along an edge of what is beside it, of which blur or the file makes the
// marker's hue: it is much narrower than the marker.
Span withoutFringes(Span span, const Axis& axis, const PlanView& view, double height) {
    constexpr double kNarrow = 0.5, kLeast = 3.5; // of the marker's width; pixels of length
    const double pixel = 1 / view.pixelsPerInch(axis.at(span.low), height);
    std::vector<int> slices(static_cast<size_t>((span.high - span.low) / pixel) + 1, 0);
    for (const auto& p : planPoints(*span.marker, view, height)) {
        const double s = (glm::dot(p - axis.origin, axis.along) - span.low) / pixel;
        ++slices[std::min(slices.size() - 1, static_cast<size_t>(std::max(s, 0.0)))];
    }
    const auto isWide = [wide = kNarrow * median(slices)](int width) { return width >= wide; };
    const auto before = std::find_if(slices.begin(), slices.end(), isWide) - slices.begin(),
               after = std::find_if(slices.rbegin(), slices.rend(), isWide) - slices.rbegin();
    if (static_cast<double>(before) > kLeast) span.low += static_cast<double>(before) * pixel;
    if (static_cast<double>(after) > kLeast) span.high -= static_cast<double>(after) * pixel;
    return span;
}

// The strip's visible stretches in order along the axis; markers lie on top of paint.
std::vector<Span> spansOf(const Chain& chain, const Axis& axis, const PlanView& view, double height,
                          double fold) {
    std::vector<Span> spans;
    for (const Component* piece : chain.pieces) spans.push_back(spanOf(*piece, axis, view, height));
    for (const Component* marker : chain.markers) {
        spans.push_back(spanOf(*marker, axis, view, height + fold));
        spans.back().marker = marker;
        spans.back() = withoutFringes(spans.back(), axis, view, height + fold);
    }
    std::sort(spans.begin(), spans.end(), [](const Span& a, const Span& b) { return a.low < b.low; });
    return spans;
}

struct Sides {
    std::vector<glm::dvec2> middles; // (s, t)
    std::vector<double> widths;      // of the wall's own paint
    int asked = 0, seen = 0;
};

Sides measureSides(const std::vector<Span>& spans, const Axis& axis, const PlanView& view, double height,
                   const DetectOptions& options, EdgeLook look) {
    Sides out;
    const double pixel = 1 / view.pixelsPerInch(axis.origin, height);
    for (const Span& span : spans) {
        // A marker's top hangs over the wall by its card's thickness on either side, twice that where two
        // overlap.
        const double half = 0.5 * options.wallThickness + (span.marker ? 1.3 * options.markerThickness : 0);
        const double top = height + (span.marker ? options.markerThickness : 0);
        const double margin = std::min(3 * pixel, 0.3 * (span.high - span.low));
        const int n = std::max(2, static_cast<int>((span.high - span.low - 2 * margin) / (3 * pixel)));
        for (int i = 0; i <= n; ++i) {
            const double s = span.low + margin + (span.high - span.low - 2 * margin) * i / n;
            std::optional<double> side[2];
            for (int k = 0; k < 2; ++k) {
                EdgeProbe probe;
                probe.outward = (k ? -1.0 : 1.0) * turnedLeft(axis.along);
                probe.at = axis.at(s) + half * probe.outward;
                probe.lateral = 1.2 * pixel * axis.along;
                probe.height = top;
                probe.look = look;
                if (const auto edge = findEdge(view, probe); edge && std::abs(*edge) < 0.14)
                    side[k] = half + *edge;
            }
            ++out.asked;
            if (!side[0] || !side[1]) continue;
            ++out.seen;
            out.middles.emplace_back(s, 0.5 * (*side[0] - *side[1]));
            if (!span.marker) out.widths.push_back(*side[0] + *side[1]);
        }
    }
    return out;
}

// Moves the axis on to the fitted line.
void follow(Axis& axis, const LineFit& fit) {
    axis.origin = axis.at(0, fit.offset);
    axis.along = glm::normalize(axis.along + fit.slope * turnedLeft(axis.along));
}

constexpr double kMostBend = 0.06; // sagitta of a straight wall: inches

// How far the middles bend off the line, in inches, between its ends and its middle.
double sagitta(const std::vector<glm::dvec2>& middles) {
    const auto [low, high] = std::minmax_element(middles.begin(), middles.end(),
                                                 [](glm::dvec2 a, glm::dvec2 b) { return a.x < b.x; });
    const double begin = low->x, length = high->x - begin;
    if (length < 1) return 0;
    std::array<std::vector<double>, 3> thirds;
    for (const auto& p : middles)
        thirds[std::min<size_t>(2, static_cast<size_t>(3 * (p.x - begin) / length))].push_back(p.y);
    double m[3];
    for (size_t i = 0; i < 3; ++i) {
        if (thirds[i].size() < 3) return 0;
        m[i] = median(std::move(thirds[i]));
    }
    // Medians of the outer thirds lie 1/3 of the length from the middle: there a parabola has 4/9 of its
    // sagitta.
    return (m[1] - 0.5 * (m[0] + m[2])) * 9 / 4;
}

double refinedEnd(const Axis& axis, double s, int sign, const PlanView& view, double height, double room) {
    EdgeProbe probe;
    probe.at = axis.at(s);
    probe.outward = static_cast<double>(sign) * axis.along;
    probe.lateral = 0.12 * turnedLeft(axis.along);
    probe.lateralSamples = 7;
    probe.height = height;
    probe.inside = std::min(0.2, 0.8 * room);
    probe.outside = 0.22;
    const auto edge = findEdge(view, probe);
    return edge && std::abs(*edge) < 0.15 ? s + sign * *edge : s;
}

std::vector<glm::dvec2> stripOutline(const Axis& axis, double low, double high, double half, double height,
                                     const PlanView& view) {
    std::vector<glm::dvec2> out;
    const int n = std::max(1, static_cast<int>((high - low) / 1.5)); // enough corners to follow the lens
    for (int i = 0; i <= n; ++i) out.push_back(view.pixel(axis.at(low + (high - low) * i / n, half), height));
    for (int i = n; i >= 0; --i)
        out.push_back(view.pixel(axis.at(low + (high - low) * i / n, -half), height));
    return out;
}

geometry::WindowKind kindOf(Paint paint) {
    using geometry::WindowKind;
    return paint == Paint::cyan      ? WindowKind::standard
           : paint == Paint::magenta ? WindowKind::picture
                                     : WindowKind::transom;
}

// Where a wall ends that has a marker over the last of its paint: its unpainted end further at most, and what
// paint is too narrow to be seen beyond the marker. The white end's own edge is looked for; without it the
// middle of what is possible is taken.
double endBeyondMarker(const Axis& axis, double s, int sign, const PlanView& view, double height,
                       double unpainted) {
    EdgeProbe probe;
    probe.outward = static_cast<double>(sign) * axis.along;
    probe.at = axis.at(s) + 0.5 * unpainted * probe.outward;
    probe.lateral = 0.1 * turnedLeft(axis.along);
    probe.lateralSamples = 7;
    probe.height = height;
    probe.inside = 0.35 * unpainted;
    probe.outside = unpainted;
    const auto edge = findEdge(view, probe);
    const bool found = edge && *edge > -0.35 * unpainted && *edge < 0.8 * unpainted;
    return s + sign * (0.5 * unpainted + (found ? *edge : 0));
}

std::vector<WindowMarker> findWindows(std::vector<Span> spans, const Axis& axis, const PlanView& view,
                                      double height, const DetectOptions& options) {
    std::erase_if(spans, [](const Span& s) { return !s.marker; });
    std::vector<WindowMarker> out;
    const double top = height + options.markerThickness;
    for (size_t i = 0; i < spans.size(); ++i) {
        Span span = spans[i];
        // Markers of one colour that overlap or meet are one wide window.
        while (i + 1 < spans.size() && spans[i + 1].marker->group == span.marker->group &&
               spans[i + 1].low < span.high + 0.2)
            span.high = std::max(span.high, spans[++i].high);
        const double room = span.high - span.low;
        const double low = refinedEnd(axis, span.low, -1, view, top, room);
        const double high = refinedEnd(axis, span.high, 1, view, top, room);
        WindowMarker window;
        window.kind = kindOf(span.marker->group);
        if (high - low < options.wallThickness) continue; // a speck
        window.pos = 0.5 * (low + high);
        window.width = high - low;
        out.push_back(window);
    }
    return out;
}

// Along a wall from its right end, or its upper one, while `a` is the other.
bool isBackwards(glm::dvec2 along) {
    return along.x < -1e-3 || (std::abs(along.x) <= 1e-3 && along.y < 0);
}

Axis axisOf(const Pca& pca) {
    return {pca.mean, isBackwards(pca.axis) ? -pca.axis : pca.axis};
}

struct StripFit {
    Axis axis;
    std::vector<Span> spans;
    Sides sides;
    std::optional<LineFit> line;
    double bend = 0; // sagitta, inches

    double width() const { // median of the paint's own; 0 without
        return sides.widths.size() < 3 ? 0 : median(sides.widths);
    }
};

StripFit fitStrip(const Chain& chain, const Pca& pca, const PlanView& view, const DetectOptions& options,
                  EdgeLook look) {
    const double height = heightOf(chain.paint);
    StripFit fit;
    fit.axis = axisOf(pca);
    for (int pass = 0; pass < 2; ++pass) {
        fit.spans = spansOf(chain, fit.axis, view, height, options.markerThickness);
        fit.sides = measureSides(fit.spans, fit.axis, view, height, options, look);
        fit.line = fitLine(fit.sides.middles, 2 / view.pixelsPerInch(fit.axis.origin, height));
        if (!fit.line) break;
        fit.bend = sagitta(fit.sides.middles);
        if (chain.markers.empty() && std::abs(fit.bend) > kMostBend) break;
        const double correction =
            std::abs(fit.line->offset) + std::abs(fit.line->slope) * 0.5 * (pca.high - pca.low);
        follow(fit.axis, *fit.line);
        if (correction < 0.04) break;
    }
    return fit;
}

std::vector<glm::dvec2> pointsOf(const Chain& chain, const PlanView& view) {
    std::vector<glm::dvec2> points;
    for (const auto* list : {&chain.pieces, &chain.markers})
        for (const Component* component : *list)
            for (const auto& p : planPoints(*component, view, heightOf(chain.paint))) points.push_back(p);
    return points;
}

// As long as the paint of a wall, and about as narrow.
bool isStrip(const Pca& pca, double height, const PlanView& view, const DetectOptions& options) {
    return pca.high - pca.low >= options.shortestWall - 2 * options.unpaintedEnd &&
           pca.minor <= 1.5 * stripSpread(view, pca.mean, height, options);
}

} // namespace

std::optional<double> straightWidth(const Chain& chain, const PlanView& view, const DetectOptions& options) {
    constexpr double kSeen = 0.6;
    const Pca pca = principalAxes(pointsOf(chain, view));
    if (!isStrip(pca, heightOf(chain.paint), view, options)) return std::nullopt;
    const StripFit fit = fitStrip(chain, pca, view, options, EdgeLook::light);
    if (!fit.line || std::abs(fit.bend) > kMostBend || fit.sides.seen < kSeen * fit.sides.asked ||
        fit.width() <= 0)
        return std::nullopt;
    return fit.width();
}

std::vector<glm::dvec2> wallOutline(const geometry::Wall& wall, const PlanView& view) {
    return stripOutline({wall.a, glm::normalize(wall.b - wall.a)}, 0, glm::distance(wall.a, wall.b),
                        0.5 * wall.thickness, geometry::heightInches(wall.heightClass), view);
}

std::vector<glm::dvec2> windowOutline(const geometry::Wall& wall, const WindowMarker& window,
                                      const PlanView& view, const DetectOptions& options) {
    return stripOutline({wall.a, glm::normalize(wall.b - wall.a)}, window.pos - 0.5 * window.width,
                        window.pos + 0.5 * window.width, 0.5 * wall.thickness + options.markerThickness,
                        geometry::heightInches(wall.heightClass) + options.markerThickness, view);
}

bool isWallThickness(double measured, const PlanView& view, glm::dvec2 plan, double height,
                     const DetectOptions& options) {
    // The median of two sides is known to a fraction of a pixel; a pen is thinner, a folded cloth thicker.
    const double tolerance = 0.1 * options.wallThickness + 0.6 / view.pixelsPerInch(plan, height);
    return std::abs(measured - options.wallThickness) < tolerance;
}

namespace {

// The sides of a wall's straight paint; nothing where it is as wide as no wall's.
std::optional<StripFit> fitWallStrip(const Chain& chain, const Pca& pca, const PlanView& view,
                                     const DetectOptions& options) {
    const double height = heightOf(chain.paint), thickness = options.wallThickness;
    // A strip's standard deviation across is its width / sqrt(12).
    const double strip = thickness / std::sqrt(12.0);
    const auto isWall = [&](const StripFit& fit) {
        if (chain.markers.empty() && std::abs(fit.bend) > kMostBend) return false;
        if (fit.sides.widths.size() >= 3)
            return isWallThickness(fit.width(), view, axisOf(pca).origin, height, options);
        // Its sides were not seen: the shape of its paint counts.
        return pca.minor <= 1.25 * strip && pca.minor >= 0.6 * strip && pca.high - pca.low >= 2 * thickness;
    };
    StripFit fit = fitStrip(chain, pca, view, options, EdgeLook::light);
    // A narrow face in its own shadow beside the paint: where it is as dark as the paint, its far edge looks
    // like the paint's.
    if (std::abs(fit.width() / thickness - 1) > 0.12)
        if (StripFit byColour = fitStrip(chain, pca, view, options, EdgeLook::colour);
            byColour.line && std::abs(byColour.width() - thickness) < std::abs(fit.width() - thickness))
            fit = std::move(byColour);
    // A strip that is too wide in light and in colour can be a wall's in a picture that was scaled.
    if (!isWall(fit) && fit.width() > thickness)
        if (StripFit encoded = fitStrip(chain, pca, view, options, EdgeLook::encoded);
            encoded.line && encoded.width() > 0)
            fit = std::move(encoded);
    if (!isWall(fit)) return std::nullopt;
    return fit;
}

// A few edges of a short wall, read wrong, bend its middle line, but not the circle through all of them.
std::optional<StraightWall> hardlyBent(const Chain& chain, const PlanView& view,
                                       const DetectOptions& options) {
    constexpr double kLeastSagitta = 0.05; // inches
    const auto arc = fitArc(chain, view, options);
    if (!arc) return std::nullopt;
    const double half = glm::radians(0.5 * (arc->a1Deg - arc->a0Deg));
    if (arc->radius * (1 - std::cos(half)) > kLeastSagitta) return std::nullopt;
    const auto at = [&](double degrees) {
        const double a = glm::radians(degrees);
        return arc->center + arc->radius * glm::dvec2(std::cos(a), std::sin(a));
    };
    StraightWall out;
    out.wall.a = at(arc->a0Deg), out.wall.b = at(arc->a1Deg);
    if (isBackwards(out.wall.b - out.wall.a)) std::swap(out.wall.a, out.wall.b);
    out.wall.thickness = arc->thickness, out.wall.heightClass = arc->heightClass;
    out.wall.detection = {arc->detection.confidence, wallOutline(out.wall, view)};
    return out;
}

} // namespace

std::optional<StraightWall> fitStraight(const Chain& chain, const PlanView& view,
                                        const DetectOptions& options) {
    const double height = heightOf(chain.paint);
    const Pca pca = principalAxes(pointsOf(chain, view));
    if (!isStrip(pca, height, view, options)) return std::nullopt;
    const std::optional<StripFit> fit = fitWallStrip(chain, pca, view, options);
    if (!fit) return chain.markers.empty() ? hardlyBent(chain, view, options) : std::nullopt;

    const auto& [axis, spans, sides, line, bend] = *fit;
    const Span first = spans.front();
    const Span last = *std::max_element(spans.begin(), spans.end(),
                                        [](const Span& a, const Span& b) { return a.high < b.high; });
    const auto own = std::find_if(spans.begin(), spans.end(), [](const Span& s) { return !s.marker; });
    const auto barePaintPast = [&](const Span& marker, double edge, int sign) {
        if (own == spans.end()) return 0.0;
        return barePaintBeyond({axis.at(edge), static_cast<double>(sign) * axis.along, height,
                                marker.high - marker.low, axis.at(0.5 * (own->low + own->high))},
                               view);
    };
    auto endOf = [&](const Span& span, int sign) {
        const double s = sign < 0 ? span.low : span.high;
        const double top = height + (span.marker ? options.markerThickness : 0);
        const double edge = refinedEnd(axis, s, sign, view, top, span.high - span.low);
        if (!span.marker) return edge + sign * options.unpaintedEnd;
        if (const double bare = barePaintPast(span, edge, sign); bare > 0)
            return refinedEnd(axis, edge + sign * bare, sign, view, height, bare) +
                   sign * options.unpaintedEnd;
        return endBeyondMarker(axis, edge, sign, view, height, options.unpaintedEnd);
    };
    const double low = endOf(first, -1), high = endOf(last, 1);
    StraightWall out;
    out.wall.a = axis.at(low), out.wall.b = axis.at(high);
    out.wall.thickness = options.wallThickness;
    out.wall.heightClass = heightClassOf(chain.paint);
    const double seen = sides.asked ? static_cast<double>(sides.seen) / sides.asked : 0;
    out.wall.detection.confidence = std::clamp(0.4 + 0.6 * seen, 0.0, 1.0);
    out.wall.detection.outlinePx = wallOutline(out.wall, view);
    out.windows = findWindows(spans, axis, view, height, options);
    for (WindowMarker& window : out.windows) {
        window.pos -= low;
        window.detection.confidence = out.wall.detection.confidence;
        window.detection.outlinePx = windowOutline(out.wall, window, view, options);
    }
    return out;
}

} // namespace heliodon::vision
