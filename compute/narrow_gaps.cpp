#include "compute/narrow_gaps.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <glm/geometric.hpp>

#include "compute/convex_regions.h"
#include "compute/opposite_sheets.h"
#include "geometry/bounds.h"
#include "geometry/clip_polygon.h"
#include "geometry/outline_area.h"

namespace heliodon::compute {

namespace {

using glm::dvec3;
using Polygon = std::vector<dvec3>;

constexpr double kTouching = 1e-9;    // as large a share of distance and radii is the rounding of coordinates
constexpr double kStraight = 0.99999; // cosine between both normals
constexpr double kSliver = 5e-8;      // of a patch: what cuts leave over
constexpr double kShort =
    1e-9; // of an outline's size: edges left by cuts that have no direction but rounding

// One plane's patches.
struct Sheet {
    dvec3 centre{0}, normal{0};
    double radius = 0, order = 0; // planeOrder()
    uint32_t room = 0;
    std::vector<uint32_t> patches;
};

std::vector<Sheet> sheetsOf(const geometry::PatchMesh& mesh, std::span<const uint32_t> plane,
                            const geometry::Bounds& box) {
    std::vector<Sheet> sheets;
    std::vector<double> area;
    for (uint32_t i = 0; i < mesh.patchCount(); ++i) {
        if (plane[i] == 0) continue;
        if (plane[i] > sheets.size()) sheets.resize(plane[i]), area.resize(plane[i], 0.0);
        Sheet& sheet = sheets[plane[i] - 1];
        const double own = geometry::patchArea(mesh, i);
        sheet.patches.push_back(i);
        sheet.room = mesh.room[i];
        sheet.normal += geometry::patchAreaVector(mesh, i);
        sheet.centre += own * geometry::patchCentroid(mesh, i);
        area[plane[i] - 1] += own;
    }
    for (size_t k = 0; k < sheets.size(); ++k) {
        Sheet& sheet = sheets[k];
        sheet.centre /= area[k];
        sheet.normal = glm::normalize(sheet.normal);
        for (uint32_t i : sheet.patches)
            for (uint32_t corner : mesh.patch(i))
                sheet.radius = std::max(sheet.radius, glm::distance(mesh.vertices[corner], sheet.centre));
        sheet.order = planeOrder(sheet.normal, sheet.centre, box);
    }
    std::sort(sheets.begin(), sheets.end(), [](const Sheet& a, const Sheet& b) { return a.order < b.order; });
    return sheets;
}

// The gap between two planes; 0 where they touch or are farther apart.
double gapBetween(const Sheet& a, const Sheet& b, double widest) {
    if (a.room != b.room || glm::dot(a.normal, b.normal) > -kStraight) return 0;
    const dvec3 d = b.centre - a.centre;
    const double reach = a.radius + b.radius, tilt = glm::length(glm::cross(a.normal, b.normal)),
                 overA = glm::dot(a.normal, d), overB = -glm::dot(b.normal, d);
    if (glm::length(d) > reach || std::min(overA, overB) <= kTouching * (glm::length(d) + reach)) return 0;
    const double most = std::min(overA + b.radius * tilt, overB + a.radius * tilt);
    return most <= widest ? std::min(overA, overB) : 0;
}

double areaOf(const Polygon& p) { return 0.5 * glm::length(geometry::areaVector(p)); }

// What of `part` lies within `by`, both counter-clockwise about the normal; the rest is added to
// `outside`.
Polygon within(Polygon part, const Polygon& by, const dvec3& normal, double sliver,
               std::vector<Polygon>& outside) {
    Polygon beyond, inside;
    const double shortest = kShort * geometry::boundsOf(by).diagonal();
    for (size_t k = 0; k < by.size() && !part.empty(); ++k) {
        const dvec3 edge = by[(k + 1) % by.size()] - by[k], inward = glm::cross(normal, edge);
        if (glm::length(edge) <= shortest) continue;
        const auto height = [&](const dvec3& p) { return glm::dot(inward, p - by[k]); };
        geometry::clip<dvec3>(
            part, [&](const dvec3& p) { return -height(p); }, beyond);
        geometry::clip<dvec3>(part, height, inside);
        if (areaOf(beyond) > sliver) outside.push_back(beyond);
        part.swap(inside);
    }
    return part;
}

// Of two sheets in one plane, to within `widest`, that look opposite ways: patches need not.
bool inOnePlane(const Sheet& a, const Sheet& b, double widest) {
    const dvec3 d = b.centre - a.centre;
    return a.room == b.room && glm::dot(a.normal, b.normal) < -kStraight &&
           glm::length(d) <= a.radius + b.radius &&
           std::max(std::abs(glm::dot(a.normal, d)), std::abs(glm::dot(b.normal, d))) <= widest;
}

class Cutter {
public:
    Cutter(const geometry::PatchMesh& mesh, NarrowGaps& gaps) : mesh_(mesh), gaps_(gaps) {}

    void cut(const Sheet& a, const Sheet& b, double gap) {
        std::vector<geometry::Bounds> boxes;
        for (uint32_t j : b.patches) boxes.push_back(geometry::boundsOf(geometry::patchCorners(mesh_, j)));
        for (uint32_t i : a.patches) {
            const geometry::Bounds own = geometry::boundsOf(geometry::patchCorners(mesh_, i));
            for (size_t k = 0; k < b.patches.size(); ++k)
                if (glm::all(glm::lessThanEqual(own.low - gap, boxes[k].high + gap)) &&
                    glm::all(glm::lessThanEqual(boxes[k].low - gap, own.high + gap)))
                    cut(i, b.patches[k], a.normal, gap);
        }
    }

private:
    std::vector<Polygon> openOf(uint32_t patch) const {
        const auto found = gaps_.open.find(patch);
        return found != gaps_.open.end() ? found->second
                                         : std::vector<Polygon>{geometry::patchCorners(mesh_, patch)};
    }

    void cut(uint32_t i, uint32_t j, const dvec3& normal, double gap) {
        const double sliver =
            kSliver * std::min(geometry::patchArea(mesh_, i), geometry::patchArea(mesh_, j));
        std::vector<Polygon> ours = openOf(i), theirs = openOf(j), left;
        bool any = false;
        for (size_t p = 0; p < ours.size(); ++p)
            for (size_t q = 0; q < theirs.size(); ++q) {
                // As seen from the first's side both turn alike.
                const Polygon other(theirs[q].rbegin(), theirs[q].rend());
                std::vector<Polygon> oursOut, theirsOut;
                const Polygon common = within(ours[p], other, normal, sliver, oursOut);
                if (areaOf(common) <= sliver) continue;
                within(other, common, normal, sliver, theirsOut); // so that both lose the same
                for (Polygon& part : theirsOut) std::reverse(part.begin(), part.end());
                gaps_.overlaps.push_back({i, j, common, gap});
                any = true;
                theirs.erase(theirs.begin() + static_cast<std::ptrdiff_t>(q));
                std::ranges::move(theirsOut, std::back_inserter(theirs));
                ours.erase(ours.begin() + static_cast<std::ptrdiff_t>(p));
                std::ranges::move(oursOut, std::back_inserter(ours));
                --p; // the next one stands in its place
                break;
            }
        if (any) gaps_.open[i] = std::move(ours), gaps_.open[j] = std::move(theirs);
    }

    const geometry::PatchMesh& mesh_;
    NarrowGaps& gaps_;
};

} // namespace

double NarrowGaps::Overlap::area() const {
    return 0.5 * glm::length(geometry::areaVector(outline));
}

NarrowGaps narrowGaps(const geometry::PatchMesh& mesh, std::span<const uint32_t> plane, double ofFaces) {
    NarrowGaps gaps;
    const geometry::Bounds box = geometry::boundsOf(mesh.vertices);
    if (!(box.diagonal() > 0)) return gaps;
    const std::vector<Sheet> sheets = sheetsOf(mesh, plane, box);
    struct Facing {
        double gap;
        const Sheet *a, *b;
    };
    std::vector<Facing> facing;
    for (const Sheet& a : sheets)
        for (const Sheet& b : oppositeSheets(sheets, a))
            if (const double gap =
                    gapBetween(a, b, std::min(kOnePlane * box.diagonal(), ofFaces * (a.radius + b.radius)));
                gap > 0)
                facing.push_back({gap, &a, &b});
    std::ranges::stable_sort(facing, {}, &Facing::gap);
    Cutter cutter(mesh, gaps);
    for (const Facing& pair : facing) cutter.cut(*pair.a, *pair.b, pair.gap);
    return gaps;
}

std::vector<NarrowGaps::Overlap> crossedGaps(const geometry::PatchMesh& mesh,
                                             std::span<const uint32_t> plane) {
    std::vector<NarrowGaps::Overlap> overlaps;
    const geometry::Bounds box = geometry::boundsOf(mesh.vertices);
    if (!(box.diagonal() > 0)) return overlaps;
    const std::vector<Sheet> sheets = sheetsOf(mesh, plane, box);
    const double widest = kOnePlane * box.diagonal();
    struct Patch {
        Polygon corners;
        dvec3 normal{0};
        geometry::Bounds box;
    };
    const auto patchesOf = [&](const Sheet& sheet) {
        std::vector<Patch> patches;
        for (uint32_t i : sheet.patches) {
            Polygon corners = geometry::patchCorners(mesh, i);
            const geometry::Bounds bounds = geometry::boundsOf(corners);
            patches.push_back({std::move(corners), geometry::patchNormal(mesh, i), bounds});
        }
        return patches;
    };
    const auto heightOver = [](const Patch& from, const dvec3& p) {
        return glm::dot(from.normal, p - from.corners[0]);
    };
    const auto highest = [&](const Patch& from, const Patch& patch) {
        double height = -INFINITY;
        for (const dvec3& p : patch.corners) height = std::max(height, heightOver(from, p));
        return height;
    };
    for (const Sheet& a : sheets)
        for (const Sheet& b : oppositeSheets(sheets, a)) {
            if (!inOnePlane(a, b, widest) || gapBetween(a, b, widest) > 0) continue;
            const double touching = kTouching * (a.radius + b.radius);
            const std::vector<Patch> ours = patchesOf(a), theirs = patchesOf(b);
            for (size_t p = 0; p < ours.size(); ++p)
                for (size_t q = 0; q < theirs.size(); ++q) {
                    const Patch &i = ours[p], &j = theirs[q];
                    if (!glm::all(glm::lessThanEqual(i.box.low - widest, j.box.high)) ||
                        !glm::all(glm::lessThanEqual(j.box.low - widest, i.box.high)))
                        continue;
                    const double gap = std::min(highest(i, j), highest(j, i));
                    if (gap <= touching || gap > widest) continue;
                    const double sliver = kSliver * std::min(geometry::patchArea(mesh, a.patches[p]),
                                                             geometry::patchArea(mesh, b.patches[q]));
                    Polygon mine, other;
                    std::vector<Polygon> rest;
                    geometry::clip<dvec3>(
                        i.corners, [&](const dvec3& x) { return heightOver(j, x) - touching; }, mine);
                    geometry::clip<dvec3>(
                        j.corners, [&](const dvec3& x) { return heightOver(i, x) - touching; }, other);
                    std::ranges::reverse(other);
                    Polygon common = within(std::move(mine), other, i.normal, sliver, rest);
                    if (!other.empty() && areaOf(common) > sliver)
                        overlaps.push_back({a.patches[p], b.patches[q], std::move(common), gap});
                }
        }
    return overlaps;
}

} // namespace heliodon::compute
