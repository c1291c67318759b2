#include "geometry/panes_within_room.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <glm/geometric.hpp>

#include "geometry/disjoint_sets.h"
#include "geometry/open_sheets.h"
#include "geometry/outline_area.h"
#include "geometry/pane_in_hole.h"
#include "geometry/shell_faces.h"
#include "geometry/space_parts.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kApart = 50;      // tolerances: far more than what lies in one plane for those who see it
constexpr double kSameArea = 0.01; // of it: both lie in the hole for which the pane was drawn

double areaOf(const std::vector<SoupFace>& faces) {
    double sum = 0;
    for (const SoupFace& face : faces)
        for (const auto& loop : face.loops)
            sum += 0.5 * glm::dot(areaVector(loop), glm::normalize(areaVector(face.loops[0])));
    return sum;
}

struct GlassWithin { // SoupFace::surface
    std::set<uint32_t> surfaces;
    std::optional<std::pair<uint32_t, uint32_t>> covered;
};

// Glass with the same air on both sides.
GlassWithin glassWithin(const std::vector<SoupFace>& faces, const std::function<bool(uint32_t)>& isGlass,
                        double tolerance) {
    GlassWithin out;
    const auto space = partsOfSpace(faces, isGlass, tolerance);
    if (!space) {
        const auto sheets = openSheets(faces, isGlass, tolerance);
        return sheets ? glassWithin(sheets->closed, isGlass, tolerance) : out;
    }
    for (uint32_t f = 0; f < space->welded.faces.size(); ++f) {
        if (space->partAt(f, 0) != space->partAt(f, 1)) continue;
        if (space->parts.at(space->partAt(f, 0)).volume <= 0) continue;
        std::optional<uint32_t> glass, other;
        for (const auto& list : space->sheetOf(f).drawn)
            for (const uint32_t k : list) {
                (isGlass(faces[k].material) ? glass : other) = faces[k].surface;
                if (isGlass(faces[k].material)) out.surfaces.insert(faces[k].surface);
            }
        if (glass && other) out.covered = std::pair(*glass, *other);
    }
    return out;
}

// Faces of the soup that hang together and lie in one plane, of one glass.
std::vector<std::vector<uint32_t>> panesOf(const std::vector<SoupFace>& soup,
                                           const std::set<uint32_t>& surfaces, double tolerance) {
    std::vector<SoupFace> glass;
    std::vector<uint32_t> place;
    for (uint32_t f = 0; f < soup.size(); ++f)
        if (surfaces.contains(soup[f].surface)) glass.push_back(soup[f]), place.push_back(f);
    const Building welded = weldedByNumber(glass, tolerance);
    DisjointSets sets(glass.size());
    for (const auto& [edge, around] : facesOfEdges(welded)) {
        const SoupFace& one = glass[welded.faces[around[0]].surface];
        for (const uint32_t f : around) {
            const SoupFace& other = glass[welded.faces[f].surface];
            const dvec3 n = glm::normalize(areaVector(one.loops[0])),
                        m = glm::normalize(areaVector(other.loops[0]));
            if (one.material == other.material && (inOnePlane(n, m) || inOnePlane(n, -m)))
                sets.join(welded.faces[f].surface, welded.faces[around[0]].surface);
        }
    }
    std::map<uint32_t, std::vector<uint32_t>> panes;
    for (uint32_t k = 0; k < glass.size(); ++k) panes[sets.root(k)].push_back(place[k]);
    std::vector<std::vector<uint32_t>> out;
    for (auto& [root, pane] : panes) out.push_back(std::move(pane));
    return out;
}

} // namespace

std::optional<PanesWithinRoom> panesWithinRoom(const std::vector<SoupFace>& soup,
                                               const std::function<bool(uint32_t)>& isGlass,
                                               double tolerance) {
    if (std::ranges::none_of(soup, [&](const SoupFace& face) { return isGlass(face.material); }))
        return std::nullopt;
    const auto [surfaces, covered] = glassWithin(soup, isGlass, tolerance);
    if (covered) return PanesWithinRoom{.covered = covered};
    if (surfaces.empty()) return std::nullopt;
    const PaneFitter holes(soup, isGlass, tolerance);
    PanesWithinRoom out;
    std::vector<bool> gone(soup.size(), false);
    std::vector<SoupFace> made;
    for (const std::vector<uint32_t>& pane : panesOf(soup, surfaces, tolerance)) {
        std::vector<SoupFace> drawn;
        for (const uint32_t f : pane) drawn.push_back(soup[f]);
        const dvec3 apart = kApart * tolerance * glm::normalize(areaVector(drawn[0].loops[0]));
        // Where it lies in a wall's face, all of that behind it.
        for (const double front : {0.5, 0.0, 1.0}) {
            std::vector<SoupFace> one = holes.fit(pane, front * apart),
                                  other = holes.fit(pane, (front - 1) * apart);
            const double area = areaOf(drawn);
            if (std::abs(areaOf(one) - area) > kSameArea * area ||
                std::abs(areaOf(other) - area) > kSameArea * area)
                continue;
            for (SoupFace& face : other) turnOver(face);
            one.insert(one.end(), other.begin(), other.end());
            for (SoupFace& face : one) {
                face.twinKey = static_cast<int>(out.panes);
                made.push_back(std::move(face));
            }
            for (const uint32_t f : pane) gone[f] = true;
            ++out.panes;
            break;
        }
    }
    if (out.panes == 0) return std::nullopt;
    for (size_t f = 0; f < soup.size(); ++f)
        if (!gone[f]) out.soup.push_back(soup[f]);
    out.soup.insert(out.soup.end(), made.begin(), made.end());
    return out;
}

} // namespace heliodon::geometry
