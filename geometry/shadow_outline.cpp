#include "geometry/shadow_outline.h"

#include <algorithm>
#include <set>

#include <glm/geometric.hpp>

#include "geometry/disjoint_sets.h"
#include "geometry/perpendicular.h"

namespace heliodon::geometry {

namespace {

// Andrew's monotone chain.
std::vector<glm::dvec2> convexHull(std::vector<glm::dvec2> points) {
    std::ranges::sort(points,
                      [](glm::dvec2 p, glm::dvec2 q) { return p.x < q.x || (p.x == q.x && p.y < q.y); });
    std::vector<glm::dvec2> hull(2 * points.size());
    size_t n = 0;
    const auto grow = [&](glm::dvec2 p, size_t base) {
        while (n >= base + 2 && cross(hull[n - 1] - hull[n - 2], p - hull[n - 1]) <= 1e-15) --n;
        hull[n++] = p;
    };
    for (const glm::dvec2 p : points) grow(p, 0);
    const size_t lower = n - 1;
    for (size_t i = points.size() - 1; i-- > 0;) grow(points[i], lower);
    hull.resize(n > 0 ? n - 1 : 0);
    return hull;
}

} // namespace

glm::dvec2 PlaneFrame::flat(glm::dvec3 p) const {
    return {glm::dot(p - origin, u), glm::dot(p - origin, v)};
}

bool ConvexOutline::contains(glm::dvec2 p) const {
    if (points.size() < 3 || p.x <= low.x || p.y <= low.y || p.x >= high.x || p.y >= high.y) return false;
    for (size_t i = 0; i < points.size(); ++i)
        if (cross(points[(i + 1) % points.size()] - points[i], p - points[i]) <= 0) return false;
    return true;
}

std::vector<ConvexSolid> convexSolids(const Occluders& occluders) {
    const size_t count = occluders.vertices.size();
    DisjointSets joined(count);
    for (size_t i = 0; i + 2 < occluders.triangles.size(); i += 3)
        for (size_t k = 1; k < 3; ++k) joined.join(occluders.triangles[i + k], occluders.triangles[i]);
    std::vector<ConvexSolid> solids;
    std::vector<uint32_t> solidOf(count, 0xffffffffu), place(count);
    for (uint32_t v = 0; v < count; ++v) {
        uint32_t& solid = solidOf[joined.root(v)];
        if (solid == 0xffffffffu) {
            solid = static_cast<uint32_t>(solids.size());
            solids.emplace_back();
        }
        place[v] = static_cast<uint32_t>(solids[solid].corners.size());
        solids[solid].corners.push_back(occluders.vertices[v]);
    }
    std::set<std::pair<uint32_t, uint32_t>> seen;
    for (size_t i = 0; i < occluders.triangles.size(); ++i) {
        const uint32_t a = occluders.triangles[i], b = occluders.triangles[i % 3 == 2 ? i - 2 : i + 1];
        if (seen.insert(std::minmax(a, b)).second)
            solids[solidOf[joined.root(a)]].edges.emplace_back(place[a], place[b]);
    }
    return solids;
}

ConvexOutline shadowOnPlane(const ConvexSolid& solid, glm::dvec3 light, const PlaneFrame& plane, double skin,
                            const FlatBox& within) {
    ConvexOutline outline;
    const double lightHeight = glm::dot(light - plane.origin, plane.normal);
    if (lightHeight <= 0) return outline;
    const double top = 0.999 * lightHeight; // what is level with the light throws its shadow to infinity
    const auto heightOf = [&](const glm::dvec3& p) { return glm::dot(p - plane.origin, plane.normal); };
    const auto shadowOf = [&](const glm::dvec3& p, double h) {
        return plane.flat(light + (p - light) * (lightHeight / (lightHeight - h)));
    };
    double lowest = 1e300, highest = -1e300;
    glm::dvec2 low(1e300), high(-1e300);
    for (const glm::dvec3& p : solid.corners) {
        const double h = heightOf(p);
        lowest = std::min(lowest, h);
        highest = std::max(highest, h);
        if (h > top) continue;
        const glm::dvec2 s = shadowOf(p, h);
        low = glm::min(low, s);
        high = glm::max(high, s);
    }
    if (highest <= skin || lowest >= top) return outline;
    // Most shadows fall elsewhere.
    const auto misses = [&](int c) { return low[c] >= within.high[c] || high[c] <= within.low[c]; };
    if (highest <= top && (misses(0) || misses(1))) return outline;

    std::vector<glm::dvec2> points;
    points.reserve(solid.corners.size() + 2 * solid.edges.size());
    for (const glm::dvec3& p : solid.corners)
        if (const double h = heightOf(p); h >= 0 && h <= top) points.push_back(shadowOf(p, h));
    if (lowest < 0 || highest > top)
        for (const auto& [a, b] : solid.edges) {
            const glm::dvec3 p = solid.corners[a], q = solid.corners[b];
            const double from = heightOf(p), to = heightOf(q);
            for (const double level : {0.0, top})
                if ((from < level) != (to < level))
                    points.push_back(shadowOf(p + (level - from) / (to - from) * (q - p), level));
        }
    if (points.size() < 3) return outline;
    outline.points = convexHull(std::move(points));
    if (outline.points.size() < 3) return {};
    outline.low = outline.high = outline.points[0];
    for (const glm::dvec2 p : outline.points) {
        outline.low = glm::min(outline.low, p);
        outline.high = glm::max(outline.high, p);
    }
    for (int c = 0; c < 2; ++c)
        if (outline.low[c] >= within.high[c] || outline.high[c] <= within.low[c]) return {};
    return outline;
}

std::array<glm::dvec3, 4> pictureBorders(const OpticalDevice& device) {
    const double right = device.width - 0.5, bottom = device.height - 0.5;
    const std::array<glm::dvec2, 4> corners{{{-0.5, -0.5}, {right, -0.5}, {right, bottom}, {-0.5, bottom}}};
    const glm::dvec3 middle = device.rayFromPixel({device.width / 2.0, device.height / 2.0}).direction;
    std::array<glm::dvec3, 4> borders{};
    for (size_t side = 0; side < 4; ++side) {
        const glm::dvec2 from = corners[side], to = corners[(side + 1) % 4];
        const glm::dvec3 a = device.rayFromPixel(from).direction, b = device.rayFromPixel(to).direction;
        glm::dvec3 normal = glm::normalize(glm::cross(a, b));
        const double sign = glm::dot(normal, middle) < 0 ? -1 : 1;
        normal *= sign;
        // Where the lens bends the side inwards, the plane goes through the innermost of its rays.
        glm::dvec3 innermost = a;
        for (int k = 1; k < 16; ++k) {
            const glm::dvec3 ray = device.rayFromPixel(from + (to - from) * (k / 16.0)).direction;
            if (glm::dot(ray, normal) > glm::dot(innermost, normal)) innermost = ray;
        }
        if (glm::dot(innermost, normal) > 1e-9) normal = sign * glm::normalize(glm::cross(innermost, b - a));
        borders[side] = normal;
    }
    return borders;
}

} // namespace heliodon::geometry
