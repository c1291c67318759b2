#include "vision/table_marks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include <glm/geometric.hpp>

#include "vision/edges.h"
#include "vision/median.h"
#include "vision/pieces.h"

namespace heliodon::vision {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

struct Box {
    glm::dvec2 centre{}, half{};
    double angle = 0;              // radians
    glm::dvec2 axis(int k) const { // unit, counter-clockwise: 0 along half.x, 1 along half.y
        const double a = angle + k * std::numbers::pi / 2;
        return {std::cos(a), std::sin(a)};
    }
    glm::dvec2 at(double x, double y) const { return centre + x * axis(0) + y * axis(1); }
};

std::vector<glm::dvec2> outlineOf(const Box& box, double height, const PlanView& view) {
    std::vector<glm::dvec2> out;
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
        out.push_back(view.pixel(box.at(x * box.half.x, y * box.half.y), height));
    return out;
}

struct BoxFit {
    Box box;
    double seen = 0; // fraction of the probes that found the edge
};

// Moves each side to its edge in the picture. Opposite sides share a direction, and all four one angle.
BoxFit refineBox(Box box, const PlanView& view, double height, double inside, double outside) {
    const double pixel = 1 / view.pixelsPerInch(box.centre, height);
    BoxFit fit{box, 0};
    for (int pass = 0; pass < 2; ++pass) {
        int asked = 0, seen = 0;
        std::array<std::optional<LineFit>, 4> sides;
        double turn = 0, weight = 0;
        for (int k = 0; k < 4; ++k) {
            const double reach = k % 2 ? fit.box.half.y : fit.box.half.x;
            const double along = 0.8 * (k % 2 ? fit.box.half.x : fit.box.half.y);
            EdgeProbe probe;
            probe.outward = fit.box.axis(k);
            probe.lateral = 1.2 * pixel * fit.box.axis(k + 1);
            probe.height = height, probe.inside = inside, probe.outside = outside;
            const int n = std::max(6, static_cast<int>(along / pixel));
            std::vector<glm::dvec2> points;
            for (int i = 0; i <= n; ++i) {
                const double l = along * (2.0 * i / n - 1);
                probe.at = fit.box.centre + reach * probe.outward + l * fit.box.axis(k + 1);
                if (const auto edge = findEdge(view, probe); edge && std::abs(*edge) < 0.14)
                    points.emplace_back(l, *edge);
            }
            asked += n + 1, seen += static_cast<int>(points.size());
            if (points.size() < 4) continue;
            sides[static_cast<size_t>(k)] = fitLine(points, 2 * pixel);
            if (!sides[static_cast<size_t>(k)]) continue;
            // A line's slope is known with the square of its length and the number of its points.
            const double w = along * along * static_cast<double>(sides[static_cast<size_t>(k)]->kept);
            turn -= w * sides[static_cast<size_t>(k)]->slope, weight += w;
        }
        fit.seen = static_cast<double>(seen) / asked;
        const Box before = fit.box;
        for (int k = 0; k < 2; ++k) {
            const auto &front = sides[static_cast<size_t>(k)], &back = sides[static_cast<size_t>(k) + 2];
            double& half = k ? fit.box.half.y : fit.box.half.x;
            if (front && back) {
                half += 0.5 * (front->offset + back->offset);
                fit.box.centre += 0.5 * (front->offset - back->offset) * before.axis(k);
            } else if (front || back) { // one side hidden: keep the size
                fit.box.centre += (front ? front->offset : -back->offset) * before.axis(k);
            }
        }
        if (weight > 0) fit.box.angle += turn / weight;
    }
    return fit;
}

// The angle of a square about the origin, from where its mass lies: fourth circular harmonic, corners weigh
// most.
double squareAngle(const std::vector<glm::dvec2>& points, glm::dvec2 centre) {
    std::complex<double> sum = 0;
    for (const auto& p : points) {
        const std::complex<double> z(p.x - centre.x, p.y - centre.y);
        sum += z * z * z * z;
    }
    return std::arg(sum) / 4 - std::numbers::pi / 4;
}

double withinQuarter(double angle) { // to (-45, 45] degrees
    const double quarter = std::numbers::pi / 2;
    return angle - quarter * std::ceil((angle - quarter / 2) / quarter);
}

// Pixels of the region that have a neighbour outside it, in plan.
std::vector<glm::dvec2> boundary(const Component& component, const PlanView& view, double height) {
    std::vector<glm::dvec2> out;
    size_t above = 0, below = 0;
    const auto& runs = component.runs;
    for (size_t i = 0; i < runs.size(); ++i) {
        const Run& run = runs[i];
        while (above < runs.size() && runs[above].y < run.y - 1) ++above;
        while (below < runs.size() && runs[below].y < run.y + 1) ++below;
        auto covered = [&](size_t from, int y, int x) {
            for (size_t k = from; k < runs.size() && runs[k].y == y; ++k)
                if (runs[k].x0 <= x && x < runs[k].x1) return true;
            return false;
        };
        for (int x = run.x0; x < run.x1; ++x)
            if (x == run.x0 || x == run.x1 - 1 || !covered(above, run.y - 1, x) ||
                !covered(below, run.y + 1, x))
                out.push_back(view.plan(glm::dvec2(x, run.y), height));
    }
    return out;
}

// M. Fischler, R. Bolles, "Random sample consensus" (1981): four edges in turn, the points of each taken
// away. Returns the common direction of the edges, modulo a quarter turn.
double edgeDirection(std::vector<glm::dvec2> points, double reach) {
    uint32_t random = 54321; // the same every time: detection is deterministic
    auto pick = [&] { return (random = random * 1664525u + 1013904223u) >> 8; };
    std::complex<double> sum = 0;
    for (int edge = 0; edge < 4 && points.size() >= 8; ++edge) {
        glm::dvec2 bestFrom{}, bestAlong{1, 0};
        size_t bestCount = 0;
        for (int trial = 0; trial < 60; ++trial) {
            const glm::dvec2 a = points[pick() % points.size()], b = points[pick() % points.size()];
            if (glm::distance(a, b) < 6 * reach) continue;
            const glm::dvec2 along = glm::normalize(b - a), across = turnedLeft(along);
            size_t count = 0;
            for (const auto& p : points) count += std::abs(glm::dot(p - a, across)) < reach;
            if (count > bestCount) bestCount = count, bestFrom = a, bestAlong = along;
        }
        if (bestCount < 8) break;
        std::vector<glm::dvec2> on, off;
        for (const auto& p : points)
            (std::abs(glm::dot(p - bestFrom, turnedLeft(bestAlong))) < reach ? on : off).push_back(p);
        const Pca pca = principalAxes(on);
        const double length = pca.high - pca.low;
        sum += length * length * std::pow(std::complex<double>(pca.axis.x, pca.axis.y), 4);
        points.swap(off);
    }
    return std::arg(sum) / 4;
}

double srgbByte(double linear) {
    const double v = std::clamp(linear, 0.0, 1.0);
    return 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055);
}

glm::dvec3 meanLight(const Box& box, const PlanView& view, double height, double from, double to) {
    glm::dvec3 sum(0);
    double n = 0;
    const double step = 0.5 / view.pixelsPerInch(box.centre, height);
    for (double x = -to; x <= to; x += step)
        for (double y = -to; y <= to; y += step) {
            if (std::max(std::abs(x), std::abs(y)) < from) continue;
            sum += glm::dvec3(view.light(view.pixel(box.at(x, y), height)));
            n += 1;
        }
    return sum / std::max(n, 1.0);
}

// What is seen where a token's rim and ring must be. The paper's Euler number, one for a wall and none for a
// token, but not counted in the region: noise may open the rim, and blur fills a ring of three pixels.
struct TokenRing {
    double rimSeen = 0; // share of the rim that has its paint
    int sides = 0;      // of the ring, that are white

    TokenRing(const Box& box, Paint paint, const ClassImage& image, const PlanView& view,
              const DetectOptions& options) {
        const double half = 0.5 * options.tokenSide, band = options.tokenBand;
        constexpr int kReach = 10, kAlong = 2 * kReach + 1;
        int rimPixels = 0;
        std::array<Colour, 4> rim{}, ring{};
        for (int k = 0; k < 4; ++k)
            for (int i = -kReach; i <= kReach; ++i) {
                auto pixelAt = [&](double r) {
                    const double l = r * i / (kReach + 0.5);
                    return view.pixel(box.centre + r * box.axis(k) + l * box.axis(k + 1),
                                      options.tokenThickness);
                };
                const glm::dvec2 p = pixelAt(half - 0.5 * band);
                rimPixels += image.groupAt(p) == paint;
                rim[static_cast<size_t>(k)].look(view, p);
                ring[static_cast<size_t>(k)].look(view, pixelAt(half - 1.5 * band));
            }
        rimSeen = static_cast<double>(rimPixels) / (4 * kAlong);
        const glm::dvec3 colour = rim[0].chroma + rim[1].chroma + rim[2].chroma + rim[3].chroma;
        // Where a file keeps colour more coarsely than brightness, the ring is the brighter one, and paler by
        // that; light-blue card on a dark table is brighter within its blurred edge, too, but no paler.
        for (size_t k = 0; k < 4; ++k) {
            const double within = glm::dot(ring[k].chroma, colour), without = glm::dot(rim[k].chroma, colour);
            sides += within < 0.55 * std::max(without, 0.0) ||
                     (ring[k].light > 1.3 * rim[k].light &&
                      within * rim[k].light < 0.85 * without * ring[k].light);
        }
    }

private:
    struct Colour { // sums over white's
        glm::dvec3 chroma{};
        double light = 0;
        void look(const PlanView& view, glm::dvec2 p) {
            const glm::dvec3 c(view.light(p) / view.white(p));
            const double mean = (c.r + c.g + c.b) / 3;
            chroma += c - mean, light += mean;
        }
    };
};

// Half widths of a long region in slices along its axis, and what they are of an arrow.
struct ArrowWidths {
    static constexpr size_t kBins = 24;
    std::array<double, kBins> left{}, right{};
    bool forward = true;        // the broader half, the head, is the one along the axis
    double head = 0, shaft = 0; // widths: the widest of the head, the median of the tail's half

    ArrowWidths(const std::vector<glm::dvec2>& points, const Pca& pca) {
        const double length = pca.high - pca.low;
        for (const auto& p : points) {
            const double s = glm::dot(p - pca.mean, pca.axis),
                         t = glm::dot(p - pca.mean, turnedLeft(pca.axis));
            const auto bin = std::min(kBins - 1, static_cast<size_t>(kBins * (s - pca.low) / length));
            left[bin] = std::max(left[bin], t), right[bin] = std::max(right[bin], -t);
        }
        const double low = widest(0), high = widest(kBins / 2);
        forward = high > low;
        head = std::max(low, high);
        std::vector<double> tail;
        for (size_t i = 0; i < kBins / 2; ++i) tail.push_back(width(forward ? i : i + kBins / 2));
        shaft = median(std::move(tail));
    }

private:
    double width(size_t bin) const { return left[bin] + right[bin]; }
    double widest(size_t from) const { // of a half
        double w = 0;
        for (size_t i = from; i < from + kBins / 2; ++i) w = std::max(w, width(i));
        return w;
    }
};

// The middles of an arrow's two sides, as (along, across) its axis, away from its blurred ends.
std::vector<glm::dvec2> middlesOf(const ArrowWidths& widths, const Pca& pca, const PlanView& view,
                                  double height) {
    constexpr size_t kBins = ArrowWidths::kBins;
    const double pixel = 1 / view.pixelsPerInch(pca.mean, height);
    std::vector<glm::dvec2> middles;
    for (size_t i = 1; i + 2 < kBins; ++i) {
        const size_t bin = widths.forward ? i : kBins - 1 - i;
        const double s = pca.low + (static_cast<double>(bin) + 0.5) * (pca.high - pca.low) / kBins;
        std::optional<double> side[2];
        for (int k = 0; k < 2; ++k) {
            EdgeProbe probe;
            probe.outward = (k ? -1.0 : 1.0) * turnedLeft(pca.axis);
            const double half = k ? widths.right[bin] : widths.left[bin];
            probe.at = pca.mean + s * pca.axis + half * probe.outward;
            probe.lateral = pixel * pca.axis;
            probe.height = height;
            probe.inside = std::min(0.16, half + 0.05);
            if (const auto edge = findEdge(view, probe); edge && std::abs(*edge) < 0.15)
                side[k] = half + *edge;
        }
        if (side[0] && side[1]) middles.emplace_back(s, 0.5 * (*side[0] - *side[1]));
    }
    return middles;
}

} // namespace

std::optional<geometry::Skylight> fitSkylight(const Component& component, const PlanView& view,
                                              const DetectOptions& options) {
    const double height = options.markerThickness;
    const auto points = planPoints(component, view, height);
    const double pixel = 1 / view.pixelsPerInch(points.front(), height);
    Box box;
    box.angle = withinQuarter(edgeDirection(boundary(component, view, height), 1.2 * pixel));
    glm::dvec2 low{}, high{};
    for (int k = 0; k < 2; ++k) {
        std::vector<double> s;
        for (const auto& p : points) s.push_back(glm::dot(p, box.axis(k)));
        std::sort(s.begin(), s.end());
        // The extent without the outermost pixels, which noise may have set; a filled rectangle's mass is
        // even.
        const double a = s[s.size() / 50], b = s[s.size() - 1 - s.size() / 50], rest = (b - a) / 48;
        low[k] = a - rest, high[k] = b + rest;
    }
    box.half = 0.5 * (high - low);
    const glm::dvec2 middle = 0.5 * (low + high);
    box.centre = middle.x * box.axis(0) + middle.y * box.axis(1);
    const double filled = component.area * pixel * pixel / (4 * box.half.x * box.half.y);
    if (filled < 0.7 || filled > 1.25 || std::min(box.half.x, box.half.y) < 0.2) return std::nullopt;

    const BoxFit fit = refineBox(box, view, height, 0.16, 0.2);
    geometry::Skylight out;
    out.center = fit.box.centre;
    out.size = 2.0 * fit.box.half;
    out.angleDeg = fit.box.angle * kDegrees;
    out.detection.confidence = std::clamp(0.4 + 0.6 * fit.seen, 0.0, 1.0);
    out.detection.outlinePx = outlineOf(fit.box, height, view);
    return out;
}

std::optional<geometry::Token> fitToken(const Component& component, const ClassImage& image,
                                        const PlanView& view, const DetectOptions& options, TokenLook look) {
    const double height = options.tokenThickness, half = 0.5 * options.tokenSide, band = options.tokenBand;
    const double perInch = view.pixelsPerInch(view.plan(component.centre, height), height);
    const double rim = options.tokenSide * options.tokenSide - std::pow(options.tokenSide - 2 * band, 2);
    if (component.area < 0.35 * rim * perInch * perInch || component.area > 2.6 * rim * perInch * perInch)
        return std::nullopt;
    const auto points = planPoints(component, view, height);
    glm::dvec2 low(1e9), high(-1e9);
    for (const auto& p : points) low = glm::min(low, p), high = glm::max(high, p);
    const glm::dvec2 extent = high - low;
    if (std::min(extent.x, extent.y) < 0.75 * options.tokenSide ||
        std::max(extent.x, extent.y) > 1.6 * options.tokenSide)
        return std::nullopt;
    Box box;
    box.centre = 0.5 * (low + high);
    box.half = glm::dvec2(half);
    box.angle = withinQuarter(squareAngle(points, box.centre));
    const BoxFit fit = refineBox(box, view, height, 0.6 * band, 0.75 * band);

    const TokenRing ring(fit.box, component.group, image, view, options);
    const bool faint = look == TokenLook::faint;
    if (ring.rimSeen < (faint ? 0.75 : 0.55) || ring.sides < (faint ? 4 : 3)) return std::nullopt;

    geometry::Token out;
    out.kind = component.group == Paint::green  ? geometry::TokenKind::floor
               : component.group == Paint::blue ? geometry::TokenKind::wallAll
                                                : geometry::TokenKind::wallSingle;
    out.pos = fit.box.centre;
    out.angleDeg = withinQuarter(fit.box.angle) * kDegrees;
    const double chip = half - 2 * band;
    const glm::dvec3 chipLight = meanLight(fit.box, view, height, 0, 0.62 * chip);
    const glm::dvec3 whiteLight = meanLight(fit.box, view, height, half - 1.62 * band, half - 1.38 * band);
    for (int c = 0; c < 3; ++c)
        out.rgb[static_cast<size_t>(c)] =
            srgbByte(options.chipWhite * chipLight[c] / std::max(whiteLight[c], 1e-9));
    out.detection.confidence = std::clamp(0.5 * ring.rimSeen + 0.5 * fit.seen, 0.0, 1.0);
    out.detection.outlinePx = outlineOf(fit.box, height, view);
    return out;
}

std::optional<geometry::NorthArrow> fitArrow(const Component& component, const PlanView& view,
                                             const DetectOptions& options) {
    const double height = options.markerThickness;
    const auto points = planPoints(component, view, height);
    const Pca pca = principalAxes(points);
    const double length = pca.high - pca.low;
    if (length < 0.6 * options.arrowLength || length > 1.4 * options.arrowLength || pca.major < 2 * pca.minor)
        return std::nullopt;
    const ArrowWidths widths(points, pca);
    // Nothing else is orange: there less of the head's width may be left by blur, which widens the shaft as
    // much.
    constexpr double kBroader = 1.35, kBroaderOrange = 1.15;
    const bool isOrange = component.minorityArea > 0.9 * component.area;
    // The seam of colour along a wall's top or a shadow is thinner than any head.
    if (widths.head < (isOrange ? kBroaderOrange : kBroader) * widths.shaft ||
        widths.head < options.wallThickness)
        return std::nullopt;

    const double pixel = 1 / view.pixelsPerInch(pca.mean, height);
    const std::vector<glm::dvec2> middles = middlesOf(widths, pca, view, height);
    glm::dvec2 origin = pca.mean, along = pca.axis;
    if (const auto line = fitLine(middles, 2 * pixel)) {
        origin += line->offset * turnedLeft(along);
        along = glm::normalize(along + line->slope * turnedLeft(along));
    }
    const glm::dvec2 pointing = (widths.forward ? 1.0 : -1.0) * along;
    EdgeProbe end;
    end.outward = -pointing;
    end.at = origin + (widths.forward ? pca.low : pca.high) * along;
    end.lateral = 0.3 * widths.shaft * turnedLeft(along);
    end.lateralSamples = 5;
    end.height = height;
    if (const auto edge = findEdge(view, end); edge && std::abs(*edge) < 0.15) end.at += *edge * end.outward;

    geometry::NorthArrow out;
    // A blurred tip looks shorter than it is, so the tail's edge and the known length place the middle.
    out.pos = end.at + 0.5 * options.arrowLength * pointing;
    out.dirDeg = std::atan2(pointing.y, pointing.x) * kDegrees;
    if (out.dirDeg < 0) out.dirDeg += 360;
    out.detection.confidence =
        std::clamp(static_cast<double>(middles.size()) / (ArrowWidths::kBins - 3), 0.3, 1.0);
    const double shaft = 0.5 * widths.shaft, neck = 0.7 * options.arrowLength;
    const glm::dvec2 across = turnedLeft(pointing);
    for (const auto& [s, t] : {std::pair{0.0, shaft},
                               {0.0, -shaft},
                               {neck, -shaft},
                               {neck, -0.5 * widths.head},
                               {options.arrowLength, 0.0},
                               {neck, 0.5 * widths.head},
                               {neck, shaft}})
        out.detection.outlinePx.push_back(view.pixel(end.at + s * pointing + t * across, height));
    return out;
}

bool liesWithin(const std::vector<geometry::Token>& tokens, const Component& region, const PlanView& view,
                const DetectOptions& options) {
    const glm::dvec2 p = view.plan(region.centre, options.tokenThickness);
    return std::any_of(tokens.begin(), tokens.end(), [&](const geometry::Token& token) {
        return glm::distance(p, token.pos) < 0.6 * options.tokenSide;
    });
}

} // namespace heliodon::vision
