#include "compute/convex_regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <tuple>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "geometry/bounds.h"
#include "geometry/clip_polygon.h"
#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"

namespace heliodon::compute {

using glm::dvec2;
using glm::dvec3;

namespace {

constexpr double kGap = 1e-6; // share of a region's area that may be missing in its hull

using Flat = std::vector<dvec2>; // a convex polygon in a plane, counter-clockwise

double areaOf(const Flat& polygon) {
    double sum = 0;
    for (size_t k = 1; k + 1 < polygon.size(); ++k)
        sum += geometry::cross(polygon[k] - polygon[0], polygon[k + 1] - polygon[0]);
    return 0.5 * sum;
}

// Andrew's monotone chain over points in strict order; then, going round from a corner that is sure, corners
// nearer than `flat` to a straight edge are dropped.
Flat hullOf(const std::vector<Flat>& parts, double flat) {
    Flat points;
    for (const Flat& part : parts) points.insert(points.end(), part.begin(), part.end());
    const auto less = [](dvec2 a, dvec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); };
    std::sort(points.begin(), points.end(), less);
    Flat hull;
    const auto chain = [&](auto begin, auto end) {
        const size_t base = hull.size();
        for (auto p = begin; p != end; ++p) {
            while (hull.size() >= base + 2) {
                const dvec2 a = hull[hull.size() - 2], b = hull.back();
                if (geometry::cross(b - a, *p - a) > 0) break;
                hull.pop_back();
            }
            hull.push_back(*p);
        }
        hull.pop_back();
    };
    if (points.size() < 3) return {};
    chain(points.begin(), points.end());
    chain(points.rbegin(), points.rend());
    const auto farther = [&](dvec2 a, dvec2 b) {
        return glm::length(a - points.front()) < glm::length(b - points.front());
    };
    std::rotate(hull.begin(), std::max_element(hull.begin(), hull.end(), farther), hull.end());
    Flat corners;
    hull.push_back(hull.front());
    for (dvec2 p : hull) {
        while (!corners.empty()) {
            const dvec2 b = corners.back();
            if (corners.size() == 1) {
                if (glm::length(p - b) > flat) break;
            } else {
                const dvec2 a = corners[corners.size() - 2];
                if (geometry::cross(b - a, p - a) > flat * glm::length(p - a)) break;
            }
            corners.pop_back();
        }
        corners.push_back(p);
    }
    corners.pop_back();
    return corners.size() >= 3 ? corners : Flat{};
}

Flat half(const Flat& polygon, dvec2 point, dvec2 direction, double sign, double flat) {
    Flat result;
    const auto height = [&](dvec2 p) {
        const double d = sign * geometry::cross(direction, p - point);
        return std::abs(d) <= flat ? 0 : d;
    };
    geometry::clip<dvec2>(polygon, height, result);
    return result;
}

struct Line {
    dvec2 point, direction;
    double length; // of the borders along it
};

// Lines of edges that no neighbour shares and that lie inside the hull: where the region is not convex.
constexpr size_t kMostLines = 64;
std::vector<Line> innerBorders(const std::vector<Flat>& parts, const Flat& hull, double flat) {
    const auto key = [flat](dvec2 p) {
        return std::array<int64_t, 2>{std::llround(p.x / (16 * flat)), std::llround(p.y / (16 * flat))};
    };
    std::set<std::array<int64_t, 4>> edges;
    const auto edgeKey = [&](dvec2 a, dvec2 b) {
        const auto u = key(a), v = key(b);
        return std::array<int64_t, 4>{u[0], u[1], v[0], v[1]};
    };
    for (const Flat& part : parts)
        for (size_t k = 0; k < part.size(); ++k) edges.insert(edgeKey(part[k], part[(k + 1) % part.size()]));
    std::vector<Line> lines;
    for (const Flat& part : parts)
        for (size_t k = 0; k < part.size(); ++k) {
            const dvec2 a = part[k], b = part[(k + 1) % part.size()];
            if (glm::length(b - a) <= 4 * flat || edges.count(edgeKey(b, a))) continue;
            const dvec2 direction = glm::normalize(b - a);
            bool onHull = false;
            for (size_t h = 0; h < hull.size() && !onHull; ++h) {
                const dvec2 side = glm::normalize(hull[(h + 1) % hull.size()] - hull[h]);
                onHull = std::abs(geometry::cross(side, a - hull[h])) <= 4 * flat &&
                         std::abs(geometry::cross(side, b - hull[h])) <= 4 * flat;
            }
            const auto same = [&](const Line& l) {
                return std::abs(geometry::cross(l.direction, direction)) < 1e-9 &&
                       std::abs(geometry::cross(l.direction, a - l.point)) <= 4 * flat;
            };
            if (onHull) continue;
            const auto known = std::find_if(lines.begin(), lines.end(), same);
            if (known != lines.end())
                known->length += glm::length(b - a);
            else if (lines.size() < kMostLines)
                lines.push_back({a, direction, glm::length(b - a)});
        }
    return lines;
}

// Whether parts cover one another: then the sum of their areas says nothing of what is missing between them.
// By a sweep along x, since parts that do not are many.
bool overlap(const std::vector<Flat>& parts, double flat, double allowed) {
    struct Extent {
        dvec2 low{INFINITY}, high{-INFINITY};
        size_t part = 0;
    };
    std::vector<Extent> extents;
    for (size_t k = 0; k < parts.size(); ++k) {
        Extent extent;
        for (dvec2 p : parts[k]) extent.low = glm::min(extent.low, p), extent.high = glm::max(extent.high, p);
        extent.part = k;
        extents.push_back(extent);
    }
    std::sort(extents.begin(), extents.end(), [](const Extent& a, const Extent& b) {
        return a.low.x != b.low.x ? a.low.x < b.low.x : a.part < b.part;
    });
    double area = 0;
    std::vector<Extent> open;
    for (const Extent& extent : extents) {
        std::erase_if(open, [&](const Extent& other) { return other.high.x <= extent.low.x + flat; });
        for (const Extent& other : open) {
            if (other.high.y <= extent.low.y + flat || extent.high.y <= other.low.y + flat) continue;
            Flat common = parts[extent.part];
            const Flat& by = parts[other.part];
            for (size_t k = 0; k < by.size() && !common.empty(); ++k) {
                const dvec2 edge = by[(k + 1) % by.size()] - by[k];
                if (glm::length(edge) > flat) common = half(common, by[k], glm::normalize(edge), 1, flat);
            }
            if ((area += areaOf(common)) > allowed) return true;
        }
        open.push_back(extent);
    }
    return false;
}

// Splits until every part of the plane is convex.
void convexParts(std::vector<Flat> parts, double flat, int depth, std::vector<Flat>& result) {
    if (parts.empty()) return;
    double area = 0;
    for (const Flat& part : parts) area += areaOf(part);
    const Flat hull = hullOf(parts, flat);
    const double whole = areaOf(hull);
    if (area <= 0) return;
    if (parts.size() == 1 ||
        (std::abs(whole - area) <= kGap * whole && !overlap(parts, flat, kGap * whole))) {
        result.push_back(hull);
        return;
    }
    // The line that cuts the fewest parts and leaves something on both sides; of these the one along most of
    // the border (sills of a row of windows), then the one that halves best: a facade is not taken apart
    // window by window.
    const Line* best = nullptr;
    std::tuple<size_t, double, size_t> least{SIZE_MAX, 0, SIZE_MAX};
    const std::vector<Line> lines = innerBorders(parts, hull, flat);
    for (const Line& line : lines) {
        size_t cut = 0, left = 0, right = 0;
        for (const Flat& part : parts) {
            bool l = false, r = false;
            for (dvec2 p : part) {
                const double d = geometry::cross(line.direction, p - line.point);
                l = l || d > flat;
                r = r || d < -flat;
            }
            cut += l && r;
            left += l;
            right += r;
        }
        const std::tuple cost{cut, -line.length, left > right ? left - right : right - left};
        if (left && right && cost < least) {
            best = &line;
            least = cost;
        }
    }
    if (!best || depth == 0 || area > whole * (1 + kGap)) { // overlapping or past mending: as meshed
        for (const Flat& part : parts) result.push_back(part);
        return;
    }
    for (double sign : {1.0, -1.0}) {
        std::vector<Flat> side;
        for (const Flat& part : parts) {
            Flat piece = half(part, best->point, best->direction, sign, flat);
            if (areaOf(piece) > flat * flat) side.push_back(std::move(piece));
        }
        convexParts(std::move(side), flat, depth - 1, result);
    }
}

struct Plane {
    dvec3 origin, normal, u, v;
    std::vector<size_t> patches;
};

double sizeOf(const geometry::PatchMesh& mesh) {
    return std::max(geometry::boundsOf(mesh.vertices).diagonal(), 1e-300);
}

// Patches of one room in one oriented plane, to within kOnePlane: large patches first, whose normals are
// sure; files round the corners of small ones.
std::vector<Plane> planesOf(const geometry::PatchMesh& mesh, double size) {
    std::vector<double> area(mesh.patchCount());
    std::vector<size_t> order;
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        if ((area[i] = geometry::patchArea(mesh, i)) > 0) order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return area[a] > area[b]; });
    std::vector<Plane> result;
    // Planes by room and coarse direction, listed under all neighbouring cells of their normal.
    std::map<std::array<int64_t, 4>, std::vector<size_t>> byDirection;
    const auto cell = [](double x) { return std::llround(8 * x); };
    for (size_t i : order) {
        const dvec3 n = geometry::patchNormal(mesh, i);
        const std::array<int64_t, 4> key{mesh.room[i], cell(n.x), cell(n.y), cell(n.z)};
        const auto holds = [&](size_t k) {
            if (glm::dot(result[k].normal, n) < 0.999) return false;
            for (uint32_t corner : mesh.patch(i))
                if (std::abs(glm::dot(mesh.vertices[corner] - result[k].origin, result[k].normal)) >
                    kOnePlane * size)
                    return false;
            return true;
        };
        const std::vector<size_t>& near = byDirection[key];
        if (const auto found = std::find_if(near.begin(), near.end(), holds); found != near.end()) {
            result[*found].patches.push_back(i);
            continue;
        }
        for (int64_t dx = -1; dx <= 1; ++dx)
            for (int64_t dy = -1; dy <= 1; ++dy)
                for (int64_t dz = -1; dz <= 1; ++dz)
                    byDirection[{key[0], key[1] + dx, key[2] + dy, key[3] + dz}].push_back(result.size());
        const dvec3 other = std::abs(n.x) < 0.6 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
        const dvec3 u = glm::normalize(glm::cross(other, n));
        result.push_back({geometry::patchCentroid(mesh, i), n, u, glm::cross(n, u), {i}});
    }
    for (Plane& plane : result) { // the plane of all of them
        dvec3 sum{0}, weighted{0};
        double total = 0;
        for (size_t i : plane.patches) {
            sum += geometry::patchAreaVector(mesh, i);
            weighted += area[i] * geometry::patchCentroid(mesh, i);
            total += area[i];
        }
        plane.origin = weighted / total;
        plane.normal = glm::normalize(sum);
        plane.u = glm::normalize(plane.u - glm::dot(plane.u, plane.normal) * plane.normal);
        plane.v = glm::cross(plane.normal, plane.u);
        std::sort(plane.patches.begin(), plane.patches.end());
    }
    return result;
}

// Points in a tree of boxes: whether any lies beyond a plane is found without asking them all, which no plane
// of a round room, all of it on one side, would be spared.
class PointTree {
public:
    explicit PointTree(std::vector<dvec3> points) : points_(std::move(points)) {
        if (!points_.empty()) add(0, static_cast<uint32_t>(points_.size()));
    }

    // Farther than `least` along `normal` from `origin`.
    bool reaches(const dvec3& origin, const dvec3& normal, double least) const {
        return !points_.empty() && reaches(0, origin, normal, least);
    }

private:
    static constexpr uint32_t kLeaf = 16;

    struct Node {
        geometry::Bounds box;
        uint32_t first = 0, end = 0; // of the points
        uint32_t second = 0;         // the first child comes next; no children: 0
    };

    void add(uint32_t first, uint32_t end) {
        const size_t at = nodes_.size();
        const geometry::Bounds box = geometry::boundsOf(std::span(points_).subspan(first, end - first));
        nodes_.push_back({box, first, end, 0});
        if (end - first <= kLeaf) return;
        const dvec3 extent = box.high - box.low;
        const int axis = extent.x >= std::max(extent.y, extent.z) ? 0 : extent.y >= extent.z ? 1 : 2;
        const uint32_t middle = first + (end - first) / 2;
        std::nth_element(points_.begin() + first, points_.begin() + middle, points_.begin() + end,
                         [axis](const dvec3& a, const dvec3& b) { return a[axis] < b[axis]; });
        add(first, middle);
        nodes_[at].second = static_cast<uint32_t>(nodes_.size());
        add(middle, end);
    }

    bool reaches(uint32_t at, const dvec3& origin, const dvec3& normal, double least) const {
        const Node& node = nodes_[at];
        const auto beyond = [&](const dvec3& p) { return glm::dot(p - origin, normal) > least; };
        dvec3 farthest;
        for (int k = 0; k < 3; ++k) farthest[k] = normal[k] > 0 ? node.box.high[k] : node.box.low[k];
        if (!beyond(farthest)) return false;
        if (node.second == 0)
            return std::any_of(points_.begin() + node.first, points_.begin() + node.end, beyond);
        return reaches(at + 1, origin, normal, least) || reaches(node.second, origin, normal, least);
    }

    std::vector<dvec3> points_;
    std::vector<Node> nodes_;
};

std::map<uint32_t, PointTree> cornersOfRooms(const geometry::PatchMesh& mesh) {
    std::map<uint32_t, std::vector<uint32_t>> corners;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const auto patch = mesh.patch(i);
        corners[mesh.room[i]].insert(corners[mesh.room[i]].end(), patch.begin(), patch.end());
    }
    std::map<uint32_t, PointTree> result;
    for (auto& [room, of] : corners) {
        std::sort(of.begin(), of.end());
        of.erase(std::unique(of.begin(), of.end()), of.end());
        std::vector<dvec3> points;
        for (uint32_t corner : of) points.push_back(mesh.vertices[corner]);
        result.emplace(room, PointTree(std::move(points)));
    }
    return result;
}

// Planes that look at another of their room across a gap that counts as one plane, but is wider than those of
// faces put together: a board a hair from a wall, which hides it from what is behind the board.
class NarrowlyFaced {
public:
    NarrowlyFaced(const geometry::PatchMesh& mesh, std::span<const Plane> planes, double size)
        : mesh_(mesh), planes_(planes), size_(size) {
        for (size_t k = 0; k < planes.size(); ++k) byTilt_.emplace(tiltOf(planes[k].normal), k);
    }

    bool operator()(const Plane& plane) const {
        const double tilt = tiltOf(-plane.normal);
        const auto end = byTilt_.upper_bound(tilt + kTilt);
        return std::any_of(byTilt_.lower_bound(tilt - kTilt), end, [&](const auto& entry) {
            const Plane& other = planes_[entry.second];
            const double gap = glm::dot(other.origin - plane.origin, plane.normal) / size_;
            return gap > kOnePlane && gap <= kSamePlane &&
                   glm::dot(other.normal, plane.normal) < -kOpposite &&
                   mesh_.room[other.patches[0]] == mesh_.room[plane.patches[0]];
        });
    }

private:
    static constexpr double kTilt = 1e-5, kOpposite = 1 - 1e-10;
    // Along a direction that no walls share.
    static double tiltOf(const dvec3& normal) { return glm::dot(normal, dvec3(0.4821, 0.7193, 0.5002)); }

    const geometry::PatchMesh& mesh_;
    std::span<const Plane> planes_;
    double size_;
    std::multimap<double, size_t> byTilt_;
};

// The plane's patches as convex regions.
void mergePlane(const geometry::PatchMesh& mesh, const Plane& plane, double flat, uint32_t maxCorners,
                uint32_t group, std::vector<ConvexRegion>& regions) {
    std::vector<Flat> parts, convex;
    // Corners that survive are given back as they were, to the last bit: a wall that stands on a floor shares
    // its edge.
    std::map<std::array<double, 2>, dvec3> vertex;
    for (size_t i : plane.patches) {
        Flat part;
        for (uint32_t corner : mesh.patch(i)) {
            const dvec3 d = mesh.vertices[corner] - plane.origin;
            part.push_back({glm::dot(d, plane.u), glm::dot(d, plane.v)});
            vertex[{part.back().x, part.back().y}] = mesh.vertices[corner];
        }
        parts.push_back(std::move(part));
    }
    convexParts(std::move(parts), flat, 64, convex);
    for (const Flat& part : convex)
        for (size_t first = 1; first + 1 < part.size(); first += maxCorners - 2) {
            ConvexRegion region{{}, mesh.room[plane.patches[0]], group};
            const auto lifted = [&](dvec2 p) {
                const auto found = vertex.find({p.x, p.y});
                return found != vertex.end() ? found->second : plane.origin + p.x * plane.u + p.y * plane.v;
            };
            region.corners.push_back(lifted(part[0]));
            for (size_t k = first; k < std::min(part.size(), first + maxCorners - 1); ++k)
                region.corners.push_back(lifted(part[k]));
            regions.push_back(std::move(region));
        }
}

} // namespace

std::vector<uint32_t> planeNumbers(const geometry::PatchMesh& mesh) {
    std::vector<uint32_t> number(mesh.patchCount(), 0);
    uint32_t next = 1; // 0: degenerate
    for (const Plane& plane : planesOf(mesh, sizeOf(mesh))) {
        for (size_t i : plane.patches) number[i] = next;
        ++next;
    }
    return number;
}

BlockingPlanes blockingPlanes(const geometry::PatchMesh& mesh, uint32_t maxCorners) {
    const double size = sizeOf(mesh);
    const std::map<uint32_t, PointTree> corners = cornersOfRooms(mesh);
    BlockingPlanes result;
    const std::vector<Plane> planes = planesOf(mesh, size);
    const NarrowlyFaced isNarrowlyFaced(mesh, planes, size);
    for (const Plane& plane : planes) {
        ++result.planes;
        const PointTree& room = corners.at(mesh.room[plane.patches[0]]);
        if ((room.reaches(plane.origin, plane.normal, kSamePlane * size) || isNarrowlyFaced(plane)) &&
            room.reaches(plane.origin, -plane.normal, kSamePlane * size))
            mergePlane(mesh, plane, 1e-9 * size, maxCorners, result.planes, result.regions);
    }
    return result;
}

std::vector<ConvexRegion> blockingRegions(const geometry::PatchMesh& mesh, uint32_t maxCorners) {
    return blockingPlanes(mesh, maxCorners).regions;
}

std::vector<ConvexRegion> outsideRegions(const geometry::PatchMesh& mesh, uint32_t maxCorners) {
    if (mesh.outside.triangles.empty()) return {};
    geometry::PatchMesh outer;
    outer.vertices = mesh.outside.vertices;
    for (size_t t = 0; t < mesh.outside.triangles.size(); t += 3)
        outer.addPatch(std::span(mesh.outside.triangles).subspan(t, 3), 0, geometry::Role::extra, 0,
                       geometry::kNoRoom);
    std::vector<uint32_t> material = mesh.outside.material;
    material.resize(outer.patchCount(), 0);
    return mergedRegions(outer, material, maxCorners);
}

std::vector<ConvexRegion> mergedRegions(const geometry::PatchMesh& mesh, std::span<const uint32_t> group,
                                        uint32_t maxCorners) {
    const double size = sizeOf(mesh);
    std::vector<ConvexRegion> regions;
    for (const Plane& plane : planesOf(mesh, size)) {
        std::map<uint32_t, Plane> byGroup;
        for (size_t i : plane.patches) {
            if (group[i] == kNoGroup) continue;
            Plane& part =
                byGroup.try_emplace(group[i], Plane{plane.origin, plane.normal, plane.u, plane.v, {}})
                    .first->second;
            part.patches.push_back(i);
        }
        for (const auto& [id, part] : byGroup) mergePlane(mesh, part, 1e-9 * size, maxCorners, id, regions);
    }
    return regions;
}

} // namespace heliodon::compute
