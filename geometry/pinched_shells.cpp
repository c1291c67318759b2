#include "geometry/pinched_shells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "geometry/box_tree.h"
#include "geometry/disjoint_sets.h"
#include "geometry/face_soup.h"
#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"
#include "geometry/ray_triangle.h"
#include "geometry/shell_faces.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr std::array kAway{0.5, 0.2, 0.05}; // cosines between a way off faces and their normals
constexpr int kRounds = 200;

// The way that all normals, of length one, agree with; none where there is none.
std::optional<dvec3> wayAlong(const std::vector<dvec3>& normals) {
    for (const double least : kAway) {
        dvec3 way(0);
        for (int round = 0; round < kRounds; ++round) { // Rosenblatt's perceptron
            const dvec3 worst =
                *std::ranges::min_element(normals, {}, [&](dvec3 n) { return glm::dot(n, way); });
            if (const double length = glm::length(way); length > 0 && glm::dot(worst, way) > least * length)
                return way / length;
            way += worst;
        }
    }
    return std::nullopt;
}

bool isOver(dvec3 p, const ShellTriangle& t, double reach) {
    const dvec3 n = glm::normalize(glm::cross(t.b - t.a, t.c - t.a));
    if (std::abs(glm::dot(p - t.a, n)) > reach) return false;
    for (const auto& [q, r] : {std::pair(t.a, t.b), {t.b, t.c}, {t.c, t.a}})
        if (glm::dot(glm::cross(n, r - q), p - q) < 0) return false;
    return true;
}

std::map<uint32_t, std::set<uint32_t>> facesOfVertices(const Building& building) {
    std::map<uint32_t, std::set<uint32_t>> out;
    for (uint32_t f = 0; f < building.faces.size(); ++f)
        for (const auto& loop : building.faces[f].loops)
            for (const uint32_t v : loop) out[v].insert(f);
    return out;
}

// Where an edge of others runs into a face from a corner of that, as of a cupboard that stands on the floor
// with an edge at the wall, the face's outline runs there and back.
void addSeams(Building& building, double reach) {
    const auto facesAt = facesOfVertices(building);
    std::set<std::pair<uint32_t, uint32_t>> edges; // either way
    for (const Face& face : building.faces)
        for (const auto& loop : face.loops)
            for (size_t i = 0; i < loop.size(); ++i) {
                const uint32_t a = loop[i], b = loop[(i + 1) % loop.size()];
                edges.emplace(a, b), edges.emplace(b, a);
            }
    for (const auto& [v, end] : edges)
        for (const uint32_t f : facesAt.at(v)) {
            Face& face = building.faces[f];
            const dvec3 p = building.vertices[end], origin = building.vertices[v];
            const dvec3 normal = glm::normalize(areaVector(building.vertices, face.loops[0]));
            if (facesAt.at(end).contains(f) || std::abs(glm::dot(p - origin, normal)) > reach) continue;
            const auto triangles = triangulateFace(building, face);
            if (std::ranges::none_of(triangles, [&](const auto& t) {
                    const auto& all = building.vertices;
                    return isOver(p, {all[t[0]], all[t[1]], all[t[2]]}, reach);
                }))
                continue;
            for (auto& loop : face.loops) {
                const auto at = std::ranges::find(loop, v);
                if (at == loop.end()) continue;
                loop.insert(at + 1, {end, v});
                break;
            }
        }
}

class PinchOpener {
public:
    PinchOpener(Building& building, double by, double reach) : building_(building), by_(by), reach_(reach) {
        for (uint32_t f = 0; f < building.faces.size(); ++f) {
            normals_.push_back(glm::normalize(areaVector(building.vertices, building.faces[f].loops[0])));
            for (uint32_t l = 0; l < building.faces[f].loops.size(); ++l) {
                const auto& loop = building.faces[f].loops[l];
                const auto first = static_cast<uint32_t>(corners_.size()),
                           n = static_cast<uint32_t>(loop.size());
                for (uint32_t i = 0; i < n; ++i) corners_.push_back({f, l, i, loop[i], first + (i + 1) % n});
            }
        }
        fans_ = DisjointSets(corners_.size());
        onCrowded_.assign(corners_.size(), false);
    }

    bool open() {
        pairFaces();
        const bool parted = partFans();
        const bool bent = bendEdges();
        return liftOffFaces() || parted || bent;
    }

private:
    struct Corner {
        uint32_t face, loop, place, vertex;
        uint32_t next; // of its loop
    };
    using Pair = std::pair<uint32_t, uint32_t>; // of corners at which edges to one another's vertex begin

    uint32_t& vertexOf(uint32_t corner) {
        const Corner& c = corners_[corner];
        return building_.faces[c.face].loops[c.loop][c.place];
    }

    // Of the faces at an edge each with that beyond the air before it.
    std::vector<Pair> pairsRound(const Edge& edge, std::vector<uint32_t> begins) const {
        const dvec3 axis = glm::normalize(building_.vertices[edge.second] - building_.vertices[edge.first]),
                    x = perpendicular(axis), y = glm::cross(axis, x);
        const auto isAlong = [&](uint32_t c) { return corners_[c].vertex == edge.first; };
        const auto angle = [&](uint32_t c) {
            const dvec3 inwards = (isAlong(c) ? 1.0 : -1.0) * glm::cross(normals_[corners_[c].face], axis);
            return std::atan2(glm::dot(inwards, y), glm::dot(inwards, x));
        };
        std::ranges::sort(begins, {}, angle);
        std::vector<Pair> out;
        for (size_t k = 0; k < begins.size(); ++k) {
            const uint32_t one = begins[k], next = begins[(k + 1) % begins.size()];
            if (isAlong(one) == isAlong(next)) return {};
            if (isAlong(one)) out.emplace_back(one, next); // its air is ahead
        }
        return out;
    }

    void pairFaces() {
        std::map<Edge, std::vector<uint32_t>> edges; // corners where they begin, either way
        for (uint32_t c = 0; c < corners_.size(); ++c)
            edges[std::minmax(corners_[c].vertex, corners_[corners_[c].next].vertex)].push_back(c);
        for (const auto& [edge, begins] : edges) {
            const std::vector<Pair> pairs = pairsRound(edge, begins);
            for (const auto& [one, other] : pairs) {
                fans_.join(one, corners_[other].next);
                fans_.join(corners_[one].next, other);
                if (pairs.size() > 1)
                    for (const uint32_t c : {one, other, corners_[one].next, corners_[other].next})
                        onCrowded_[c] = true;
            }
            if (pairs.size() > 1) crowded_.push_back(pairs);
        }
    }

    // A way off all faces of a fan, into the air or the body, along planes of those normals.
    std::optional<dvec3> wayOff(const std::vector<uint32_t>& fan, bool intoAir,
                                const std::vector<dvec3>& planes = {}) const {
        const auto along = [&](dvec3 n) {
            if (planes.size() == 2) {
                const dvec3 line = glm::normalize(glm::cross(planes[0], planes[1]));
                return glm::dot(n, line) * line;
            }
            return planes.empty() ? n : n - glm::dot(n, planes[0]) * planes[0];
        };
        std::vector<dvec3> normals;
        for (const uint32_t c : fan)
            if (const dvec3 n = along((intoAir ? 1.0 : -1.0) * normals_[corners_[c].face]);
                glm::length(n) > kAway.back())
                normals.push_back(glm::normalize(n));
        return normals.empty() ? std::nullopt : wayAlong(normals);
    }

    // Of faces with a corner in another fan at the vertex, too: they stay flat.
    std::vector<dvec3> planesOf(const std::vector<uint32_t>& fan, std::map<uint32_t, uint32_t>& times) const {
        std::vector<dvec3> out;
        for (const uint32_t c : fan) {
            const dvec3 n = normals_[corners_[c].face];
            if (times[corners_[c].face] > 1 && std::ranges::none_of(out, [&](dvec3 other) {
                    return glm::length(glm::cross(n, other)) < kAway.back();
                }))
                out.push_back(n);
        }
        if (out.size() > 2) out.clear();
        return out;
    }

    // Vertices with several fans: all but the first gets its own.
    bool partFans() {
        std::map<uint32_t, std::map<uint32_t, std::vector<uint32_t>>> at; // by vertex and root
        for (uint32_t c = 0; c < corners_.size(); ++c) at[corners_[c].vertex][fans_.root(c)].push_back(c);
        bool any = false;
        for (const auto& [vertex, fans] : at) {
            if (fans.size() < 2) continue;
            std::map<uint32_t, uint32_t> times; // by face
            for (const auto& [root, fan] : fans)
                for (const uint32_t c : fan) ++times[corners_[c].face];
            bool isFirst = true;
            for (const auto& [root, fan] : fans) {
                if (std::exchange(isFirst, false)) continue;
                const bool intoAir = std::ranges::any_of(fan, [&](uint32_t c) { return onCrowded_[c]; });
                std::optional<dvec3> way = wayOff(fan, intoAir, planesOf(fan, times));
                if (!way) way = wayOff(fan, intoAir);
                if (!way) continue;
                const auto copy = static_cast<uint32_t>(building_.vertices.size());
                building_.vertices.push_back(building_.vertices[vertex] + by_ * *way);
                for (const uint32_t c : fan) vertexOf(c) = copy;
                any = true;
            }
        }
        return any;
    }

    // Edges that have still the same ends.
    bool bendEdges() {
        std::vector<std::pair<uint32_t, uint32_t>> put; // the corner that an edge begins at, its new corner
        for (const auto& pairs : crowded_) {
            std::set<std::pair<uint32_t, uint32_t>> known;
            for (const auto& [one, other] : pairs) {
                const uint32_t a = vertexOf(one), b = vertexOf(corners_[one].next);
                if (known.emplace(a, b).second) continue;
                const auto way = wayOff({one, other}, true);
                if (!way) continue;
                const auto middle = static_cast<uint32_t>(building_.vertices.size());
                building_.vertices.push_back(0.5 * (building_.vertices[a] + building_.vertices[b]) +
                                             by_ * *way);
                put.emplace_back(one, middle), put.emplace_back(other, middle);
            }
        }
        // Those that stand last in a loop first.
        std::ranges::sort(put, [](const auto& a, const auto& b) { return a.first > b.first; });
        for (const auto& [corner, vertex] : put) {
            const Corner& c = corners_[corner];
            auto& loop = building_.faces[c.face].loops[c.loop];
            loop.insert(loop.begin() + static_cast<std::ptrdiff_t>(c.place) + 1, vertex);
        }
        return !put.empty();
    }

    // Corners that lie on a face, not in its edges.
    bool liftOffFaces() {
        const auto facesAt = facesOfVertices(building_);
        std::vector<uint32_t> vertices;
        std::vector<Bounds> places;
        for (const auto& [v, faces] : facesAt) {
            vertices.push_back(v);
            places.push_back({building_.vertices[v], building_.vertices[v]});
        }
        const BoxTree tree(places);
        bool any = false;
        for (uint32_t f = 0; f < building_.faces.size(); ++f)
            for (const auto& t : triangulateFace(building_, building_.faces[f])) {
                const dvec3 a = building_.vertices[t[0]], b = building_.vertices[t[1]],
                            c = building_.vertices[t[2]];
                tree.anyHolding(glm::max(a, glm::max(b, c)) + reach_, glm::min(a, glm::min(b, c)) - reach_,
                                [&](uint32_t i) {
                                    const uint32_t v = vertices[i];
                                    const auto& own = facesAt.at(v);
                                    if (!own.contains(f) && roomOf(*own.begin()) == roomOf(f) &&
                                        isOver(building_.vertices[v], {a, b, c}, reach_))
                                        any |= lift(v, own, f, a);
                                    return false; // look at all
                                });
            }
        return any;
    }

    uint32_t roomOf(uint32_t face) const { return building_.faces[face].room; }

    bool lift(uint32_t v, const std::set<uint32_t>& faces, uint32_t off, dvec3 origin) {
        std::vector<dvec3> normals;
        for (const uint32_t f : faces) normals.push_back(-normals_[f]);
        normals.push_back(normals_[off]);
        const auto way = wayAlong(normals);
        if (!way) return false;
        dvec3& p = building_.vertices[v];
        const double height = glm::dot(p - origin, normals_[off]);
        if (height < by_) p += (by_ - height) / glm::dot(*way, normals_[off]) * *way;
        return true;
    }

    Building& building_;
    double by_, reach_;
    std::vector<dvec3> normals_; // of faces
    std::vector<Corner> corners_;
    DisjointSets fans_;                      // corners, by what they hang together with round their vertex
    std::vector<bool> onCrowded_;            // corners at edges of more than two faces
    std::vector<std::vector<Pair>> crowded_; // such edges
};

} // namespace

bool openPinches(Building& building, double by, double reach) {
    addSeams(building, reach);
    return PinchOpener(building, by, reach).open();
}

} // namespace heliodon::geometry
