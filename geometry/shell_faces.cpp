#include "geometry/shell_faces.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/bounds.h"
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

// Edges that have one face alone and hang together, and that face of each.
struct OpenBorder {
    std::vector<Edge> edges;
    std::vector<uint32_t> faces;
};

// By their first faces.
std::vector<OpenBorder> openBorders(const Building& building,
                                    const std::map<Edge, std::vector<uint32_t>>& edges) {
    DisjointSets corners(building.vertices.size());
    for (const auto& [edge, faces] : edges)
        if (faces.size() == 1) corners.join(edge.first, edge.second);
    std::map<uint32_t, OpenBorder> borders;
    for (const auto& [edge, faces] : edges)
        if (faces.size() == 1) {
            OpenBorder& border = borders[corners.root(edge.first)];
            border.edges.push_back(edge);
            border.faces.push_back(faces[0]);
        }
    std::vector<OpenBorder> out;
    for (auto& [corner, border] : borders) out.push_back(std::move(border));
    std::ranges::sort(out, {}, [](const OpenBorder& border) { return std::ranges::min(border.faces); });
    return out;
}

// Of what hangs together, whether what closes its open borders would be as large as all of it: a facade, two
// walls. Pieces that do not meet have such borders, too, and gaps between them.
bool isMostlyOpen(const Building& building, const std::vector<OpenBorder>& borders) {
    constexpr double kAsLarge = 0.9;
    double closing = 0, drawn = 0; // twice the areas
    for (const OpenBorder& border : borders) {
        glm::dvec3 sum(0);
        for (const auto& [a, b] : border.edges) sum += building.vertices[a] + building.vertices[b];
        const glm::dvec3 middle = sum / (2.0 * static_cast<double>(border.edges.size()));
        for (const auto& [a, b] : border.edges)
            closing += glm::length(glm::cross(building.vertices[a] - middle, building.vertices[b] - middle));
    }
    for (const Face& face : building.faces) {
        glm::dvec3 area(0);
        for (const auto& loop : face.loops) area += areaVector(building.vertices, loop);
        drawn += glm::length(area);
    }
    return closing >= kAsLarge * drawn;
}

// No two faces meet but in one plane: single walls, or such as do not touch.
bool isFlatPieces(const Building& building, const std::map<Edge, std::vector<uint32_t>>& edges) {
    constexpr double kParallel = 1e-4; // sine
    const auto area = [&](uint32_t f) { return areaVector(building.vertices, building.faces[f].loops[0]); };
    return std::ranges::all_of(edges, [&](const auto& entry) {
        const glm::dvec3 first = area(entry.second[0]);
        return std::ranges::all_of(entry.second, [&](uint32_t f) {
            return glm::length(glm::cross(first, area(f))) <=
                   kParallel * glm::length(first) * glm::length(area(f));
        });
    });
}

std::vector<glm::dvec3> endsOf(const Building& building, const OpenBorder& border) {
    std::vector<glm::dvec3> ends;
    for (const auto& [a, b] : border.edges)
        ends.insert(ends.end(), {building.vertices[a], building.vertices[b]});
    return ends;
}

// That of most extent of the part of most area, of those that have any.
const OpenBorder& borderOfLargest(const Building& building, const std::vector<OpenBorder>& borders,
                                  DisjointSets& parts) {
    std::map<uint32_t, double> area;
    for (uint32_t f = 0; f < building.faces.size(); ++f)
        area[parts.root(f)] += glm::length(areaVector(building.vertices, building.faces[f].loops[0]));
    return *std::ranges::max_element(borders, {}, [&](const OpenBorder& border) {
        return std::pair(area.at(parts.root(border.faces[0])), boundsOf(endsOf(building, border)).diagonal());
    });
}

// Faces along the first open border. Where other parts of the model are closed, all such faces: it is not a
// hole in these that is meant.
ShellFaces openFaces(const Building& building, const std::map<Edge, std::vector<uint32_t>>& edges) {
    const auto borders = openBorders(building, edges);
    if (borders.empty()) return {};
    DisjointSets parts(building.faces.size());
    for (const auto& [edge, faces] : edges)
        for (const uint32_t f : faces) parts.join(faces[0], f);
    std::set<uint32_t> openParts, allParts, open;
    for (const OpenBorder& border : borders) open.insert(border.faces.begin(), border.faces.end());
    for (const uint32_t f : open) openParts.insert(parts.root(f));
    for (uint32_t f = 0; f < building.faces.size(); ++f) allParts.insert(parts.root(f));
    if (openParts.size() < allParts.size()) {
        ShellFaces out = refused({open.begin(), open.end()},
                                 "the model is not closed: this face is of a part that encloses nothing, as "
                                 "a sheet without thickness (others are closed)");
        const OpenBorder& border = borderOfLargest(building, borders, parts);
        std::ranges::rotate(out.bad, std::ranges::find(out.bad, std::ranges::min(border.faces)));
        out.border = endsOf(building, border);
        return out;
    }
    std::string what = "the model is not closed: an edge of this face has no neighbour";
    if (borders.size() > 1) what += fmt::format(", on the first of {} open borders", borders.size());
    const auto isOfFirst = [&](uint32_t f) {
        return building.faces[f].surface == building.faces[*open.begin()].surface;
    };
    const bool isHole = !std::ranges::all_of(open, isOfFirst);
    if (isHole && allParts.size() == 1 && isMostlyOpen(building, borders))
        return refused({open.begin(), open.end()},
                       "encloses no room: these faces are open sheets, as of a facade alone, and what would "
                       "close them (floor, ceiling, other walls) is as large as all that is drawn");
    if (isFlatPieces(building, edges))
        return refused(
            {open.begin(), open.end()},
            "the model is not closed: no two of these faces meet but in one plane (walls, floor and ceiling "
            "end short of one another, or are not drawn)");
    if (isHole) what += ": close the hole, or draw its door or glass";
    ShellFaces out = refused(borders[0].faces, std::move(what));
    std::ranges::sort(out.bad);
    if (!isHole) return out;
    out.border = endsOf(building, borders[0]);
    out.isHole = true;
    return out;
}

} // namespace

std::map<Edge, std::vector<uint32_t>> facesOfEdges(const Building& building) {
    std::vector<std::pair<Edge, uint32_t>> all;
    for (uint32_t f = 0; f < building.faces.size(); ++f)
        for (const auto& loop : building.faces[f].loops)
            for (size_t i = 0; i < loop.size(); ++i)
                all.emplace_back(std::minmax(loop[i], loop[(i + 1) % loop.size()]), f);
    std::ranges::sort(all); // far sooner than the map would
    std::map<Edge, std::vector<uint32_t>> out;
    for (const auto& [edge, f] : all) out.try_emplace(out.end(), edge)->second.push_back(f);
    return out;
}

ShellFaces orientShells(Building& building) {
    const auto edges = facesOfEdges(building);
    if (ShellFaces open = openFaces(building, edges); !open.bad.empty()) {
        open.isOpen = true;
        return open;
    }
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
