#include "geometry/open_sheets.h"

#include <algorithm>

#include "geometry/shell_faces.h"
#include "geometry/space_sheets.h"

namespace heliodon::geometry {

namespace {

// Of each welded sheet whether it goes.
std::vector<bool> hangingFaces(const Building& welded) {
    const auto edges = facesOfEdges(welded);
    std::map<Edge, size_t> left;
    for (const auto& [edge, faces] : edges) left[edge] = faces.size();
    std::vector<bool> gone(welded.faces.size(), false);
    std::vector<uint32_t> next;
    const auto take = [&](const Edge& edge) {
        for (const uint32_t f : edges.at(edge))
            if (!gone[f]) {
                gone[f] = true;
                next.push_back(f);
            }
    };
    for (const auto& [edge, count] : left)
        if (count == 1) take(edge);
    while (!next.empty()) {
        const Face& face = welded.faces[next.back()];
        next.pop_back();
        for (const auto& loop : face.loops)
            for (size_t k = 0; k < loop.size(); ++k) {
                const Edge edge = std::minmax(loop[k], loop[(k + 1) % loop.size()]);
                if (--left[edge] == 1) take(edge);
            }
    }
    return gone;
}

} // namespace

std::optional<OpenSheets> openSheets(const std::vector<SoupFace>& faces,
                                     const std::function<bool(uint32_t)>& isGlass, double tolerance) {
    const std::vector<Sheet> sheets = cutIntoSheets(faces, tolerance);
    const Building welded = weldSheets(sheets, tolerance);
    const std::vector<bool> hangs = hangingFaces(welded);
    std::vector<bool> stays(sheets.size(), false);
    for (uint32_t f = 0; f < welded.faces.size(); ++f) stays[welded.faces[f].surface] = !hangs[f];
    std::vector<bool> isCut(faces.size(), false); // goes in part or as a whole
    for (size_t s = 0; s < sheets.size(); ++s)
        for (const auto& drawn : sheets[s].drawn)
            for (const uint32_t k : drawn) {
                if (stays[s]) continue;
                if (isGlass(faces[k].material)) return std::nullopt;
                isCut[k] = true;
            }
    OpenSheets out;
    for (size_t s = 0; s < sheets.size(); ++s) {
        const auto& drawn = sheets[s].drawn;
        const auto isWhole = [&](uint32_t k) { return !isCut[k]; };
        if (stays[s] && (std::ranges::any_of(drawn[0], isWhole) || std::ranges::any_of(drawn[1], isWhole)))
            continue;
        if (!stays[s]) { // once, from however many sides it is drawn
            const size_t turned = drawn[0].empty() ? 1 : 0;
            const auto& other = drawn[drawn[1 - turned].empty() ? turned : 1 - turned];
            out.open.push_back(pieceOf(faces[drawn[turned][0]], sheets[s], turned));
            out.open.back().behind = faces[other[0]].material;
            continue;
        }
        for (const size_t turned : {0u, 1u})
            for (const uint32_t k : drawn[turned]) out.closed.push_back(pieceOf(faces[k], sheets[s], turned));
    }
    for (size_t k = 0; k < faces.size(); ++k)
        if (!isCut[k]) out.closed.push_back(faces[k]);
    if (out.open.empty() || out.closed.empty()) return std::nullopt;
    return out;
}

} // namespace heliodon::geometry
