#include "geometry/drawn_once.h"

#include <algorithm>
#include <array>
#include <map>

#include <glm/geometric.hpp>

#include "geometry/outline_area.h"
#include "geometry/space_sheets.h"

namespace heliodon::geometry {

namespace {

std::vector<SoupFace> sameCornersOnce(const std::vector<SoupFace>& faces) {
    std::map<std::vector<std::array<double, 3>>, size_t> known;
    std::vector<SoupFace> out;
    for (const SoupFace& face : faces) {
        const auto [first, isNew] = known.try_emplace(sortedCorners(face), out.size());
        if (isNew)
            out.push_back(face);
        else if (glm::dot(areaVector(out[first->second].loops[0]), areaVector(face.loops[0])) < 0)
            out[first->second].behind = face.material;
    }
    return out;
}

} // namespace

std::vector<SoupFace> drawnOnce(const std::vector<SoupFace>& faces, double tolerance) {
    const std::vector<SoupFace> once = sameCornersOnce(faces);
    const std::vector<Sheet> pieces = cutIntoSheets(once, tolerance);
    std::vector<bool> isCut(once.size(), false);
    for (const Sheet& piece : pieces)
        if (piece.drawn[0].size() + piece.drawn[1].size() > 1)
            for (const auto& drawn : piece.drawn)
                for (const uint32_t k : drawn) isCut[k] = true;
    std::vector<double> area;
    for (const SoupFace& face : once) area.push_back(glm::length(areaVector(face.loops[0])));
    std::vector<SoupFace> out;
    for (uint32_t k = 0; k < once.size(); ++k)
        if (!isCut[k]) out.push_back(once[k]);
    for (const Sheet& piece : pieces) {
        const size_t turned = piece.drawn[0].empty() ? 1 : 0;
        const auto bySize = [&](uint32_t k) { return area[k]; };
        const auto &drawn = piece.drawn[turned], &others = piece.drawn[1 - turned];
        const uint32_t least = *std::ranges::min_element(drawn, {}, bySize);
        if (!isCut[least]) continue;
        out.push_back(pieceOf(once[least], piece, turned));
        if (!others.empty())
            out.back().behind = once[*std::ranges::min_element(others, {}, bySize)].material;
        else if (drawn.size() > 1)
            out.back().behind = once[*std::ranges::max_element(drawn, {}, bySize)].material;
    }
    return out;
}

} // namespace heliodon::geometry
