#include "compute/closed_solid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <span>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "compute/opposite_sheets.h"
#include "geometry/bounds.h"
#include "geometry/disjoint_sets.h"
#include "geometry/perpendicular.h"

namespace heliodon::compute {

using glm::dvec2;
using glm::dvec3;

namespace {

// Surfaces that hang together by edges, each by one of its patches, and which of them are solids so far.
struct Surfaces {
    std::vector<uint32_t> of;  // per patch
    std::vector<bool> isSolid; // per patch that gives a surface its name

    bool solid(uint32_t patch) const { return isSolid[of[patch]]; }
    void drop(uint32_t patch) { isSolid[of[patch]] = false; }
};

// Not solids: surfaces of which an edge is used twice in one direction or has no neighbour.
Surfaces surfacesOf(const geometry::PatchMesh& mesh) {
    std::map<std::array<double, 3>, uint32_t> welded;
    std::vector<uint32_t> id;
    for (const dvec3& p : mesh.vertices)
        id.push_back(welded.try_emplace({p.x, p.y, p.z}, static_cast<uint32_t>(welded.size())).first->second);
    std::map<std::array<uint32_t, 3>, uint32_t> edges; // room, from, to
    geometry::DisjointSets sets(mesh.patchCount());
    std::vector<uint32_t> torn;
    for (uint32_t i = 0; i < mesh.patchCount(); ++i) {
        const auto corner = mesh.patch(i);
        for (size_t k = 0; k < corner.size(); ++k) {
            const auto [edge, fresh] =
                edges.try_emplace({mesh.room[i], id[corner[k]], id[corner[(k + 1) % corner.size()]]}, i);
            if (fresh) continue;
            torn.push_back(i);
            sets.join(i, edge->second);
        }
    }
    for (const auto& [edge, patch] : edges) {
        const auto other = edges.find({edge[0], edge[2], edge[1]});
        if (other == edges.end())
            torn.push_back(patch);
        else
            sets.join(patch, other->second);
    }
    Surfaces surfaces{{}, std::vector<bool>(mesh.patchCount(), true)};
    for (uint32_t i = 0; i < mesh.patchCount(); ++i) surfaces.of.push_back(sets.root(i));
    for (const uint32_t patch : torn) surfaces.drop(patch);
    return surfaces;
}

// Whether a patch passes through a region by more than `flat`, with its edges or between them: prisms of one
// height cross, though no edge of one goes through a face of the other.
bool crosses(std::span<const dvec3> patch, const ConvexRegion& region, const dvec3& normal, double flat) {
    double low = INFINITY, high = -INFINITY;
    for (const dvec3& p : patch) {
        const double h = glm::dot(p - region.corners[0], normal);
        low = std::min(low, h), high = std::max(high, h);
    }
    if (low >= -flat || high <= flat) return false;
    dvec3 ends[2]; // of what the patch has in the region's plane
    size_t count = 0;
    for (size_t k = 0; k < patch.size() && count < 2; ++k) {
        const dvec3 a = patch[k], b = patch[(k + 1) % patch.size()];
        const double ha = glm::dot(a - region.corners[0], normal),
                     hb = glm::dot(b - region.corners[0], normal);
        if ((ha < 0) != (hb < 0)) ends[count++] = a + ha / (ha - hb) * (b - a);
    }
    double from = 0, to = 1;
    for (size_t k = 0; k < region.corners.size() && count == 2 && from <= to; ++k) {
        const dvec3 edge = region.corners[(k + 1) % region.corners.size()] - region.corners[k];
        const dvec3 inward = glm::cross(normal, edge);
        const double least = flat * glm::length(edge),
                     da = glm::dot(inward, ends[0] - region.corners[k]) - least,
                     db = glm::dot(inward, ends[1] - region.corners[k]) - least;
        if (da <= 0 && db <= 0) return false;
        if (da < 0) from = std::max(from, da / (da - db));
        if (db < 0) to = std::min(to, da / (da - db));
    }
    return count == 2 && from <= to;
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

std::vector<Sheet> sheetsOf(const geometry::PatchMesh& mesh, std::span<const uint32_t> plane) {
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

// Of two sheets whose patches lie on one another; both sides of one surface, as of a partition without
// thickness, are a solid still, if an empty one.
void dropTouching(const geometry::PatchMesh& mesh, const Sheet& a, const Sheet& b, double flat,
                  Surfaces& surfaces) {
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
        return surfaces.of[x.patch] == surfaces.of[y.patch] && glm::distance(x.low, y.low) <= flat &&
               glm::distance(x.high, y.high) <= flat;
    };
    for (const Outline& x : ours)
        for (const Outline& y : theirs) {
            if (y.low.x >= x.high.x) break;
            if (y.high.x <= x.low.x || y.low.y >= x.high.y || y.high.y <= x.low.y) continue;
            if (!surfaces.solid(x.patch) && !surfaces.solid(y.patch)) continue;
            if (same(x, y) || !overlap(x.corners, y.corners, flat)) continue;
            surfaces.drop(x.patch);
            surfaces.drop(y.patch);
        }
}

// Faces as near to a wall as to hide nothing of it, kSamePlane, touch it: what they leave to be seen is
// hidden by the backs behind them.
void dropTouching(const geometry::PatchMesh& mesh, std::span<const uint32_t> plane, double size,
                  Surfaces& surfaces) {
    const std::vector<Sheet> sheets = sheetsOf(mesh, plane);
    for (const Sheet& a : sheets)
        for (const Sheet& b : oppositeSheets(sheets, a))
            if (b.room == a.room && glm::dot(a.normal, b.normal) < -0.999 &&
                std::abs(glm::dot(b.origin - a.origin, a.normal)) <= (kSamePlane + kOnePlane) * size)
                dropTouching(mesh, a, b, 1e-8 * size, surfaces);
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

// One surface and a point just before it.
struct Whole {
    std::vector<uint32_t> patches;
    dvec3 low{INFINITY}, high{-INFINITY}, before{0};

    // How often it goes round a point.
    long turnsRound(const geometry::PatchMesh& mesh, const dvec3& point) const {
        if (glm::any(glm::lessThan(point, low)) || glm::any(glm::greaterThan(point, high))) return 0;
        double turns = 0;
        for (const uint32_t i : patches) {
            const auto c = mesh.patch(i);
            for (size_t k = 1; k + 1 < c.size(); ++k)
                turns += turnsOf(point, mesh.vertices[c[0]], mesh.vertices[c[k]], mesh.vertices[c[k + 1]]);
        }
        return std::lround(turns);
    }

    double volume(const geometry::PatchMesh& mesh) const {
        double six = 0;
        for (const uint32_t i : patches) {
            const auto c = mesh.patch(i);
            for (size_t k = 1; k + 1 < c.size(); ++k)
                six += glm::dot(mesh.vertices[c[0]] - low,
                                glm::cross(mesh.vertices[c[k]] - low, mesh.vertices[c[k + 1]] - low));
        }
        return std::abs(six) / 6;
    }
};

dvec3 pointBefore(const geometry::PatchMesh& mesh, uint32_t patch, double size) {
    return geometry::patchCentroid(mesh, patch) + 1e-8 * size * geometry::patchNormal(mesh, patch);
}

std::map<uint32_t, Whole> wholesOf(const geometry::PatchMesh& mesh, const Surfaces& surfaces, double size) {
    std::map<uint32_t, Whole> wholes;
    std::map<uint32_t, double> largest;
    for (uint32_t i = 0; i < mesh.patchCount(); ++i) {
        const double area = geometry::patchArea(mesh, i);
        if (!(area > 0)) continue;
        Whole& whole = wholes[surfaces.of[i]];
        whole.patches.push_back(i);
        for (const uint32_t corner : mesh.patch(i))
            whole.low = glm::min(whole.low, mesh.vertices[corner]),
            whole.high = glm::max(whole.high, mesh.vertices[corner]);
        if (double& most = largest[surfaces.of[i]]; area > most) {
            most = area;
            whole.before = pointBefore(mesh, i, size);
        }
    }
    return wholes;
}

// Those that hold another surface of their room in their solid: it goes round that as it does not round what
// lies before it itself. Of boxes also those that hold no more than patches of another, as one pushed into a
// box of its own width has: none crosses.
void dropFilled(const geometry::PatchMesh& mesh, double size, Surfaces& surfaces) {
    const std::map<uint32_t, Whole> wholes = wholesOf(mesh, surfaces, size);
    for (const auto& [name, whole] : wholes) {
        if (!surfaces.isSolid[name]) continue;
        const long air = whole.turnsRound(mesh, whole.before);
        for (const auto& [other, inside] : wholes)
            if (mesh.room[other] == mesh.room[name] && whole.turnsRound(mesh, inside.before) != air)
                surfaces.isSolid[name] = false;
        // A room, which holds all patches, or a sheet drawn for both sides, which holds nothing.
        if (air != 0 || whole.volume(mesh) < 1e-8 * size * size * size) continue;
        for (uint32_t i = 0; i < mesh.patchCount() && surfaces.isSolid[name]; ++i)
            if (surfaces.of[i] != name && mesh.room[i] == mesh.room[name] &&
                whole.turnsRound(mesh, pointBefore(mesh, i, size)) != 0)
                surfaces.isSolid[name] = false;
    }
}

// Per region the surfaces that it covers something of, by name.
std::vector<std::set<uint32_t>> surfacesIn(const geometry::PatchMesh& mesh, std::span<const uint32_t> plane,
                                           const std::vector<ConvexRegion>& regions, double flat,
                                           const Surfaces& surfaces) {
    std::map<uint32_t, std::vector<uint32_t>> patchesOf; // planes
    for (uint32_t i = 0; i < mesh.patchCount(); ++i) patchesOf[plane[i]].push_back(i);
    std::vector<std::set<uint32_t>> result;
    for (const ConvexRegion& region : regions) {
        const dvec3 normal = normalOf(region);
        const dvec3 u = geometry::perpendicular(normal), v = glm::cross(normal, u);
        const auto inPlane = [&](const std::vector<dvec3>& corners) {
            std::vector<dvec2> flatCorners;
            for (const dvec3& p : corners)
                flatCorners.emplace_back(glm::dot(p - region.corners[0], u),
                                         glm::dot(p - region.corners[0], v));
            return flatCorners;
        };
        const std::vector<dvec2> own = inPlane(region.corners);
        std::set<uint32_t>& names = result.emplace_back();
        for (const uint32_t i : patchesOf[region.group])
            if (!names.contains(surfaces.of[i]) &&
                overlap(own, inPlane(geometry::patchCorners(mesh, i)), flat))
                names.insert(surfaces.of[i]);
    }
    return result;
}

// Those of which patches pass through blockers, and those whose blockers they are.
void dropPierced(const geometry::PatchMesh& mesh, const std::vector<ConvexRegion>& regions,
                 const std::vector<std::set<uint32_t>>& covered, double flat, Surfaces& surfaces) {
    std::vector<std::vector<dvec3>> corners;
    for (uint32_t i = 0; i < mesh.patchCount(); ++i) corners.push_back(geometry::patchCorners(mesh, i));
    for (size_t r = 0; r < regions.size(); ++r) {
        const dvec3 normal = normalOf(regions[r]);
        for (uint32_t i = 0; i < mesh.patchCount(); ++i) {
            if (mesh.room[i] != regions[r].room) continue;
            if (!crosses(corners[i], regions[r], normal, flat)) continue;
            surfaces.drop(i);
            for (const uint32_t name : covered[r]) surfaces.isSolid[name] = false;
        }
    }
}

double sizeOf(const geometry::PatchMesh& mesh) {
    return std::max(geometry::boundsOf(mesh.vertices).diagonal(), 1e-300);
}

// Crossings aside.
Surfaces solidSurfaces(const geometry::PatchMesh& mesh, std::span<const uint32_t> plane) {
    Surfaces surfaces = surfacesOf(mesh);
    dropTouching(mesh, plane, sizeOf(mesh), surfaces);
    dropFilled(mesh, sizeOf(mesh), surfaces);
    return surfaces;
}

} // namespace

std::vector<bool> regionsOfSolids(const geometry::PatchMesh& mesh, const std::vector<ConvexRegion>& regions) {
    std::vector<bool> result(regions.size(), false);
    // Beyond this, edges and regions cost more than they save.
    if (static_cast<double>(mesh.corners.size()) * static_cast<double>(regions.size()) > 2e7) return result;
    const std::vector<uint32_t> plane = planeNumbers(mesh);
    Surfaces surfaces = solidSurfaces(mesh, plane);
    const double flat = 1e-8 * sizeOf(mesh);
    const std::vector<std::set<uint32_t>> covered = surfacesIn(mesh, plane, regions, flat, surfaces);
    dropPierced(mesh, regions, covered, flat, surfaces);
    for (size_t r = 0; r < regions.size(); ++r)
        result[r] =
            std::ranges::all_of(covered[r], [&](uint32_t name) { return bool{surfaces.isSolid[name]}; });
    return result;
}

bool onlyFrontsBlock(const geometry::PatchMesh& mesh) {
    return std::ranges::all_of(regionsOfSolids(mesh, blockingRegions(mesh, 8)), std::identity());
}

bool isClosedSolid(const geometry::PatchMesh& mesh) {
    const Surfaces surfaces = solidSurfaces(mesh, planeNumbers(mesh));
    return std::ranges::all_of(surfaces.of, [&](uint32_t name) { return bool{surfaces.isSolid[name]}; });
}

bool facesLookOutwards(const geometry::PatchMesh& mesh) {
    double sixVolumes = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        sixVolumes +=
            glm::dot(geometry::patchAreaVector(mesh, i), geometry::patchCentroid(mesh, i) - mesh.vertices[0]);
    return sixVolumes > 0;
}

} // namespace heliodon::compute
