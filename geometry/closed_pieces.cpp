#include "geometry/closed_pieces.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include "geometry/flat_faces.h"
#include "geometry/outline_area.h"
#include "geometry/shell_faces.h"
#include "geometry/shell_nesting.h"

namespace heliodon::geometry {

namespace {

std::optional<ClosedPiece> closedPiece(const Building& sheets, const std::vector<uint32_t>& members) {
    Building alone; // with its own corners: those of all cost as much for each piece
    std::map<uint32_t, uint32_t> known;
    for (const uint32_t f : members) {
        Face& face = alone.faces.emplace_back(sheets.faces[f]);
        for (auto& loop : face.loops)
            for (uint32_t& v : loop) {
                const auto [place, isNew] =
                    known.try_emplace(v, static_cast<uint32_t>(alone.vertices.size()));
                if (isNew) alone.vertices.push_back(sheets.vertices[v]);
                v = place->second;
            }
    }
    const std::vector<Face> drawn = alone.faces;
    const ShellFaces shells = orientShells(alone);
    if (!shells.bad.empty() || shells.count != 1) return std::nullopt;
    ClosedPiece out;
    for (size_t f = 0; f < drawn.size(); ++f) {
        out.faces.push_back(drawn[f].surface);
        out.turned.push_back(drawn[f].loops != alone.faces[f].loops);
        const double area = 0.5 * glm::length(areaVector(alone.vertices, alone.faces[f].loops[0]));
        out.area += area;
        if (out.turned.back()) out.turnedArea += area;
    }
    const auto edges = facesOfEdges(alone);
    for (const auto& [edge, around] : edges)
        if (out.turned[around[0]] != out.turned[around[1]])
            out.seams += 1 / static_cast<double>(edges.size());
    out.triangles = trianglesOf(flatFacesOf(alone));
    if (out.triangles.empty()) return std::nullopt;
    out.looksIn = volumeWithin(out.triangles) >= 0;
    return out;
}

} // namespace

DisjointSets hangingTogether(const Building& welded, const std::function<uint32_t(uint32_t)>& place,
                             const std::function<bool(uint32_t)>& isOfBoard) {
    DisjointSets sets(welded.faces.size());
    auto edges = facesOfEdges(welded);
    for (const auto& [edge, around] : edges)
        if (around.size() == 2) sets.join(around[0], around[1]);
    for (auto& [edge, around] : edges) {
        if (around.size() <= 2) continue;
        std::map<uint32_t, size_t> ofBoards; // per root
        for (const uint32_t f : around)
            if (isOfBoard(f)) ++ofBoards[sets.root(f)];
        std::erase_if(around, [&](uint32_t f) { return isOfBoard(f) && ofBoards.at(sets.root(f)) > 1; });
        std::ranges::sort(around, {}, place);
        for (size_t k = 1; k < around.size(); k += 2) sets.join(around[k - 1], around[k]);
    }
    return sets;
}

std::vector<ClosedPiece> closedPieces(const Building& sheets) {
    DisjointSets sets = hangingTogether(
        sheets, [&](uint32_t f) { return sheets.faces[f].surface; }, [](uint32_t) { return false; });
    std::map<uint32_t, std::vector<uint32_t>> wholes;
    for (uint32_t f = 0; f < sheets.faces.size(); ++f) wholes[sets.root(f)].push_back(f);
    std::vector<ClosedPiece> out;
    for (const auto& [root, members] : wholes)
        if (auto piece = closedPiece(sheets, members)) out.push_back(std::move(*piece));
    return out;
}

} // namespace heliodon::geometry
