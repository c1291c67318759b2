#include "geometry/touching_outline.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <glm/geometric.hpp>

#include "geometry/face_soup.h"

namespace heliodon::geometry {

namespace {

using Edge = std::pair<uint32_t, uint32_t>;

// The border of triangles that hang together, as directed edges.
using Border = std::set<Edge>;

// Without the edges that they share; none where that visits a corner twice.
std::optional<Border> united(const Border& one, const Border& other) {
    Border out;
    for (const Border* own : {&one, &other})
        for (const Edge& edge : *own)
            if (!(own == &one ? other : one).contains({edge.second, edge.first})) out.insert(edge);
    std::set<uint32_t> starts;
    for (const Edge& edge : out)
        if (!starts.insert(edge.first).second) return std::nullopt;
    return out;
}

FaceLoops loopsOf(const Border& border) {
    std::map<uint32_t, uint32_t> after(border.begin(), border.end());
    FaceLoops loops;
    while (!after.empty()) {
        std::vector<uint32_t>& loop = loops.emplace_back();
        for (auto at = after.begin(); at != after.end(); at = after.find(loop.back())) {
            loop.push_back(at->second);
            after.erase(at);
        }
    }
    return loops;
}

} // namespace

std::vector<FaceLoops> partsOfTouching(const Building& building, const Face& face,
                                       const std::function<bool(const FaceLoops&)>& isWhole) {
    std::vector<Border> parts;
    std::map<Edge, size_t> partOf;
    for (const auto& t : triangulateFace(building, face)) {
        Border& border = parts.emplace_back();
        for (size_t k = 0; k < 3; ++k) {
            border.insert({t[k], t[(k + 1) % 3]});
            partOf[{t[k], t[(k + 1) % 3]}] = parts.size() - 1;
        }
    }
    std::vector<Edge> inner;
    for (const auto& [edge, part] : partOf)
        if (edge.first < edge.second && partOf.contains({edge.second, edge.first})) inner.push_back(edge);
    // What is divided in the end is so along short edges.
    const auto length = [&](const Edge& edge) {
        return glm::length(building.vertices[edge.second] - building.vertices[edge.first]);
    };
    std::ranges::stable_sort(inner, [&](const Edge& a, const Edge& b) { return length(a) > length(b); });
    for (const Edge& edge : inner) {
        const size_t kept = partOf.at(edge), gone = partOf.at({edge.second, edge.first});
        if (kept == gone) continue;
        auto whole = united(parts[kept], parts[gone]);
        if (!whole || !isWhole(loopsOf(*whole))) continue;
        for (auto& [side, part] : partOf)
            if (part == gone) part = kept;
        parts[kept] = std::move(*whole);
        parts[gone].clear();
    }
    std::vector<FaceLoops> out;
    for (const Border& part : parts)
        if (!part.empty()) out.push_back(loopsOf(part));
    return out;
}

} // namespace heliodon::geometry
