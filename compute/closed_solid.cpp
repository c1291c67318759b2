#include "compute/closed_solid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <span>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "compute/opposite_sheets.h"
#include "geometry/bounds.h"
#include "geometry/disjoint_sets.h"
#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"

namespace heliodon::compute {

using glm::dvec2;
using glm::dvec3;

namespace {

// Surfaces that hang together by edges, by the lowest of their patches; none where an edge is used twice in
// one direction or has no neighbour.
std::optional<std::vector<uint32_t>> closedSurfaces(const geometry::PatchMesh& mesh) {
    std::map<std::array<double, 3>, uint32_t> welded;
    std::vector<uint32_t> id;
    for (const dvec3& p : mesh.vertices)
        id.push_back(welded.try_emplace({p.x, p.y, p.z}, static_cast<uint32_t>(welded.size())).first->second);
    std::map<std::array<uint32_t, 3>, uint32_t> edges; // room, from, to
    for (uint32_t i = 0; i < mesh.patchCount(); ++i) {
        const auto corner = mesh.patch(i);
        for (size_t k = 0; k < corner.size(); ++k)
            if (!edges.try_emplace({mesh.room[i], id[corner[k]], id[corner[(k + 1) % corner.size()]]}, i)
                     .second)
                return {};
    }
    geometry::DisjointSets sets(mesh.patchCount());
    for (const auto& [edge, patch] : edges) {
        const auto other = edges.find({edge[0], edge[2], edge[1]});
        if (other == edges.end()) return {};
        sets.join(patch, other->second);
    }
    std::vector<uint32_t> surface(mesh.patchCount());
    for (uint32_t i = 0; i < mesh.patchCount(); ++i) surface[i] = sets.root(i);
    return surface;
}

bool pierces(const dvec3& a, const dvec3& b, const ConvexRegion& region, const dvec3& normal, double flat) {
    const double ha = glm::dot(a - region.corners[0], normal), hb = glm::dot(b - region.corners[0], normal);
    if (!((ha > flat && hb < -flat) || (ha < -flat && hb > flat))) return false;
    const dvec3 x = a + ha / (ha - hb) * (b - a);
    for (size_t k = 0; k < region.corners.size(); ++k) {
        const dvec3 edge = region.corners[(k + 1) % region.corners.size()] - region.corners[k];
        if (glm::dot(glm::cross(edge, x - region.corners[k]), normal) <= flat * glm::length(edge))
            return false;
    }
    return true;
}

// Convex polygons, counter-clockwise from opposite sides: whether they have more than a border in common.
bool overlap(std::span<const dvec2> a, std::span<const dvec2> b, double flat) {
    const auto apart = [flat](std::span<const dvec2> p, std::span<const dvec2> q) {
        for (size_t k = 0; k < p.size(); ++k) {
            const dvec2 edge = p[(k + 1) % p.size()] - p[k], across(edge.y, -edge.x);
            double own = -INFINITY, ownLow = INFINITY, other = -INFINITY, otherLow = INFINITY;
            for (const dvec2& x : p)
                own = std::max(own, glm::dot(x, across)), ownLow = std::min(ownLow, glm::dot(x, across));
            for (const dvec2& x : q)
                other = std::max(other, glm::dot(x, across)),
                otherLow = std::min(otherLow, glm::dot(x, across));
            if (std::min(own, other) - std::max(ownLow, otherLow) <= flat * glm::length(edge)) return true;
        }
        return false;
    };
    return !apart(a, b) && !apart(b, a);
}

// One plane's patches.
struct Sheet {
    dvec3 origin, normal;
    uint32_t room = 0;
    std::vector<uint32_t> patches;
    double order = 0; // planeOrder()
};

std::vector<Sheet> sheetsOf(const geometry::PatchMesh& mesh) {
    const std::vector<uint32_t> plane = planeNumbers(mesh);
    std::vector<Sheet> sheets;
    const geometry::Bounds box = geometry::boundsOf(mesh.vertices);
    std::vector<double> largest;
    for (uint32_t i = 0; i < mesh.patchCount(); ++i) {
        if (plane[i] == 0) continue;
        if (plane[i] > sheets.size()) sheets.resize(plane[i]), largest.resize(plane[i], 0.0);
        Sheet& sheet = sheets[plane[i] - 1];
        sheet.patches.push_back(i);
        if (const double area = geometry::patchArea(mesh, i); area > largest[plane[i] - 1]) {
            largest[plane[i] - 1] = area;
            sheet.origin = geometry::patchCentroid(mesh, i);
            sheet.normal = geometry::patchNormal(mesh, i);
            sheet.room = mesh.room[i];
            sheet.order = planeOrder(sheet.normal, sheet.origin, box);
        }
    }
    std::sort(sheets.begin(), sheets.end(), [](const Sheet& a, const Sheet& b) { return a.order < b.order; });
    return sheets;
}

// Patches of two sheets that lie on one another; both sides of one surface, as of a partition without
// thickness, are a solid still, if an empty one.
bool touch(const geometry::PatchMesh& mesh, const Sheet& a, const Sheet& b, std::span<const uint32_t> surface,
           double flat) {
    const dvec3 u = geometry::perpendicular(a.normal), v = glm::cross(a.normal, u);
    struct Outline {
        std::vector<dvec2> corners;
        dvec2 low{INFINITY}, high{-INFINITY};
        uint32_t patch;
    };
    const auto outlines = [&](const Sheet& sheet) {
        std::vector<Outline> result;
        for (uint32_t i : sheet.patches) {
            Outline outline{.corners = {}, .patch = i};
            for (uint32_t corner : mesh.patch(i)) {
                const dvec3 d = mesh.vertices[corner] - a.origin;
                const dvec2 p(glm::dot(d, u), glm::dot(d, v));
                outline.corners.push_back(p);
                outline.low = glm::min(outline.low, p), outline.high = glm::max(outline.high, p);
            }
            result.push_back(std::move(outline));
        }
        std::sort(result.begin(), result.end(),
                  [](const Outline& x, const Outline& y) { return x.low.x < y.low.x; });
        return result;
    };
    const std::vector<Outline> ours = outlines(a), theirs = outlines(b);
    const auto same = [&](const Outline& x, const Outline& y) { // as front and back
        return surface[x.patch] == surface[y.patch] && glm::distance(x.low, y.low) <= flat &&
               glm::distance(x.high, y.high) <= flat;
    };
    for (const Outline& x : ours)
        for (const Outline& y : theirs) {
            if (y.low.x >= x.high.x) break;
            if (y.high.x <= x.low.x || y.low.y >= x.high.y || y.high.y <= x.low.y) continue;
            if (!same(x, y) && overlap(x.corners, y.corners, flat)) return true;
        }
    return false;
}

bool anyTouch(const geometry::PatchMesh& mesh, std::span<const uint32_t> surface, double size) {
    const std::vector<Sheet> sheets = sheetsOf(mesh);
    for (const Sheet& a : sheets)
        for (const Sheet& b : oppositeSheets(sheets, a))
            if (b.room == a.room && glm::dot(a.normal, b.normal) < -0.999 &&
                std::abs(glm::dot(b.origin - a.origin, a.normal)) <= 2 * kSamePlane * size &&
                touch(mesh, a, b, surface, 1e-8 * size))
                return true;
    return false;
}

// Over 4 pi, the solid angle of a triangle seen from a point, positive from its front (A. van Oosterom, J.
// Strackee, 1983).
double turnsOf(const dvec3& point, const dvec3& p, const dvec3& q, const dvec3& r) {
    const dvec3 a = p - point, b = q - point, c = r - point;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    const double volume = glm::dot(a, glm::cross(b, c));
    const double below = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
    return -std::atan2(volume, below) / (2 * std::numbers::pi);
}

// Whether the air before each surface is that before all others of the room: how often surfaces go round it.
bool sameAir(const geometry::PatchMesh& mesh, std::span<const uint32_t> surface, double size) {
    struct Whole {
        std::vector<uint32_t> patches;
        dvec3 low{INFINITY}, high{-INFINITY};
    };
    std::map<uint32_t, Whole> wholes;
    for (uint32_t i = 0; i < mesh.patchCount(); ++i) {
        Whole& whole = wholes[surface[i]];
        whole.patches.push_back(i);
        for (uint32_t corner : mesh.patch(i))
            whole.low = glm::min(whole.low, mesh.vertices[corner]),
            whole.high = glm::max(whole.high, mesh.vertices[corner]);
    }
    std::map<uint32_t, int> air; // per room
    for (const auto& [name, own] : wholes) {
        const uint32_t largest =
            *std::max_element(own.patches.begin(), own.patches.end(), [&](uint32_t i, uint32_t j) {
                return geometry::patchArea(mesh, i) < geometry::patchArea(mesh, j);
            });
        if (!(geometry::patchArea(mesh, largest) > 0)) continue;
        const dvec3 point =
            geometry::patchCentroid(mesh, largest) + 1e-8 * size * geometry::patchNormal(mesh, largest);
        double turns = 0;
        for (const auto& [other, whole] : wholes) {
            if (mesh.room[whole.patches[0]] != mesh.room[largest] ||
                (other != name && (glm::any(glm::lessThan(point, whole.low)) ||
                                   glm::any(glm::greaterThan(point, whole.high)))))
                continue;
            for (uint32_t i : whole.patches) {
                const auto c = mesh.patch(i);
                for (size_t k = 1; k + 1 < c.size(); ++k)
                    turns +=
                        turnsOf(point, mesh.vertices[c[0]], mesh.vertices[c[k]], mesh.vertices[c[k + 1]]);
            }
        }
        const int round = static_cast<int>(std::lround(turns));
        if (air.try_emplace(mesh.room[largest], round).first->second != round) return false;
    }
    return true;
}

} // namespace

bool isClosedSolid(const geometry::PatchMesh& mesh, const std::vector<ConvexRegion>& regions) {
    // Beyond this, edges and regions cost more than they save.
    if (static_cast<double>(mesh.corners.size()) * static_cast<double>(regions.size()) > 2e7) return false;
    const auto surface = closedSurfaces(mesh);
    const double size = std::max(geometry::boundsOf(mesh.vertices).diagonal(), 1e-300);
    if (!surface || anyTouch(mesh, *surface, size) || !sameAir(mesh, *surface, size)) return false;
    const double flat = 1e-8 * size;
    for (const ConvexRegion& region : regions) {
        const dvec3 normal = glm::normalize(geometry::areaVector(region.corners));
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            if (mesh.room[i] != region.room) continue;
            const auto corner = mesh.patch(i);
            for (size_t k = 0; k < corner.size(); ++k)
                if (pierces(mesh.vertices[corner[k]], mesh.vertices[corner[(k + 1) % corner.size()]], region,
                            normal, flat))
                    return false;
        }
    }
    return true;
}

bool facesLookOutwards(const geometry::PatchMesh& mesh) {
    double sixVolumes = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        sixVolumes +=
            glm::dot(geometry::patchAreaVector(mesh, i), geometry::patchCentroid(mesh, i) - mesh.vertices[0]);
    return sixVolumes > 0;
}

} // namespace heliodon::compute
