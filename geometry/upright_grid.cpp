#include "geometry/upright_grid.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace heliodon::geometry {

namespace {

constexpr double kSame = 1e-9;                     // of the domain's extent
constexpr double kMostCosine = 0.809;              // of 36 degrees
constexpr double kSmallest = 0.8, kLargest = 1.25; // mean area over that of regular triangles

// Indices of the boundary's points along the four sides, each from one corner to the next, both included.
using Sides = std::array<std::vector<uint32_t>, 4>; // lower, right, upper, left

std::optional<Sides> sidesOf(const PlanarDomain& domain, glm::dvec2 low, glm::dvec2 high, double same) {
    const std::vector<glm::dvec2>& p = domain.boundary;
    const auto n = static_cast<uint32_t>(p.size());
    const auto isAt = [&](uint32_t k, double x, double y) {
        return std::abs(p[k].x - x) <= same && std::abs(p[k].y - y) <= same;
    };
    const auto onSide = [&](uint32_t k, size_t side) {
        const double off[] = {p[k].y - low.y, p[k].x - high.x, p[k].y - high.y, p[k].x - low.x};
        return std::abs(off[side]) <= same;
    };
    uint32_t at = 0;
    while (at < n && !isAt(at, low.x, low.y)) ++at;
    if (at == n) return std::nullopt;
    const glm::dvec2 ends[] = {{high.x, low.y}, high, {low.x, high.y}, low};
    Sides sides;
    for (size_t side = 0; side < 4; ++side) {
        sides[side].push_back(at);
        do {
            at = (at + 1) % n;
            if (!onSide(at, side) || sides[side].size() > n) return std::nullopt;
            sides[side].push_back(at);
        } while (!isAt(at, ends[side].x, ends[side].y));
    }
    return sides;
}

double cosineAt(glm::dvec2 corner, glm::dvec2 a, glm::dvec2 b) {
    return glm::dot(glm::normalize(a - corner), glm::normalize(b - corner));
}

// A share of the way up a side, counted in its points.
double heightAt(const std::vector<glm::dvec2>& points, const std::vector<uint32_t>& side, double share) {
    const double at = share * static_cast<double>(side.size() - 1);
    const auto k = std::min(static_cast<size_t>(at), side.size() - 2);
    return glm::mix(points[side[k]].y, points[side[k + 1]].y, at - static_cast<double>(k));
}

// Triangles between two columns of points, each from foot to head: on from the lower of both next points, by
// turns where they are level.
void fillStrip(PlanarMesh& mesh, const std::vector<uint32_t>& left, const std::vector<uint32_t>& right,
               bool turn) {
    const auto y = [&](uint32_t point) { return mesh.points[point].y; };
    for (size_t l = 0, r = 0; l + 1 < left.size() || r + 1 < right.size(); turn = !turn) {
        bool onLeft = r + 1 == right.size();
        if (!onLeft && l + 1 < left.size()) {
            const double slack = 0.25 * (y(left[l + 1]) - y(left[l])),
                         ahead = y(left[l + 1]) - y(right[r + 1]);
            onLeft = l == r && std::abs(ahead) < slack ? turn : ahead < 0;
        }
        if (onLeft) {
            mesh.triangles.push_back({left[l], right[r], left[l + 1]});
            ++l;
        } else {
            mesh.triangles.push_back({left[l], right[r], right[r + 1]});
            ++r;
        }
    }
}

} // namespace

std::optional<PlanarMesh> meshUprightGrid(const PlanarDomain& domain) {
    if (domain.loopStart.size() != 2 || domain.boundary.size() < 4) return std::nullopt;
    const std::vector<glm::dvec2>& p = domain.boundary;
    glm::dvec2 low = p[0], high = p[0];
    for (const glm::dvec2 q : p) {
        low = glm::min(low, q);
        high = glm::max(high, q);
    }
    const double same = kSame * std::max(high.x - low.x, high.y - low.y);
    const std::optional<Sides> sides = sidesOf(domain, low, high, same);
    if (!sides) return std::nullopt;
    const auto& [lower, right, upper, left] = *sides;
    const size_t columns = lower.size() - 1;
    if (upper.size() != lower.size()) return std::nullopt;
    for (size_t c = 0; c < columns; ++c)
        if (std::abs(p[lower[c]].x - p[upper[columns - c]].x) > same) return std::nullopt;

    PlanarMesh mesh;
    mesh.points = p;
    std::vector<uint32_t> before(left.rbegin(), left.rend()), first = before;
    for (size_t c = 1; c <= columns; ++c) {
        const double share = (p[lower[c]].x - low.x) / (high.x - low.x);
        std::vector<uint32_t> column = right;
        if (c < columns) {
            const auto steps = static_cast<double>(share < 0.5 ? first.size() - 1 : right.size() - 1);
            column = {lower[c]};
            for (double r = 1; r < steps; ++r) {
                const double y =
                    glm::mix(heightAt(p, first, r / steps), heightAt(p, right, r / steps), share);
                column.push_back(static_cast<uint32_t>(mesh.points.size()));
                mesh.points.push_back({p[lower[c]].x, y});
            }
            column.push_back(upper[columns - c]);
        }
        fillStrip(mesh, before, column, c % 2);
        before = std::move(column);
    }
    double worst = -1;
    for (const auto& t : mesh.triangles) {
        const glm::dvec2 a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
        worst = std::max({worst, cosineAt(a, b, c), cosineAt(b, c, a), cosineAt(c, a, b)});
    }
    const double area = (high.x - low.x) * (high.y - low.y) / static_cast<double>(mesh.triangles.size()),
                 regular = std::sqrt(3.0) / 4 * domain.size.edge() * domain.size.edge();
    if (worst > kMostCosine || area < kSmallest * regular || area > kLargest * regular) return std::nullopt;
    return mesh;
}

} // namespace heliodon::geometry
