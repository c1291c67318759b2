#include "geometry/shadow_outline.h"

#include <algorithm>
#include <tuple>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/convex_hull.h"
#include "geometry/disjoint_sets.h"
#include "geometry/perpendicular.h"

namespace heliodon::geometry {

namespace {

constexpr double kSameInImage = 1e-10; // at distance one: corners of an outline nearer than this are one
constexpr double kTouch = 1e-9;        // metres: a solid so little below a plane stands on it

std::span<const glm::dvec2> all(const FewOf<glm::dvec2>& points) {
    return {points.data(), points.size()};
}

// The solid has no edge between such triangles.
bool coplanar(const Occluders& occluders, uint32_t t, uint32_t u) {
    const auto twiceNormal = [&](uint32_t triangle) {
        const auto corner = [&](size_t k) {
            return occluders.vertices[occluders.triangles[3 * triangle + k]];
        };
        return glm::cross(corner(1) - corner(0), corner(2) - corner(0));
    };
    const glm::dvec3 n = twiceNormal(t), m = twiceNormal(u);
    return glm::dot(n, m) > 0 && glm::length(glm::cross(n, m)) <= 1e-12 * glm::dot(n, m);
}

} // namespace

glm::dvec2 PlaneFrame::flat(glm::dvec3 p) const {
    return {glm::dot(p - origin, u), glm::dot(p - origin, v)};
}

bool ConvexOutline::contains(glm::dvec2 p) const {
    if (points.size() < 3 || p.x <= box.low.x || p.y <= box.low.y || p.x >= box.high.x || p.y >= box.high.y)
        return false;
    glm::dvec2 from = points.back();
    for (const glm::dvec2 to : points) {
        if (cross(to - from, p - from) <= 0) return false;
        from = to;
    }
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
    struct Side {
        uint32_t low, high, triangle;
    };
    std::vector<Side> sides;
    for (uint32_t i = 0; i < occluders.triangles.size(); ++i) {
        const auto [a, b] =
            std::minmax(occluders.triangles[i], occluders.triangles[i % 3 == 2 ? i - 2 : i + 1]);
        sides.push_back({a, b, i / 3});
    }
    std::ranges::sort(sides, {}, [](const Side& s) { return std::tuple(s.low, s.high, s.triangle); });
    const auto same = [](const Side& s, const Side& o) { return s.low == o.low && s.high == o.high; };
    for (size_t i = 0; i < sides.size(); ++i) {
        if (i > 0 && same(sides[i - 1], sides[i])) continue;
        if (i + 1 < sides.size() && same(sides[i], sides[i + 1]) &&
            coplanar(occluders, sides[i].triangle, sides[i + 1].triangle))
            continue;
        solids[solidOf[joined.root(sides[i].low)]].edges.emplace_back(place[sides[i].low],
                                                                      place[sides[i].high]);
    }
    return solids;
}

std::optional<glm::dvec2> imageOf(glm::dvec3 p, const OpticalDevice& device) {
    constexpr double kNearest = 1e-6; // metres
    const glm::dvec3 q = device.deviceFromWorld * p + device.translation;
    if (q.z < kNearest) return std::nullopt;
    return glm::dvec2(q) / q.z;
}

std::optional<ImageOutline> imageOutline(const ConvexSolid& solid, const OpticalDevice& device) {
    std::vector<glm::dvec2> image;
    for (const glm::dvec3& p : solid.corners) {
        const auto q = imageOf(p, device);
        if (!q) return std::nullopt;
        image.push_back(*q);
    }
    ImageOutline out;
    out.box = boxOf(image);
    FewOf<uint32_t> hull = convexHull(image);
    std::ranges::reverse(hull); // the image's y runs down
    const auto same = [&](uint32_t i, uint32_t j) { return glm::length(image[i] - image[j]) < kSameInImage; };
    for (const uint32_t i : hull)
        if (out.corners.empty() || !same(i, out.corners.back())) out.corners.push_back(i);
    while (out.corners.size() > 1 && same(out.corners.front(), out.corners.back())) out.corners.pop_back();
    for (const uint32_t i : out.corners) out.points.push_back(image[i]);
    return out;
}

ConvexOutline shadowOnPlane(const ConvexSolid& solid, const ImageOutline* outline, glm::dvec3 light,
                            const PlaneFrame& plane, double skin, const FlatBox& within) {
    const double lightHeight = glm::dot(light - plane.origin, plane.normal);
    if (lightHeight <= 0) return {};
    const double top = 0.999 * lightHeight; // what is level with the light throws its shadow to infinity
    FewOf<double> height;
    double lowest = 1e300, highest = -1e300;
    for (const glm::dvec3& p : solid.corners) {
        height.push_back(glm::dot(p - plane.origin, plane.normal));
        lowest = std::min(lowest, height.back());
        highest = std::max(highest, height.back());
    }
    if (highest <= skin || lowest >= top) return {};
    const auto shadowOf = [&](const glm::dvec3& p, double h) {
        return plane.flat(light + (p - light) * (lightHeight / (lightHeight - h)));
    };

    ConvexOutline shadow;
    if (outline && lowest >= -kTouch && highest <= top) {
        FewOf<glm::dvec2> points;
        for (const uint32_t c : outline->corners) points.push_back(shadowOf(solid.corners[c], height[c]));
        shadow.box = boxOf(all(points));
        if (points.size() >= 3 && shadow.box.meets(within))
            shadow.points.assign(points.begin(), points.end());
        return shadow;
    }
    // What is below the plane only makes the box larger.
    FewOf<glm::dvec2> points;
    for (size_t c = 0; c < solid.corners.size(); ++c)
        if (height[c] <= top) points.push_back(shadowOf(solid.corners[c], height[c]));
    if (highest <= top && !boxOf(all(points)).meets(within)) return shadow;
    size_t kept = 0, known = 0;
    for (const double h : height)
        if (h <= top) {
            if (h >= 0) points[kept++] = points[known];
            ++known;
        }
    points.resize(kept);
    for (const double level : {0.0, top})
        if (lowest < level && highest > level)
            for (const auto& [a, b] : solid.edges)
                if ((height[a] < level) != (height[b] < level)) {
                    const glm::dvec3 p = solid.corners[a], q = solid.corners[b];
                    points.push_back(
                        shadowOf(p + (level - height[a]) / (height[b] - height[a]) * (q - p), level));
                }
    if (points.size() < 3) return shadow;
    shadow.box = boxOf(all(points));
    if (!shadow.box.meets(within)) return shadow;
    const FewOf<uint32_t> hull = convexHull(all(points));
    if (hull.size() < 3) return shadow;
    for (const uint32_t i : hull) shadow.points.push_back(points[i]);
    return shadow;
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
