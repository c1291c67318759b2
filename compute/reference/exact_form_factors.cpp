// J. H. Lambert, Photometria, 1760 (point to polygon); E. M. Sparrow, "A new and simpler formulation for
// radiative angle factors", J. Heat Transfer 1963 (contour integral). Visibility: each blocker's cone of
// shadow is cut from the polygon, after T. Nishita, E. Nakamae, "Continuous tone representation of
// three-dimensional objects taking account of shadows and interreflection", SIGGRAPH 1985.
#include "compute/reference/exact_form_factors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <queue>

#include <glm/geometric.hpp>

namespace heliodon::compute::reference {

using glm::cross;
using glm::dot;
using glm::dvec3;
using glm::length;
using std::numbers::pi;

namespace {

struct Rule {
    std::vector<double> x, w; // on [0, 1]
};

// Gauss-Legendre by Newton's iteration on the Legendre polynomial.
Rule gaussRule(int n) {
    Rule rule;
    for (int k = 0; k < n; ++k) {
        double x = std::cos(pi * (k + 0.75) / (n + 0.5)), derivative = 1;
        for (int iteration = 0; iteration < 100; ++iteration) {
            double p0 = 1, p1 = x;
            for (int m = 2; m <= n; ++m) {
                const double p2 = ((2 * m - 1) * x * p1 - (m - 1) * p0) / m;
                p0 = p1;
                p1 = p2;
            }
            derivative = n * (x * p1 - p0) / (x * x - 1);
            const double step = p1 / derivative;
            x -= step;
            if (std::abs(step) < 1e-16) break;
        }
        rule.x.push_back(0.5 * (1 - x));
        rule.w.push_back(1 / ((1 - x * x) * derivative * derivative));
    }
    return rule;
}

dvec3 areaVector(std::span<const dvec3> polygon) {
    dvec3 sum{0};
    for (size_t k = 1; k + 1 < polygon.size(); ++k)
        sum += cross(polygon[k] - polygon[0], polygon[k + 1] - polygon[0]);
    return 0.5 * sum;
}

double diameter(std::span<const dvec3> polygon) {
    double result = 0;
    for (const dvec3& a : polygon)
        for (const dvec3& b : polygon) result = std::max(result, length(a - b));
    return result;
}

dvec3 meanCorner(std::span<const dvec3> polygon) {
    dvec3 sum{0};
    for (const dvec3& p : polygon) sum += p;
    return sum / static_cast<double>(polygon.size());
}

// int_0^1 ln|a + t (b - a)| dt |b - a| for positions relative to the outer point.
double logAlongEdge(const dvec3& a, const dvec3& b) {
    const dvec3 edge = b - a;
    const double edgeLength = length(edge);
    const dvec3 direction = edge / edgeLength;
    const double t0 = dot(a, direction), t1 = dot(b, direction);
    const double h = length(cross(a, direction));
    const auto antiderivative = [h](double t) {
        const double r2 = h * h + t * t;
        return (r2 > 0 ? 0.5 * t * std::log(r2) : 0.0) - t;
    };
    const double angle = h > 0 ? std::atan2(h * (t1 - t0), h * h + t0 * t1) : 0.0;
    return antiderivative(t1) - antiderivative(t0) + h * angle;
}

// Integral along an edge of the outer contour; halves until two rules agree. The integrand is smooth but for
// t ln t where the outer point passes a corner or an edge, which halving resolves geometrically. `tolerance`
// is per part: halving it too would chase rounding errors for ever.
template<class Function>
double integrate(const Function& f, double a, double b, double tolerance, int depth) {
    static const Rule low = gaussRule(8), high = gaussRule(12);
    const auto apply = [&](const Rule& rule) {
        double sum = 0;
        for (size_t k = 0; k < rule.x.size(); ++k) sum += rule.w[k] * f(a + (b - a) * rule.x[k]);
        return sum * (b - a);
    };
    const double fine = apply(high);
    if (depth == 0 || std::abs(fine - apply(low)) <= tolerance) return fine;
    const double middle = 0.5 * (a + b);
    return integrate(f, a, middle, tolerance, depth - 1) + integrate(f, middle, b, tolerance, depth - 1);
}

double contourExchange(const Polygon& from, const Polygon& to) {
    // Lengths in units of the distance, so that the logarithms are small where they must cancel.
    const double scale = std::max(length(meanCorner(from) - meanCorner(to)), 1e-3 * diameter(from));
    double sum = 0, perimeter = 0;
    for (size_t q = 0; q < to.size(); ++q) perimeter += length(to[(q + 1) % to.size()] - to[q]) / scale;
    for (size_t p = 0; p < from.size(); ++p) {
        const dvec3 a = from[p] / scale, edge = from[(p + 1) % from.size()] / scale - a;
        const auto inner = [&](double s) {
            const dvec3 x = a + s * edge;
            double value = 0;
            for (size_t q = 0; q < to.size(); ++q) {
                const dvec3 b0 = to[q] / scale - x, b1 = to[(q + 1) % to.size()] / scale - x;
                const double edgeLength = length(b1 - b0);
                if (edgeLength > 0) value += dot(edge, b1 - b0) / edgeLength * logAlongEdge(b0, b1);
            }
            return value;
        };
        sum += integrate(inner, 0, 1, 2e-16 * length(edge) * perimeter, 45);
    }
    return sum / (2 * pi) * scale * scale;
}

struct Cell {
    std::array<dvec3, 3> corner;
    double value = 0, error = 0;
    bool operator<(const Cell& other) const { return error < other.error; }
};

// Gauss rule on a triangle folded out of a square (A. H. Stroud's conical product).
template<class Function>
double overTriangle(const Function& f, const std::array<dvec3, 3>& c, const Rule& rule) {
    double sum = 0;
    for (size_t i = 0; i < rule.x.size(); ++i)
        for (size_t j = 0; j < rule.x.size(); ++j) {
            const double u = rule.x[i], v = rule.x[j] * u;
            sum += rule.w[i] * rule.w[j] * u * f(c[0] + u * (c[1] - c[0]) + v * (c[2] - c[1]));
        }
    return sum * length(cross(c[1] - c[0], c[2] - c[0]));
}

// Refines the worst cell until the sum of estimates is below `tolerance`.
template<class Function>
Estimate overPolygon(const Function& f, const Polygon& polygon, const Rule& low, const Rule& high,
                     double tolerance, size_t maxCells) {
    std::priority_queue<Cell> cells;
    double error = 0; // a running sum: digits that it loses only cost a cell more or less
    const auto push = [&](const std::array<dvec3, 3>& corner) {
        Cell cell{corner, overTriangle(f, corner, high), 0};
        cell.error = std::abs(cell.value - overTriangle(f, corner, low));
        error += cell.error;
        cells.push(cell);
    };
    for (size_t k = 1; k + 1 < polygon.size(); ++k) push({polygon[0], polygon[k], polygon[k + 1]});
    while (error > tolerance && cells.size() < maxCells && cells.top().error > 0) {
        const Cell worst = cells.top();
        cells.pop();
        error -= worst.error;
        const auto& c = worst.corner;
        const dvec3 m01 = 0.5 * (c[0] + c[1]), m12 = 0.5 * (c[1] + c[2]), m20 = 0.5 * (c[2] + c[0]);
        push({c[0], m01, m20});
        push({m01, c[1], m12});
        push({m20, m12, c[2]});
        push({m12, m20, m01});
    }
    Estimate result; // summed afresh, for the same reason
    while (!cells.empty()) {
        result.value += cells.top().value;
        result.error += cells.top().error;
        cells.pop();
    }
    return result;
}

double areaExchange(const Polygon& from, const Polygon& to) {
    static const Rule low = gaussRule(6), high = gaussRule(9);
    const dvec3 normal = glm::normalize(areaVector(from));
    const auto f = [&](const dvec3& x) { return pointToPolygon(x, normal, to); };
    return overPolygon(f, from, low, high, 1e-15 * polygonArea(from), 4000).value;
}

// Convex polygons one behind the other: cutting makes them by the thousand, and memory for each would cost
// more than the cutting.
struct Pieces {
    std::vector<dvec3> corners;
    std::vector<size_t> ends;

    void add(std::span<const dvec3> piece) {
        if (piece.empty()) return;
        corners.insert(corners.end(), piece.begin(), piece.end());
        ends.push_back(corners.size());
    }
    std::span<const dvec3> operator[](size_t k) const {
        const size_t first = k == 0 ? 0 : ends[k - 1];
        return std::span(corners).subspan(first, ends[k] - first);
    }
};

// Height of a point over a plane, for the corners of one polygon: those within rounding of the plane lie on
// it, since shared edges must not leave slivers. A plane without normal leaves nothing above or below.
class HeightOver {
public:
    HeightOver(std::span<const dvec3> polygon, const dvec3& onPlane, const dvec3& normal)
        : onPlane_(onPlane), normal_(normal), norm_(length(normal)) {
        double square = 0;
        for (const dvec3& p : polygon) square = std::max(square, dot(p - onPlane, p - onPlane));
        rounding_ = 4e-16 * std::sqrt(square);
    }
    double operator()(const dvec3& p) const {
        const double height = norm_ == 0 ? 0 : dot(p - onPlane_, normal_) / norm_;
        return std::abs(height) <= rounding_ ? 0 : height;
    }

private:
    dvec3 onPlane_, normal_;
    double norm_ = 0, rounding_ = 0;
};

// `clipped` into a vector that is there already, not the one that holds the polygon.
void clip(std::span<const dvec3> polygon, const dvec3& onPlane, const dvec3& normal, Polygon& result) {
    result.clear();
    if (!reachesAbove(polygon, onPlane, normal)) return;
    const HeightOver heightOf(polygon, onPlane, normal);
    double height = heightOf(polygon[0]);
    for (size_t k = 0; k < polygon.size(); ++k) {
        const dvec3 &here = polygon[k], &next = polygon[(k + 1) % polygon.size()];
        const double heightOfNext = heightOf(next);
        if (height >= 0) result.push_back(here);
        if ((height > 0 && heightOfNext < 0) || (height < 0 && heightOfNext > 0))
            result.push_back(here + height / (height - heightOfNext) * (next - here));
        height = heightOfNext;
    }
}

// Cuts the cone from `point` over `blocker` off convex pieces. What the cone misses stays whole.
void subtractShadow(const dvec3& point, const Polygon& blocker, Pieces& pieces) {
    dvec3 plane = areaVector(blocker);
    const double size = length(plane);
    if (size == 0) return;
    double side = dot(blocker[0] - point, plane) / size;
    if (std::abs(side) < 1e-14 * std::max(1.0, length(blocker[0] - point))) return;
    if (side < 0) plane = -plane;
    std::vector<dvec3> inward; // normals of the cone's sides
    for (size_t k = 0; k < blocker.size(); ++k) {
        const dvec3 normal = cross(blocker[k] - point, blocker[(k + 1) % blocker.size()] - point);
        inward.push_back(side < 0 ? -normal : normal);
    }
    Pieces kept;
    Polygon rest, cut;
    for (size_t p = 0; p < pieces.ends.size(); ++p) {
        const std::span<const dvec3> piece = pieces[p];
        clip(piece, blocker[0], plane, rest);
        const auto misses = [&](const dvec3& normal) { return !reachesAbove(rest, point, normal); };
        if (rest.empty() || std::ranges::any_of(inward, misses)) {
            kept.add(piece);
            continue;
        }
        clip(piece, blocker[0], -plane, cut); // what lies before the blocker
        kept.add(cut);
        for (size_t k = 0; k < inward.size() && !rest.empty(); ++k) {
            clip(rest, point, -inward[k], cut); // what lies beside it
            kept.add(cut);
            clip(rest, point, inward[k], cut);
            std::swap(rest, cut);
        }
    }
    pieces = std::move(kept);
}

} // namespace

double polygonArea(std::span<const dvec3> polygon) {
    return length(areaVector(polygon));
}

bool reachesAbove(std::span<const dvec3> polygon, const dvec3& onPlane, const dvec3& normal) {
    const HeightOver heightOf(polygon, onPlane, normal);
    return polygon.size() >= 3 &&
           std::ranges::any_of(polygon, [&](const dvec3& p) { return heightOf(p) > 0; });
}

Polygon clipped(std::span<const dvec3> polygon, const dvec3& onPlane, const dvec3& normal) {
    Polygon result;
    clip(polygon, onPlane, normal, result);
    return result;
}

double pointToPolygon(const dvec3& point, const dvec3& normal, std::span<const dvec3> polygon) {
    if (dot(point - polygon[0], areaVector(polygon)) <= 0) return 0;
    const Polygon above = clipped(polygon, point, normal);
    double sum = 0;
    for (size_t k = 0; k < above.size(); ++k) {
        const dvec3 a = above[k] - point, b = above[(k + 1) % above.size()] - point;
        const dvec3 c = cross(a, b);
        const double sine = length(c);
        // Clockwise as seen from the point's side: the polygon is counter-clockwise seen from its own front.
        if (sine > 0) sum -= std::atan2(sine, dot(a, b)) / sine * dot(c, normal);
    }
    return std::max(0.0, sum / (2 * pi));
}

double visiblePointToPolygon(const dvec3& point, const dvec3& normal, std::span<const dvec3> polygon,
                             std::span<const Polygon> blockers) {
    Pieces pieces;
    pieces.add(polygon);
    for (const Polygon& blocker : blockers) {
        subtractShadow(point, blocker, pieces);
        if (pieces.ends.empty()) return 0;
    }
    double sum = 0;
    for (size_t k = 0; k < pieces.ends.size(); ++k) sum += pointToPolygon(point, normal, pieces[k]);
    return sum;
}

double exchangeUnoccluded(const Polygon& from, const Polygon& to) {
    const Polygon a = clipped(from, to[0], areaVector(to)), b = clipped(to, from[0], areaVector(from));
    if (a.empty() || b.empty()) return 0;
    const bool aIsSmaller = polygonArea(a) <= polygonArea(b);
    const Polygon &small = aIsSmaller ? a : b, &large = aIsSmaller ? b : a;
    // A lower bound of the gap by the planes and by the corner nearest to the other's enclosing ball.
    const dvec3 normal = glm::normalize(areaVector(large));
    double gap = dot(small[0] - large[0], normal);
    for (const dvec3& p : small) gap = std::min(gap, dot(p - large[0], normal));
    gap = std::max(gap, length(meanCorner(a) - meanCorner(b)) - diameter(a) - diameter(b));
    return gap > 0.2 * diameter(small) ? areaExchange(small, large) : std::max(0.0, contourExchange(a, b));
}

namespace {

// How near the blockers come to a polygon's plane.
double clearance(const Polygon& polygon, std::span<const Polygon> blockers) {
    const dvec3 normal = glm::normalize(areaVector(polygon));
    double nearest = INFINITY;
    for (const Polygon& blocker : blockers)
        for (const dvec3& p : blocker) nearest = std::min(nearest, std::abs(dot(p - polygon[0], normal)));
    return nearest;
}

// Whether all points of a rule see nothing or all see everything: then a sliver of light or shadow may lie
// between them, which from the other polygon is plain to see.
bool pointsAgree(const Polygon& polygon, const Polygon& to, std::span<const Polygon> blockers) {
    static const Rule rule = gaussRule(5);
    const dvec3 normal = glm::normalize(areaVector(polygon));
    bool nothing = true, everything = true;
    const auto look = [&](const dvec3& x) {
        const double open = pointToPolygon(x, normal, to);
        const double visible = visiblePointToPolygon(x, normal, to, blockers);
        nothing = nothing && visible <= 1e-12 * open;
        everything = everything && visible >= (1 - 1e-12) * open;
        return 0.0;
    };
    for (size_t k = 1; k + 1 < polygon.size() && (nothing || everything); ++k)
        overTriangle(look, {polygon[0], polygon[k], polygon[k + 1]}, rule);
    return nothing || everything;
}

} // namespace

Estimate exchangeOccluded(const Polygon& from, const Polygon& to, std::span<const Polygon> blockers,
                          double tolerance, size_t maxCells) {
    static const Rule low = gaussRule(3), high = gaussRule(5);
    Polygon a = clipped(from, to[0], areaVector(to)), b = clipped(to, from[0], areaVector(from));
    if (a.empty() || b.empty()) return {};
    // Points are spread over the side from which shadows are blurred, not cut sharply by a near blocker.
    if (clearance(b, blockers) > clearance(a, blockers)) std::swap(a, b);
    if (pointsAgree(a, b, blockers)) std::swap(a, b);
    const dvec3 normal = glm::normalize(areaVector(a));
    const auto f = [&](const dvec3& x) { return visiblePointToPolygon(x, normal, b, blockers); };
    return overPolygon(f, a, low, high, tolerance * polygonArea(from), maxCells);
}

Estimate exchangeIn(const geometry::PatchMesh& mesh, size_t i, size_t j, double tolerance, size_t maxCells) {
    if (i == j || mesh.room[i] != mesh.room[j]) return {};
    const Polygon from = geometry::patchCorners(mesh, i), to = geometry::patchCorners(mesh, j);
    std::vector<Polygon> blockers;
    for (size_t k = 0; k < mesh.patchCount(); ++k) {
        if (k == i || k == j || mesh.room[k] != mesh.room[i]) continue;
        // A blocker matters only in front of both, and when its plane has them on either side.
        Polygon between = clipped(geometry::patchCorners(mesh, k), from[0], areaVector(from));
        if (!between.empty()) between = clipped(between, to[0], areaVector(to));
        if (between.empty()) continue;
        const dvec3 plane = areaVector(between);
        const auto front = [&](const Polygon& p) { return reachesAbove(p, between[0], plane); };
        const auto back = [&](const Polygon& p) { return reachesAbove(p, between[0], -plane); };
        if ((front(from) && back(to)) || (back(from) && front(to))) blockers.push_back(std::move(between));
    }
    if (blockers.empty()) return {exchangeUnoccluded(from, to), 0};
    return exchangeOccluded(from, to, blockers, tolerance, maxCells);
}

std::vector<double> exactFormFactors(const geometry::PatchMesh& mesh, double tolerance, size_t maxCells) {
    const size_t n = mesh.patchCount();
    std::vector<double> result(n * n, 0.0);
    for (size_t i = 0; i < n; ++i)
        for (size_t j = i + 1; j < n; ++j) {
            const double exchange = exchangeIn(mesh, i, j, tolerance, maxCells).value;
            result[i * n + j] = exchange / patchArea(mesh, i);
            result[j * n + i] = exchange / patchArea(mesh, j);
        }
    return result;
}

} // namespace heliodon::compute::reference
