#include "geometry/shell_faces.h"

#include <algorithm>
#include <set>

#include <glm/geometric.hpp>

#include "geometry/disjoint_sets.h"
#include "geometry/outline_area.h"

namespace heliodon::geometry {

namespace {

// Each edge of each face in the face's direction.
std::set<std::pair<uint32_t, Edge>> runsOf(const Building& building) {
    std::set<std::pair<uint32_t, Edge>> runs;
    for (uint32_t f = 0; f < building.faces.size(); ++f)
        for (const auto& loop : building.faces[f].loops)
            for (size_t i = 0; i < loop.size(); ++i) runs.insert({f, {loop[i], loop[(i + 1) % loop.size()]}});
    return runs;
}

ShellFaces refused(std::vector<uint32_t> faces, std::string what) {
    ShellFaces out;
    out.bad = std::move(faces);
    out.what = std::move(what);
    return out;
}

// Faces with an open edge. Where other parts of the model are closed, it is not a hole in these that is
// meant.
ShellFaces openFaces(const Building& building, const std::map<Edge, std::vector<uint32_t>>& edges) {
    DisjointSets parts(building.faces.size());
    for (const auto& [edge, faces] : edges)
        for (const uint32_t f : faces) parts.join(faces[0], f);
    std::vector<uint32_t> open;
    std::set<uint32_t> openParts, allParts;
    for (const auto& [edge, faces] : edges)
        if (faces.size() == 1) {
            open.push_back(faces[0]);
            openParts.insert(parts.root(faces[0]));
        }
    if (open.empty()) return {};
    for (uint32_t f = 0; f < building.faces.size(); ++f) allParts.insert(parts.root(f));
    if (openParts.size() == allParts.size())
        return refused(open, "the model is not closed: an edge of this face has no neighbour");
    return refused(open, "the model is not closed: this face is of a part that encloses nothing, as a sheet "
                         "without thickness (others are closed)");
}

} // namespace

std::map<Edge, std::vector<uint32_t>> facesOfEdges(const Building& building) {
    std::map<Edge, std::vector<uint32_t>> out;
    for (uint32_t f = 0; f < building.faces.size(); ++f)
        for (const auto& loop : building.faces[f].loops)
            for (size_t i = 0; i < loop.size(); ++i)
                out[std::minmax(loop[i], loop[(i + 1) % loop.size()])].push_back(f);
    return out;
}

ShellFaces orientShells(Building& building) {
    const auto edges = facesOfEdges(building);
    if (ShellFaces open = openFaces(building, edges); !open.bad.empty()) return open;
    std::vector<uint32_t> crowded;
    for (const auto& [edge, faces] : edges)
        if (faces.size() > 2) crowded.insert(crowded.end(), faces.begin(), faces.end());
    if (!crowded.empty()) return refused(crowded, "more than two faces meet in an edge of this face");
    ShellFaces out;
    out.shell.assign(building.faces.size(), 0);
    const auto runs = runsOf(building);
    std::vector<int> turned(building.faces.size(), -1);
    for (uint32_t start = 0; start < building.faces.size(); ++start) {
        if (turned[start] >= 0) continue;
        std::vector<uint32_t> queue{start};
        turned[start] = 0;
        double asIs = 0, over = 0;
        for (size_t q = 0; q < queue.size(); ++q) {
            const uint32_t f = queue[q];
            out.shell[f] = out.count;
            (turned[f] ? over : asIs) +=
                glm::length(areaVector(building.vertices, building.faces[f].loops[0]));
            for (const auto& loop : building.faces[f].loops)
                for (size_t i = 0; i < loop.size(); ++i) {
                    const Edge edge{loop[i], loop[(i + 1) % loop.size()]};
                    const auto& pair = edges.at(std::minmax(edge.first, edge.second));
                    const uint32_t g = pair[0] == f ? pair[1] : pair[0];
                    const int wanted = turned[f] ^ static_cast<int>(runs.contains({g, edge}));
                    if (turned[g] < 0) {
                        turned[g] = wanted;
                        queue.push_back(g);
                    } else if (turned[g] != wanted)
                        return refused({f, g}, "the shell has only one side, like a Moebius strip");
                }
        }
        for (const uint32_t f : queue)
            if ((turned[f] == 1) == (over <= asIs)) {
                turnOver(building.faces[f]);
                ++out.turnedOver;
            }
        ++out.count;
    }
    return out;
}

} // namespace heliodon::geometry
