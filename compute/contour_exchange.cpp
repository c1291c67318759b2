// E. M. Sparrow, "A new and simpler formulation for radiative angle factors", J. Heat Transfer 1963: A F is
// the integral of ln r over both contours, divided by 2 pi. Along one edge it has a closed form; along the
// other by H. Takahasi, M. Mori, "Double exponential formulas for numerical integration", 1974, whose points
// crowd at both ends: the edge is divided where it passes the other, so that what is not smooth lies there.
#include "compute/contour_exchange.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>

#include "geometry/clip_polygon.h"
#include "geometry/outline_area.h"

namespace heliodon::compute {

namespace {

using glm::dot;
using glm::dvec3;
using Polygon = std::vector<dvec3>;

constexpr double kStep = 1.0 / 16;        // of the double exponential rule: 1e-9 of needles of 1 : 10000
constexpr double kLeastWeight = 1e-19;    // points beyond add nothing
constexpr double kRounding = 4e-16;       // of distances: corners so near to a plane lie in it,
constexpr double kOfPlaces = 1e-14;       // and of coordinates, which round planes through a few of them
constexpr double kParallelSquare = 1e-12; // of the sine: lines that pass each other nowhere
constexpr double kRightAngle = 1e-15;     // of the cosine: edges that exchange nothing

struct Node {
    double place, weight; // on [0, 1], from either end
};

std::vector<Node> doubleExponential() {
    std::vector<Node> nodes;
    for (int k = 0;; ++k) {
        const double t = k * kStep, u = 0.5 * std::numbers::pi * std::sinh(t), c = std::cosh(u),
                     weight = 0.25 * std::numbers::pi * kStep * std::cosh(t) / (c * c);
        if (weight < kLeastWeight) return nodes;
        nodes.push_back({0.5 * std::exp(-u) / c, k == 0 ? 0.5 * weight : weight});
    }
}

struct Edge {
    dvec3 from, along;
    double length;
};

std::vector<Edge> edgesOf(const Polygon& polygon, double unit) {
    std::vector<Edge> edges;
    for (size_t k = 0; k < polygon.size(); ++k) {
        const dvec3 edge = polygon[(k + 1) % polygon.size()] - polygon[k];
        const double length = glm::length(edge);
        if (length > 0) edges.push_back({polygon[k] / unit, edge / length, length / unit});
    }
    return edges;
}

// Of ln |x - p| over p along the edge.
double logAlong(const Edge& edge, const dvec3& x) {
    const dvec3 d = edge.from - x;
    const double s = dot(d, edge.along), t = s + edge.length;
    const dvec3 across = d - s * edge.along;
    const double h2 = dot(across, across), h = std::sqrt(h2);
    const auto part = [h2](double at) { return at != 0 || h2 > 0 ? 0.5 * at * std::log(at * at + h2) : 0; };
    return part(t) - part(s) - edge.length + (h > 0 ? h * std::atan2(h * edge.length, h2 + s * t) : 0);
}

double overEdges(const Edge& a, const Edge& b) {
    static const std::vector<Node> nodes = doubleExponential();
    const double cosine = dot(a.along, b.along), sine2 = 1 - cosine * cosine;
    if (std::abs(cosine) < kRightAngle) return 0;
    const dvec3 d = a.from - b.from;
    const double onA = dot(d, a.along), onB = dot(d, b.along);
    // Beside the other's ends, and where both lines come nearest.
    std::array<double, 5> ends{0, -onA, cosine * b.length - onA,
                               sine2 > kParallelSquare ? (cosine * onB - onA) / sine2 : 0, a.length};
    for (double& end : ends) end = std::clamp(end, 0.0, a.length);
    std::ranges::sort(ends);
    double sum = 0;
    for (size_t k = 0; k + 1 < ends.size(); ++k) {
        const double length = ends[k + 1] - ends[k];
        if (length <= 0) continue;
        for (const Node& node : nodes)
            sum += length * node.weight *
                   (logAlong(b, a.from + (ends[k] + length * node.place) * a.along) +
                    logAlong(b, a.from + (ends[k + 1] - length * node.place) * a.along));
    }
    return cosine * sum;
}

// What lies before the other's plane; nothing of what lies in it, as both sides of a face do, and faces of
// furniture pushed together.
Polygon before(std::span<const dvec3> other, std::span<const dvec3> polygon) {
    const dvec3 area = geometry::areaVector(other), normal = area / glm::length(area);
    double farthest = 0, places = 0;
    for (const dvec3& p : polygon) {
        farthest = std::max(farthest, glm::distance(p, other[0]));
        for (int axis = 0; axis < 3; ++axis) places = std::max(places, std::abs(p[axis]));
    }
    const double rounding = std::max(kRounding * farthest, kOfPlaces * places);
    const auto heightOf = [&](const dvec3& p) {
        const double height = dot(p - other[0], normal);
        return std::abs(height) <= rounding ? 0 : height;
    };
    Polygon result;
    if (std::ranges::any_of(polygon, [&](const dvec3& p) { return heightOf(p) > 0; }))
        geometry::clip<dvec3>(polygon, heightOf, result);
    return result;
}

double longestEdge(const Polygon& polygon) {
    double longest = 0;
    for (const Edge& edge : edgesOf(polygon, 1)) longest = std::max(longest, edge.length);
    return longest;
}

} // namespace

double contourExchange(std::span<const dvec3> from, std::span<const dvec3> to) {
    const Polygon a = before(to, from), b = before(from, to);
    // Logarithms are small where they must cancel.
    const double unit = std::max(longestEdge(a), longestEdge(b));
    double sum = 0;
    for (const Edge& edge : edgesOf(a, unit))
        for (const Edge& other : edgesOf(b, unit)) sum += overEdges(edge, other);
    return std::max(0.0, sum * unit * unit / (2 * std::numbers::pi));
}

} // namespace heliodon::compute
