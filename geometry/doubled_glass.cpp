#include "geometry/doubled_glass.h"

#include <algorithm>
#include <map>
#include <set>

#include "geometry/disjoint_sets.h"
#include "geometry/shell_faces.h"

namespace heliodon::geometry {

size_t dropDoubledGlass(std::vector<SoupFace>& faces, const std::function<bool(uint32_t)>& isGlass,
                        double tolerance) {
    std::vector<SoupFace> glass;
    std::vector<size_t> place; // of each among all faces
    for (size_t f = 0; f < faces.size(); ++f)
        if (isGlass(faces[f].material)) glass.push_back(faces[f]), place.push_back(f);
    const Building welded = weldedByNumber(glass, tolerance);
    DisjointSets bodies(welded.faces.size());
    for (const auto& [edge, around] : facesOfEdges(welded))
        for (const uint32_t f : around) bodies.join(f, around[0]);
    std::map<std::vector<uint32_t>, std::vector<uint32_t>> alike; // by corners
    for (uint32_t f = 0; f < welded.faces.size(); ++f) {
        std::vector<uint32_t> corners;
        for (const auto& loop : welded.faces[f].loops)
            corners.insert(corners.end(), loop.begin(), loop.end());
        std::ranges::sort(corners);
        alike[corners].push_back(f);
    }
    std::set<uint32_t> single; // bodies with a face that is there once
    for (const auto& [corners, copies] : alike)
        if (copies.size() != 2) single.insert(bodies.root(copies[0]));
    std::vector<bool> gone(faces.size(), false);
    for (const auto& [corners, copies] : alike)
        if (!single.contains(bodies.root(copies[0]))) gone[place[welded.faces[copies[1]].surface]] = true;
    const size_t before = faces.size();
    size_t kept = 0;
    for (size_t f = 0; f < before; ++f)
        if (!gone[f]) std::swap(faces[kept++], faces[f]);
    faces.resize(kept);
    return before - kept;
}

} // namespace heliodon::geometry
