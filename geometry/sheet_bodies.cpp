#include "geometry/sheet_bodies.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>

#include "geometry/disjoint_sets.h"
#include "geometry/flat_faces.h"
#include "geometry/outline_area.h"
#include "geometry/sheet_walls.h"
#include "geometry/shell_faces.h"
#include "geometry/space_sheets.h"

namespace heliodon::geometry {

namespace {

constexpr double kOpposite = 0.9; // least cosine between planes
constexpr size_t kMostShared = 1; // edges with what is no sheet: more has the last face of a broken body

// Before or behind its middle.
bool hasOpposite(const FlatFace& face, const SheetWalls& sheets, double within, double tolerance) {
    const glm::dvec3 middle = largestTriangle(face).middle();
    return std::ranges::any_of(std::array{face.normal, -face.normal}, [&](glm::dvec3 way) {
        return sheets.nearest(middle + 2 * tolerance * way, way, within, kOpposite) <= within;
    });
}

} // namespace

bool areOfBody(const std::vector<SoupFace>& drawn, const std::set<uint32_t>& sheets, double thickest,
               double tolerance) {
    const Building welded = weldedByNumber(drawn, tolerance);
    const auto isSheet = [&](uint32_t f) { return sheets.contains(drawn[welded.faces[f].surface].surface); };
    struct Beside {
        uint32_t face;
        glm::dvec3 inwards; // along it, away from the edge
    };
    std::map<Edge, std::vector<Beside>> edges;
    for (uint32_t f = 0; f < welded.faces.size(); ++f)
        for (const auto& loop : welded.faces[f].loops)
            for (size_t k = 0; k < loop.size(); ++k) {
                const uint32_t a = loop[k], b = loop[(k + 1) % loop.size()];
                const glm::dvec3 n = areaVector(welded.vertices, welded.faces[f].loops[0]);
                edges[std::minmax(a, b)].push_back(
                    {f, glm::normalize(glm::cross(n, welded.vertices[b] - welded.vertices[a]))});
            }
    DisjointSets wholes(welded.faces.size());
    std::set<uint32_t> attached; // faces with an edge of what is no sheet
    for (const auto& [edge, around] : edges)
        for (const Beside& sheet : around) {
            if (!isSheet(sheet.face)) continue;
            for (const Beside& other : around)
                if (isSheet(other.face))
                    wholes.join(sheet.face, other.face);
                else
                    attached.insert(sheet.face);
        }
    std::set<uint32_t> mayBeSides; // roots: pictures that hang before a partition are none
    for (const uint32_t f : attached) mayBeSides.insert(wholes.root(f));
    const auto mayBeSide = [&](uint32_t f) { return isSheet(f) && mayBeSides.contains(wholes.root(f)); };
    std::vector<SoupFace> ofThese;
    for (uint32_t f = 0; f < welded.faces.size(); ++f)
        if (mayBeSide(f)) ofThese.push_back(drawn[welded.faces[f].surface]);
    const SheetWalls opposite(ofThese, tolerance);
    std::set<uint32_t> sides;
    for (const FlatFace& face : flatFacesOf(welded))
        if (mayBeSide(face.face) && !face.triangles.empty() &&
            hasOpposite(face, opposite, thickest, tolerance))
            sides.insert(face.face);
    std::map<uint32_t, size_t> shared;
    for (const auto& [edge, around] : edges) {
        if (std::ranges::all_of(around, isSheet, &Beside::face)) continue;
        for (const Beside& sheet : around) {
            const auto others = std::ranges::count_if(around, [&](const Beside& one) { // but what lies on it
                return !isSheet(one.face) && glm::dot(one.inwards, sheet.inwards) < kOnePlaneCosine;
            });
            if (isSheet(sheet.face) && (others < 2 || sides.contains(sheet.face)) &&
                ++shared[sheet.face] > kMostShared)
                return true;
        }
    }
    return false;
}

std::set<uint32_t> bottomsOf(const std::set<uint32_t>& sheets, const std::vector<SoupFace>& faces,
                             const std::function<bool(uint32_t)>& isGlass, double tolerance) {
    std::vector<bool> mayBe;
    for (uint32_t k = 0; k < faces.size(); ++k)
        mayBe.push_back(!sheets.contains(k) && !isGlass(faces[k].material));
    const std::vector<Sheet> pieces = cutIntoSheets(faces, tolerance);
    const auto leaveOut = [&](const auto& which) { // pieces of which no other face is
        for (const Sheet& piece : pieces) {
            std::vector<uint32_t> all = piece.drawn[0];
            all.insert(all.end(), piece.drawn[1].begin(), piece.drawn[1].end());
            if (which(all))
                for (const uint32_t k : all) mayBe[k] = false;
        }
    };
    leaveOut([](const auto& all) { return all.size() == 1; });
    leaveOut([&](const auto& all) { return std::ranges::all_of(all, [&](uint32_t k) { return mayBe[k]; }); });
    const Building welded = weldedByNumber(faces, tolerance);
    DisjointSets sets(faces.size()); // a bottom may be drawn as several
    std::set<uint32_t> open, sharing;
    for (const auto& [edge, around] : facesOfEdges(welded)) {
        std::vector<uint32_t> bottoms;
        bool isOfSheet = false;
        for (const uint32_t f : around) {
            const uint32_t k = welded.faces[f].surface;
            if (mayBe[k]) bottoms.push_back(k);
            isOfSheet |= sheets.contains(k);
        }
        for (const uint32_t k : bottoms) sets.join(k, bottoms[0]);
        const auto isSame = [&](uint32_t k) { // drawn for its other side
            return sortedCorners(faces[k]) == sortedCorners(faces[bottoms[0]]);
        };
        if (isOfSheet || std::ranges::all_of(bottoms, isSame))
            (isOfSheet ? sharing : open).insert(bottoms.begin(), bottoms.end());
    }
    std::set<uint32_t> held, out;
    for (const uint32_t k : sharing) held.insert(sets.root(k));
    for (const uint32_t k : open) held.erase(sets.root(k));
    for (uint32_t k = 0; k < faces.size(); ++k)
        if (mayBe[k] && held.contains(sets.root(k))) out.insert(k);
    return out;
}

} // namespace heliodon::geometry
