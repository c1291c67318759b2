#include "geometry/face_soup.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>

#include <glm/geometric.hpp>

#include "geometry/box_tree.h"
#include "geometry/mesh_domains.h"
#include "geometry/twin_faces.h"

namespace heliodon::geometry {

namespace {

// Finds or adds points by a grid of cells of the tolerance's size. Rooms never share corners.
class Welder {
public:
    Welder(std::vector<glm::dvec3>& points, double tolerance) : points_(points), tolerance_(tolerance) {}

    uint32_t index(glm::dvec3 p, uint32_t room) {
        constexpr double kReach = 0.51; // of a cell: some more than the tolerance
        const glm::dvec3 at = p / (2 * tolerance_), low = glm::floor(at - kReach),
                         high = glm::floor(at + kReach);
        for (double x = low.x; x <= high.x; ++x)
            for (double y = low.y; y <= high.y; ++y)
                for (double z = low.z; z <= high.z; ++z) {
                    const auto [first, last] = cells_.equal_range(key({x, y, z}, room));
                    for (auto it = first; it != last; ++it)
                        if (rooms_[it->second] == room && glm::length(points_[it->second] - p) <= tolerance_)
                            return it->second;
                }
        const auto id = static_cast<uint32_t>(points_.size());
        points_.push_back(p);
        rooms_.push_back(room);
        cells_.emplace(key(glm::floor(at), room), id);
        return id;
    }

private:
    static uint64_t key(glm::dvec3 cell, uint32_t room) {
        uint64_t hash = room;
        for (int c = 0; c < 3; ++c) {
            hash ^= static_cast<uint64_t>(static_cast<int64_t>(cell[c]));
            hash *= 0x9E3779B97F4A7C15ull;
            hash ^= hash >> 29;
        }
        return hash;
    }

    std::vector<glm::dvec3>& points_;
    std::vector<uint32_t> rooms_;
    double tolerance_;
    std::unordered_multimap<uint64_t, uint32_t> cells_;
};

void dropRepeats(std::vector<uint32_t>& loop) {
    for (bool changed = true; changed && loop.size() >= 3;) {
        changed = false;
        for (size_t i = 0; i < loop.size(); ++i) {
            const size_t n = loop.size();
            if (loop[i] == loop[(i + 1) % n])
                loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(i));
            else if (loop[i] == loop[(i + 2) % n]) { // out and back
                const size_t spike = (i + 1) % n;
                loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(spike));
                loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(spike < i ? i - 1 : i));
            } else
                continue;
            changed = true;
            break;
        }
    }
}

using Edge = std::pair<uint32_t, uint32_t>;

class EdgeSplitter {
public:
    EdgeSplitter(Building& building, double tolerance, bool all = false)
        : building_(building), tolerance_(tolerance), all_(all) {}

    // Splitting may bring further corners within reach of a new edge; two or three rounds settle it.
    void split() {
        for (int round = 0; round < 8; ++round) {
            findLoose();
            if (loose_.empty() || !splitOnce()) return;
        }
    }

private:
    void findLoose() {
        all_ ? findUnknown() : findWithoutOpposite();
        std::ranges::sort(corners_);
        corners_.erase(std::unique(corners_.begin(), corners_.end()), corners_.end());
    }

    // All edges but those that are known to have no corner on them: no corner is added to the others.
    void findUnknown() {
        std::vector<Edge> edges;
        corners_.clear();
        for (const Face& face : building_.faces)
            for (const auto& loop : face.loops)
                for (size_t i = 0; i < loop.size(); ++i) {
                    edges.emplace_back(loop[i], loop[(i + 1) % loop.size()]);
                    corners_.push_back(loop[i]);
                }
        std::ranges::sort(edges);
        edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
        std::vector<Edge> known;
        for (const auto& [edge, inner] : loose_)
            if (inner.empty()) known.push_back(edge);
        std::vector<Edge> whole;
        std::ranges::set_union(whole_, known, std::back_inserter(whole));
        whole_ = std::move(whole);
        loose_.clear();
        for (const Edge& edge : edges)
            if (!std::ranges::binary_search(whole_, edge))
                loose_.emplace_hint(loose_.end(), edge, std::vector<uint32_t>());
    }

    void findWithoutOpposite() {
        std::vector<Edge> edges; // each as often as it is run along
        for (const Face& face : building_.faces)
            for (const auto& loop : face.loops)
                for (size_t i = 0; i < loop.size(); ++i)
                    edges.emplace_back(loop[i], loop[(i + 1) % loop.size()]);
        std::ranges::sort(edges);
        loose_.clear();
        corners_.clear();
        const auto times = [&](const Edge& edge) { return std::ranges::equal_range(edges, edge).size(); };
        for (size_t k = 0; k < edges.size(); ++k) {
            const Edge edge = edges[k];
            if (k > 0 && edges[k - 1] == edge) continue;
            if (times(edge) == times({edge.second, edge.first})) continue;
            loose_.emplace_hint(loose_.end(), edge, std::vector<uint32_t>());
            corners_.push_back(edge.first);
            corners_.push_back(edge.second);
        }
    }

    bool splitOnce() {
        bool any = false;
        const glm::dvec3 margin(2 * tolerance_);
        std::vector<Bounds> places;
        for (const uint32_t v : corners_)
            places.push_back({building_.vertices[v] - margin, building_.vertices[v] + margin});
        const BoxTree near(places);
        for (auto& [edge, inner] : loose_) {
            const glm::dvec3 a = building_.vertices[edge.first], b = building_.vertices[edge.second];
            const double length = glm::length(b - a);
            const glm::dvec3 direction = (b - a) / length;
            std::vector<std::pair<double, uint32_t>> found;
            near.anyAlong(a, b - a, 1, [&](uint32_t i) {
                const uint32_t v = corners_[i];
                const glm::dvec3 p = building_.vertices[v];
                const double t = glm::dot(p - a, direction);
                if (v != edge.first && v != edge.second && t > 0 && t < length &&
                    roomOf(v) == roomOf(edge.first) && glm::length(p - a - t * direction) <= tolerance_)
                    found.emplace_back(t, v);
                return false; // look at all
            });
            std::ranges::sort(found);
            for (const auto& [t, v] : found) inner.push_back(v);
            any = any || !inner.empty();
        }
        if (!any) return false;
        for (Face& face : building_.faces)
            for (auto& loop : face.loops) {
                std::vector<uint32_t> longer;
                for (size_t i = 0; i < loop.size(); ++i) {
                    longer.push_back(loop[i]);
                    const auto found = loose_.find({loop[i], loop[(i + 1) % loop.size()]});
                    if (found != loose_.end())
                        longer.insert(longer.end(), found->second.begin(), found->second.end());
                }
                if (longer.size() > loop.size()) loop = withoutSpikes(std::move(longer));
            }
        return true;
    }

    // A corner that is on two edges of a face, as these run on so near one another, ends it there.
    static std::vector<uint32_t> withoutSpikes(std::vector<uint32_t> loop) {
        std::vector<uint32_t> out = loop;
        dropRepeats(out);
        return out.size() < 3 ? loop : out;
    }

    uint32_t roomOf(uint32_t vertex) {
        if (rooms_.empty()) {
            rooms_.resize(building_.vertices.size());
            for (const Face& face : building_.faces)
                for (const auto& loop : face.loops)
                    for (const uint32_t v : loop) rooms_[v] = face.room;
        }
        return rooms_[vertex];
    }

    Building& building_;
    double tolerance_;
    bool all_; // not only edges that lack an opposite
    std::map<Edge, std::vector<uint32_t>> loose_;
    std::vector<uint32_t> corners_, rooms_;
    std::vector<Edge> whole_; // of `all_`, no corner is on them; sorted
};

// An opening may show as several pieces, where others overlap it: those opposite one another are twins.
void pairTwins(Building& building, const std::map<int, std::vector<uint32_t>>& pieces) {
    for (const auto& [key, faces] : pieces)
        for (const uint32_t f : faces) {
            Face& face = building.faces[f];
            if (face.twin >= 0) continue;
            const glm::dvec3 n = faceNormal(building, face);
            double least = std::numeric_limits<double>::infinity();
            for (const uint32_t g : faces) {
                const Face& other = building.faces[g];
                if (other.twin >= 0 || glm::dot(n, faceNormal(building, other)) > -0.5) continue;
                const glm::dvec3 shift = shiftBetween(building, face, other);
                const double aside = glm::length(shift - glm::dot(shift, n) * n);
                if (aside >= least) continue;
                least = aside;
                face.twin = static_cast<int32_t>(g);
            }
            if (face.twin >= 0) building.faces[static_cast<size_t>(face.twin)].twin = static_cast<int32_t>(f);
        }
}

constexpr double kSameCorner = 0.006 * kMetresPerInch; // divisions of a wall are farther apart than that

// Adds the point to the edge of the face that it lies on, when it is no corner yet.
bool addCorner(Building& building, Face& face, glm::dvec3 p, double near) {
    for (const auto& loop : face.loops)
        for (const uint32_t v : loop)
            if (glm::length(building.vertices[v] - p) < kSameCorner) return false;
    for (auto& loop : face.loops)
        for (size_t i = 0; i < loop.size(); ++i) {
            const glm::dvec3 a = building.vertices[loop[i]],
                             d = building.vertices[loop[(i + 1) % loop.size()]] - a;
            const double t = glm::dot(p - a, d) / glm::dot(d, d);
            if (t <= 0 || t >= 1 || glm::length(p - a - t * d) > near) continue;
            building.vertices.push_back(a + t * d);
            loop.insert(loop.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                        static_cast<uint32_t>(building.vertices.size() - 1));
            return true;
        }
    return false;
}

// The two glasses of a window have equal corners on their outlines: what a neighbour's corner adds to one is
// added to the other. True when anything was.
bool shareTwinCorners(Building& building, double tolerance) {
    // Far more than rounding may put between the two sides, far less than an edge is long.
    const double near = 100 * tolerance;
    bool any = false;
    for (Face& face : building.faces) {
        if (face.twin < 0) continue;
        const Face& other = building.faces[static_cast<size_t>(face.twin)];
        const glm::dvec3 shift = shiftBetween(building, other, face);
        for (const auto& loop : other.loops)
            for (const uint32_t v : loop)
                any |= addCorner(building, face, building.vertices[v] + shift, near);
    }
    return any;
}

// Face::surface: its place among those given.
Building weldAnew(const std::vector<SoupFace>& soup, uint32_t roomCount, double tolerance, bool sheets) {
    Building building;
    building.roomCount = roomCount;
    Welder welder(building.vertices, tolerance);
    std::map<int, std::vector<uint32_t>> pieces;
    for (const SoupFace& in : soup) {
        Face face;
        face.surface = static_cast<uint32_t>(&in - soup.data());
        face.room = in.room;
        for (size_t l = 0; l < in.loops.size(); ++l) {
            std::vector<uint32_t> loop;
            for (const glm::dvec3 p : in.loops[l]) loop.push_back(welder.index(p, in.room));
            dropRepeats(loop);
            if (loop.size() >= 3)
                face.loops.push_back(std::move(loop));
            else if (l == 0)
                break;
        }
        if (face.loops.empty()) continue;
        const auto id = static_cast<uint32_t>(building.faces.size());
        if (in.twinKey >= 0) pieces[in.twinKey].push_back(id);
        building.faces.push_back(std::move(face));
    }
    pairTwins(building, pieces);
    EdgeSplitter(building, tolerance, sheets).split();
    for (int round = 0; round < 4 && shareTwinCorners(building, tolerance); ++round)
        EdgeSplitter(building, tolerance).split();
    return building;
}

// Of all that says where corners and edges are.
std::vector<double> keyOf(const std::vector<SoupFace>& soup, uint32_t roomCount, double tolerance,
                          bool sheets) {
    std::vector<double> key{tolerance, static_cast<double>(roomCount), sheets ? 1.0 : 0.0};
    for (const SoupFace& face : soup) {
        key.insert(key.end(), {static_cast<double>(face.room), static_cast<double>(face.twinKey)});
        addOutline(key, face.loops);
    }
    return key;
}

} // namespace

std::vector<std::array<double, 3>> sortedCorners(const SoupFace& face) {
    std::vector<std::array<double, 3>> corners;
    for (const auto& loop : face.loops)
        for (const glm::dvec3 p : loop) corners.push_back({p.x, p.y, p.z});
    std::ranges::sort(corners);
    return corners;
}

Building weldFaces(const std::vector<SoupFace>& soup, uint32_t roomCount, double tolerance, bool sheets) {
    const auto weld = [&] { return weldAnew(soup, roomCount, tolerance, sheets); };
    Building out = WeldMemory::get([&] { return keyOf(soup, roomCount, tolerance, sheets); }, weld);
    for (Face& face : out.faces) {
        const SoupFace& in = soup[face.surface];
        face.material = in.material;
        face.role = in.role;
        face.surface = in.surface;
    }
    return out;
}

Building weldedByNumber(std::vector<SoupFace> faces, double tolerance) {
    for (uint32_t k = 0; k < faces.size(); ++k) faces[k].surface = k;
    return weldFaces(faces, 1, tolerance, true);
}

} // namespace heliodon::geometry
