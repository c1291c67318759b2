// Where the paper casts a ray from each centroid of a mesh cut along silhouettes, we keep the shadow of every
// convex solid on every plane as a polygon: it is both the line to cut along and, exactly, the test whether a
// piece is dark. Cuts meet the edges of the mesh in points that both neighbours share, so that no T-vertices
// arise.
#include "geometry/projector_visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>
#include <unordered_map>

#include <glm/geometric.hpp>

#include "geometry/cut_triangle.h"
#include "geometry/perpendicular.h"
#include "geometry/shadow_outline.h"

namespace heliodon::geometry {

namespace {

constexpr double kSkin =
    0.0025; // metres: outlines are straightened by up to 0.1 in against the walls behind them
constexpr double kOnEdge = 1e-6;  // metres: nearer to an edge is on it
constexpr double kSameCut = 2e-5; // of an edge's length: cuts nearer than this are one
constexpr double kNudge = 1e-7;   // metres

double cross(glm::dvec2 u, glm::dvec2 v) {
    return u.x * v.y - u.y * v.x;
}

// What one projector sees of a plane.
struct PlaneView {
    bool front = false;
    double height = 0; // of the projector over the plane
    double reach = 0;  // round the foot: beyond it n . d is too small
    glm::dvec2 foot{};
    std::vector<ConvexOutline> shadows;
    std::vector<std::pair<glm::dvec2, double>> borders; // inside where dot(first, p) > second
};

struct Plane {
    PlaneFrame frame;
    std::vector<PlaneView> views;
};

// A cut through a triangle: its ends in the plane, and the edge of the triangle that each lies on (-1:
// inside).
struct Cut {
    std::array<glm::dvec2, 2> end{};
    std::array<int, 2> edge{-1, -1};
};

struct Piece {
    std::array<glm::dvec2, 3> corner{};
    std::array<uint32_t, 3> vertex{};
    size_t patch = 0, plane = 0;
    std::vector<Cut> cuts;
};

// Clips the segment to the triangle; the edges that cut it are noted.
bool clipToTriangle(const std::array<glm::dvec2, 3>& corner, Cut& cut) {
    double from = 0, to = 1;
    int fromEdge = -1, toEdge = -1;
    const glm::dvec2 a = cut.end[0], d = cut.end[1] - cut.end[0];
    for (int k = 0; k < 3; ++k) {
        const glm::dvec2 p = corner[static_cast<size_t>(k)], e = corner[static_cast<size_t>((k + 1) % 3)] - p;
        const double size = glm::length(e), start = cross(e, a - p) / size, slope = cross(e, d) / size;
        if (std::abs(slope) < 1e-15) {
            if (start <= kOnEdge) return false;
            continue;
        }
        const double t = -start / slope;
        if (slope > 0 && t > from) {
            from = t;
            fromEdge = k;
        } else if (slope < 0 && t < to) {
            to = t;
            toEdge = k;
        }
    }
    if ((to - from) * glm::length(d) < kOnEdge) return false;
    cut.end = {a + from * d, a + to * d};
    cut.edge = {fromEdge, toEdge};
    for (size_t end = 0; end < 2; ++end)
        for (int k = 0; k < 3 && cut.edge[end] < 0; ++k) {
            const glm::dvec2 p = corner[static_cast<size_t>(k)],
                             e = corner[static_cast<size_t>((k + 1) % 3)] - p;
            if (cross(e, cut.end[end] - p) < kOnEdge * glm::length(e)) cut.edge[end] = k;
        }
    return cut.edge[0] < 0 || cut.edge[0] != cut.edge[1];
}

class VisibilitySplitter {
public:
    VisibilitySplitter(const PatchMesh& mesh, const Occluders& occluders,
                       std::span<const OpticalDevice> projectors, const ProjectorOptions& options)
        : mesh_(mesh), projectors_(projectors), options_(options), solids_(convexSolids(occluders)) {
        for (const OpticalDevice& device : projectors) borders_.push_back(pictureBorders(device));
        out_.projectorCount = projectors.size();
    }

    ProjectorMesh split() {
        collectPieces();
        for (Piece& piece : pieces_) findCuts(piece);
        for (const Piece& piece : pieces_) shareCuts(piece);
        for (auto& [edge, cuts] : edgeCuts_) tidy(cuts);
        for (const Piece& piece : pieces_) buildPiece(piece);
        blend();
        measureReach();
        return std::move(out_);
    }

private:
    void collectPieces() {
        std::map<std::tuple<uint32_t, long long, long long, long long, long long>, size_t> planes;
        for (size_t i = 0; i < mesh_.patchCount(); ++i) {
            if (mesh_.role[i] != Role::projection) continue;
            const glm::dvec3 n = patchNormal(mesh_, i), p = mesh_.vertices[mesh_.patch(i)[0]];
            const auto [place, isNew] =
                planes.try_emplace({mesh_.surface[i], std::llround(n.x * 1e7), std::llround(n.y * 1e7),
                                    std::llround(n.z * 1e7), std::llround(glm::dot(n, p) * 1e7)},
                                   planes_.size());
            if (isNew) planes_.push_back(viewPlane(n, p));
            const auto corner = mesh_.patch(i);
            for (size_t k = 1; k + 1 < corner.size(); ++k) {
                Piece piece;
                piece.vertex = {corner[0], corner[k], corner[k + 1]};
                for (size_t c = 0; c < 3; ++c)
                    piece.corner[c] = planes_[place->second].frame.flat(mesh_.vertices[piece.vertex[c]]);
                piece.patch = i;
                piece.plane = place->second;
                pieces_.push_back(std::move(piece));
            }
        }
    }

    Plane viewPlane(glm::dvec3 normal, glm::dvec3 origin) const {
        Plane plane;
        plane.frame.origin = origin;
        plane.frame.normal = normal;
        plane.frame.u = perpendicular(normal);
        plane.frame.v = glm::cross(normal, plane.frame.u);
        for (size_t p = 0; p < projectors_.size(); ++p) {
            PlaneView view;
            const glm::dvec3 centre = projectors_[p].centre();
            view.height = glm::dot(centre - origin, normal);
            view.front = view.height > 0;
            if (view.front) {
                view.foot = plane.frame.flat(centre);
                view.reach =
                    options_.leastCosine > 0
                        ? view.height * std::sqrt(1 / (options_.leastCosine * options_.leastCosine) - 1)
                        : std::numeric_limits<double>::infinity();
                for (const ConvexSolid& solid : solids_) {
                    ConvexOutline shadow = shadowOnPlane(solid, centre, plane.frame, kSkin);
                    if (!shadow.points.empty()) view.shadows.push_back(std::move(shadow));
                }
                for (const glm::dvec3& n : borders_[p])
                    view.borders.emplace_back(
                        glm::dvec2(glm::dot(n, plane.frame.u), glm::dot(n, plane.frame.v)),
                        glm::dot(n, centre - origin));
            }
            plane.views.push_back(std::move(view));
        }
        return plane;
    }

    void findCuts(Piece& piece) const {
        const glm::dvec2 low = glm::min(piece.corner[0], glm::min(piece.corner[1], piece.corner[2]));
        const glm::dvec2 high = glm::max(piece.corner[0], glm::max(piece.corner[1], piece.corner[2]));
        std::vector<const ConvexOutline*> near;
        for (const PlaneView& view : planes_[piece.plane].views) {
            if (!view.front || !mayReach(view, piece)) continue;
            near.clear();
            bool dark = false;
            for (const ConvexOutline& shadow : view.shadows) {
                if (shadow.low.x >= high.x || shadow.low.y >= high.y || shadow.high.x <= low.x ||
                    shadow.high.y <= low.y)
                    continue;
                dark = std::ranges::all_of(piece.corner, [&](glm::dvec2 p) { return shadow.contains(p); });
                if (dark) break;
                near.push_back(&shadow);
            }
            if (dark) continue;
            for (const ConvexOutline* shadow : near) cutAlong(*shadow, near, piece);
            for (const auto& [n, offset] : view.borders) cutAcross(n, offset, piece);
            cutAlongLimit(view, piece);
        }
    }

    // Where n . d has its least value: a circle round the projector's foot, as chords that end on the edges
    // of the triangle and leave it by less than kChord.
    void cutAlongLimit(const PlaneView& view, Piece& piece) const {
        constexpr double kChord = 2e-4; // metres
        const double radius = view.reach;
        if (!std::isfinite(radius)) return;
        const bool inside = std::ranges::all_of(
            piece.corner, [&](glm::dvec2 p) { return glm::length(p - view.foot) <= radius; });
        if (inside) return;
        std::vector<glm::dvec2> on;
        for (size_t k = 0; k < 3; ++k) {
            const glm::dvec2 a = piece.corner[k] - view.foot, e = piece.corner[(k + 1) % 3] - piece.corner[k];
            // |a + t e| = radius
            const double ee = glm::dot(e, e), ae = glm::dot(a, e), rest = glm::dot(a, a) - radius * radius,
                         root = ae * ae - ee * rest;
            if (root <= 0) continue;
            for (const double sign : {-1.0, 1.0})
                if (const double t = (-ae + sign * std::sqrt(root)) / ee; t > 0 && t < 1)
                    on.push_back(view.foot + a + t * e);
        }
        if (on.size() < 2) return;
        std::ranges::sort(on, {}, [&](glm::dvec2 p) { return angleFrom(view.foot, piece.corner, p); });
        for (size_t k = 0; k + 1 < on.size(); ++k) {
            const double from = angleFrom(view.foot, piece.corner, on[k]),
                         turn = angleFrom(view.foot, piece.corner, on[k + 1]) - from;
            const double parts =
                std::max(1.0, std::ceil(turn / (2 * std::acos(1 - std::min(0.5, kChord / radius)))));
            glm::dvec2 last = on[k];
            for (double i = 1; i <= parts; ++i) {
                const glm::dvec2 next =
                    i == parts ? on[k + 1] : turned(on[k] - view.foot, turn * i / parts) + view.foot;
                addCut({{last, next}}, piece); // leaves nothing of what lies outside the triangle
                last = next;
            }
        }
    }

    // Round the foot, from the direction away from the triangle's middle.
    static double angleFrom(glm::dvec2 foot, const std::array<glm::dvec2, 3>& corner, glm::dvec2 p) {
        const glm::dvec2 middle = (corner[0] + corner[1] + corner[2]) / 3.0 - foot, q = p - foot;
        return std::atan2(cross(middle, q), glm::dot(middle, q));
    }

    static glm::dvec2 turned(glm::dvec2 v, double angle) {
        return {v.x * std::cos(angle) - v.y * std::sin(angle), v.x * std::sin(angle) + v.y * std::cos(angle)};
    }

    // The circle of the least n . d may cut a side between two corners that lie outside it.
    static bool nearCircle(const PlaneView& view, const Piece& piece) {
        const double size = std::max(glm::length(piece.corner[1] - piece.corner[0]),
                                     glm::length(piece.corner[2] - piece.corner[0]));
        return glm::length(piece.corner[0] - view.foot) < view.reach + size;
    }

    // False when the whole piece lies outside one border of the picture, or is lit too flatly.
    static bool mayReach(const PlaneView& view, const Piece& piece) {
        for (const auto& [n, offset] : view.borders)
            if (std::ranges::all_of(piece.corner, [&](glm::dvec2 p) { return glm::dot(n, p) <= offset; }))
                return false;
        return std::ranges::any_of(piece.corner,
                                   [&](glm::dvec2 p) { return glm::length(p - view.foot) < view.reach; }) ||
               nearCircle(view, piece);
    }

    void cutAcross(glm::dvec2 n, double offset, Piece& piece) const {
        const double size = glm::length(n);
        if (size < 1e-12) return;
        const glm::dvec2 middle = (piece.corner[0] + piece.corner[1] + piece.corner[2]) / 3.0;
        const glm::dvec2 onLine = middle + n * ((offset - glm::dot(n, middle)) / (size * size));
        const glm::dvec2 along = glm::dvec2(-n.y, n.x) * (10 / size);
        addCut({{onLine - along, onLine + along}}, piece);
    }

    // Only where it is the outline of all shadows together.
    void cutAlong(const ConvexOutline& shadow, const std::vector<const ConvexOutline*>& all,
                  Piece& piece) const {
        for (size_t i = 0; i < shadow.points.size(); ++i) {
            Cut cut{{shadow.points[i], shadow.points[(i + 1) % shadow.points.size()]}};
            const glm::dvec2 d = cut.end[1] - cut.end[0];
            // Most outlines pass by: all corners on one side.
            const double s0 = cross(d, piece.corner[0] - cut.end[0]),
                         s1 = cross(d, piece.corner[1] - cut.end[0]),
                         s2 = cross(d, piece.corner[2] - cut.end[0]);
            if ((s0 > 0 && s1 > 0 && s2 > 0) || (s0 < 0 && s1 < 0 && s2 < 0)) continue;
            if (!clipToTriangle(piece.corner, cut)) continue;
            const glm::dvec2 outward = kNudge * glm::normalize(glm::dvec2(d.y, -d.x));
            std::vector<double> at{0, 1};
            for (const ConvexOutline* other : all)
                if (other != &shadow) addCrossings(cut, *other, at);
            std::ranges::sort(at);
            for (size_t k = 0; k + 1 < at.size(); ++k) {
                const glm::dvec2 whole = cut.end[1] - cut.end[0];
                if ((at[k + 1] - at[k]) * glm::length(whole) < kOnEdge) continue;
                const glm::dvec2 middle = cut.end[0] + 0.5 * (at[k] + at[k + 1]) * whole + outward;
                if (std::ranges::any_of(
                        all, [&](const ConvexOutline* o) { return o != &shadow && o->contains(middle); }))
                    continue;
                Cut part;
                part.end = {cut.end[0] + at[k] * whole, cut.end[0] + at[k + 1] * whole};
                part.edge = {k == 0 ? cut.edge[0] : -1, k + 2 == at.size() ? cut.edge[1] : -1};
                addCut(part, piece);
            }
        }
    }

    static void addCrossings(const Cut& cut, const ConvexOutline& other, std::vector<double>& at) {
        const glm::dvec2 d = cut.end[1] - cut.end[0];
        for (size_t i = 0; i < other.points.size(); ++i) {
            const glm::dvec2 p = other.points[i], e = other.points[(i + 1) % other.points.size()] - p;
            const double turn = cross(d, e);
            if (std::abs(turn) < 1e-15) continue;
            const double t = cross(p - cut.end[0], e) / turn, u = cross(p - cut.end[0], d) / turn;
            if (t > 0 && t < 1 && u >= 0 && u <= 1) at.push_back(t);
        }
    }

    static void addCut(Cut cut, Piece& piece) {
        const std::array<int, 2> known = cut.edge;
        if (!clipToTriangle(piece.corner, cut)) return;
        for (size_t k = 0; k < 2; ++k)
            if (cut.edge[k] < 0) cut.edge[k] = known[k];
        if (cut.edge[0] >= 0 && cut.edge[0] == cut.edge[1]) return;
        piece.cuts.push_back(cut);
    }

    struct EdgeKey {
        uint32_t a, b;
        bool operator==(const EdgeKey&) const = default;
    };

    struct Hash {
        template<size_t N> size_t operator()(const std::array<uint32_t, N>& key) const {
            uint64_t hash = 0;
            for (const uint32_t value : key) {
                hash = (hash ^ value) * 0x9E3779B97F4A7C15ull;
                hash ^= hash >> 32;
            }
            return hash;
        }
        size_t operator()(const EdgeKey& key) const { return (*this)(std::array<uint32_t, 2>{key.a, key.b}); }
    };

    static EdgeKey edgeKey(const Piece& piece, int k) {
        const uint32_t a = piece.vertex[static_cast<size_t>(k)],
                       b = piece.vertex[static_cast<size_t>((k + 1) % 3)];
        return {std::min(a, b), std::max(a, b)};
    }

    // Where on the edge, from the vertex with the lower number.
    static double onEdge(const Piece& piece, int k, glm::dvec2 p) {
        const auto i = static_cast<size_t>(k), j = (i + 1) % 3;
        const glm::dvec2 e = piece.corner[j] - piece.corner[i];
        const double t = std::clamp(glm::dot(p - piece.corner[i], e) / glm::dot(e, e), 0.0, 1.0);
        return piece.vertex[i] < piece.vertex[j] ? t : 1 - t;
    }

    void shareCuts(const Piece& piece) {
        for (const Cut& cut : piece.cuts)
            for (size_t end = 0; end < 2; ++end)
                if (cut.edge[end] >= 0)
                    edgeCuts_[edgeKey(piece, cut.edge[end])].push_back(
                        onEdge(piece, cut.edge[end], cut.end[end]));
    }

    static void tidy(std::vector<double>& cuts) {
        std::ranges::sort(cuts);
        std::vector<double> kept;
        for (const double t : cuts)
            if (t > kSameCut && t < 1 - kSameCut && (kept.empty() || t - kept.back() > kSameCut))
                kept.push_back(t);
        cuts = std::move(kept);
    }

    // The vertex of the result at a corner of the mesh, on this surface.
    uint32_t cornerVertex(uint32_t v, uint32_t surface) {
        const auto [place, isNew] =
            corners_.try_emplace({v, surface}, static_cast<uint32_t>(out_.vertices.size()));
        if (isNew) addVertex(mesh_.vertices[v], {v, v, v}, {1, 0, 0});
        return place->second;
    }

    uint32_t edgeVertex(EdgeKey edge, size_t index, uint32_t surface) {
        const auto [place, isNew] =
            edgeVertices_.try_emplace({edge.a, edge.b, static_cast<uint32_t>(index), surface},
                                      static_cast<uint32_t>(out_.vertices.size()));
        if (isNew) {
            const double t = edgeCuts_.at(edge)[index];
            addVertex(mesh_.vertices[edge.a] + t * (mesh_.vertices[edge.b] - mesh_.vertices[edge.a]),
                      {edge.a, edge.b, edge.a}, {1 - t, t, 0});
        }
        return place->second;
    }

    void addVertex(glm::dvec3 p, std::array<uint32_t, 3> source, glm::dvec3 weight) {
        out_.vertices.push_back(p);
        out_.sourceVertex.push_back(source);
        out_.sourceWeight.emplace_back(weight);
    }

    void buildPiece(const Piece& piece) {
        const uint32_t surface = mesh_.surface[piece.patch];
        const PlaneFrame& frame = planes_[piece.plane].frame;
        std::vector<glm::dvec2> border;
        std::vector<uint32_t> vertices;
        std::array<std::map<size_t, int>, 3> borderOf; // per edge: index of the cut -> border point
        std::array<int, 3> cornerBorder{};
        for (int k = 0; k < 3; ++k) {
            const auto i = static_cast<size_t>(k);
            cornerBorder[i] = static_cast<int>(border.size());
            border.push_back(piece.corner[i]);
            vertices.push_back(cornerVertex(piece.vertex[i], surface));
            const EdgeKey key = edgeKey(piece, k);
            const auto cuts = edgeCuts_.find(key);
            if (cuts == edgeCuts_.end()) continue;
            const size_t n = cuts->second.size();
            const bool forward = piece.vertex[i] == key.a;
            for (size_t c = 0; c < n; ++c) {
                const size_t index = forward ? c : n - 1 - c;
                const uint32_t vertex = edgeVertex(key, index, surface);
                borderOf[i][index] = static_cast<int>(border.size());
                border.push_back(frame.flat(out_.vertices[vertex]));
                vertices.push_back(vertex);
            }
        }
        if (border.size() == 3 && piece.cuts.empty())
            return addTriangle(vertices[0], vertices[1], vertices[2], piece, piece.corner);

        std::vector<CutSegment> segments;
        for (const Cut& cut : piece.cuts) {
            CutSegment segment;
            segment.point = cut.end;
            for (size_t end = 0; end < 2; ++end)
                if (cut.edge[end] >= 0)
                    segment.border[end] =
                        nearestBorder(piece, cut.edge[end], cut.end[end], borderOf, cornerBorder);
            segments.push_back(segment);
        }
        const CutResult result = cutTriangle(border, segments);
        for (size_t i = border.size(); i < result.points.size(); ++i) {
            vertices.push_back(static_cast<uint32_t>(out_.vertices.size()));
            addVertex(frame.inSpace(result.points[i]), piece.vertex,
                      barycentric(piece.corner, result.points[i]));
        }
        for (const auto& t : result.triangles)
            addTriangle(vertices[t[0]], vertices[t[1]], vertices[t[2]], piece,
                        {result.points[t[0]], result.points[t[1]], result.points[t[2]]});
    }

    int nearestBorder(const Piece& piece, int k, glm::dvec2 p,
                      const std::array<std::map<size_t, int>, 3>& borderOf,
                      const std::array<int, 3>& cornerBorder) const {
        const auto i = static_cast<size_t>(k), j = (i + 1) % 3;
        const double t = onEdge(piece, k, p);
        const bool forward = piece.vertex[i] < piece.vertex[j];
        int best = cornerBorder[forward ? i : j];
        double least = t;
        if (1 - t < least) {
            least = 1 - t;
            best = cornerBorder[forward ? j : i];
        }
        const auto cuts = edgeCuts_.find(edgeKey(piece, k));
        for (size_t c = 0; cuts != edgeCuts_.end() && c < cuts->second.size(); ++c)
            if (std::abs(cuts->second[c] - t) < least) {
                least = std::abs(cuts->second[c] - t);
                best = borderOf[i].at(c);
            }
        return best;
    }

    static glm::dvec3 barycentric(const std::array<glm::dvec2, 3>& c, glm::dvec2 p) {
        const double whole = cross(c[1] - c[0], c[2] - c[0]);
        const double b = cross(p - c[0], c[2] - c[0]) / whole, d = cross(c[1] - c[0], p - c[0]) / whole;
        return {1 - b - d, b, d};
    }

    void addTriangle(uint32_t a, uint32_t b, uint32_t c, const Piece& piece,
                     const std::array<glm::dvec2, 3>& corner) {
        out_.triangles.insert(out_.triangles.end(), {a, b, c});
        out_.sourcePatch.push_back(static_cast<uint32_t>(piece.patch));
        planeOf_.push_back(static_cast<uint32_t>(piece.plane));
        const glm::dvec2 middle = (corner[0] + corner[1] + corner[2]) / 3.0;
        uint32_t seen = 0;
        for (size_t p = 0; p < projectors_.size(); ++p)
            if (reaches(planes_[piece.plane].views[p], middle)) seen |= 1u << p;
        out_.visible.push_back(seen);
    }

    bool reaches(const PlaneView& view, glm::dvec2 p) const {
        if (!view.front) return false;
        const double cosine =
            view.height / std::sqrt(view.height * view.height + glm::dot(p - view.foot, p - view.foot));
        if (cosine <= options_.leastCosine) return false;
        for (const auto& [n, offset] : view.borders)
            if (glm::dot(n, p) <= offset) return false;
        return std::ranges::none_of(view.shadows, [&](const ConvexOutline& s) { return s.contains(p); });
    }

    // Shares: a projector counts at a vertex when it sees every reachable triangle of the surface round it;
    // it fades in with the distance from the vertices where it does not, and counts for more where its light
    // falls steeper.
    void blend() {
        const size_t count = out_.projectorCount, vertices = out_.vertices.size();
        std::vector<uint32_t> common(vertices, 0xffffffffu);
        for (size_t t = 0; t < out_.triangleCount(); ++t)
            if (out_.visible[t])
                for (size_t k = 0; k < 3; ++k) common[out_.triangles[3 * t + k]] &= out_.visible[t];
        splitSeams(common);
        out_.weights.assign(out_.vertices.size() * count, 0);
        std::vector<glm::dvec3> normal(out_.vertices.size());
        for (size_t t = 0; t < out_.triangleCount(); ++t)
            for (size_t k = 0; k < 3; ++k)
                normal[out_.triangles[3 * t + k]] = planes_[planeOf_[t]].frame.normal;
        const Neighbours around = neighbours();
        for (size_t p = 0; p < count; ++p) {
            const std::vector<double> distance = distanceFromDark(common, p, around);
            for (size_t v = 0; v < out_.vertices.size(); ++v) {
                if (common[v] == 0xffffffffu || !(common[v] >> p & 1u)) continue;
                const glm::dvec3 d = projectors_[p].centre() - out_.vertices[v];
                const double square = glm::dot(d, d), cosine = glm::dot(d, normal[v]) / std::sqrt(square);
                const double fade = std::clamp(distance[v] / options_.falloff, 0.02, 1.0);
                out_.weights[v * count + p] =
                    static_cast<float>(fade * fade * (3 - 2 * fade) * std::max(cosine, 1e-3) / square);
            }
        }
        for (size_t v = 0; v < out_.vertices.size(); ++v) {
            float sum = 0;
            for (size_t p = 0; p < count; ++p) sum += out_.weights[v * count + p];
            for (size_t p = 0; p < count && sum > 0; ++p) out_.weights[v * count + p] /= sum;
        }
    }

    // Where no projector sees all triangles round a vertex, each set of projectors gets its own copy of it:
    // better a seam between them than a dark spot.
    void splitSeams(std::vector<uint32_t>& common) {
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> copies;
        for (size_t t = 0; t < out_.triangleCount(); ++t)
            for (size_t k = 0; k < 3 && out_.visible[t]; ++k) {
                uint32_t& v = out_.triangles[3 * t + k];
                if (common[v] != 0) continue;
                const auto [place, isNew] =
                    copies.try_emplace({v, out_.visible[t]}, static_cast<uint32_t>(out_.vertices.size()));
                if (isNew) {
                    addVertex(out_.vertices[v], out_.sourceVertex[v], glm::dvec3(out_.sourceWeight[v]));
                    common.push_back(out_.visible[t]);
                }
                v = place->second;
            }
    }

    // The vertices at the other ends of visible triangles' edges, as lists one after the other.
    struct Neighbours {
        std::vector<uint32_t> first, vertices;
    };

    Neighbours neighbours() const {
        Neighbours out;
        out.first.assign(out_.vertices.size() + 1, 0);
        for (size_t t = 0; t < out_.triangleCount(); ++t)
            for (size_t k = 0; k < 3 && out_.visible[t]; ++k) out.first[out_.triangles[3 * t + k] + 1] += 2;
        for (size_t v = 1; v < out.first.size(); ++v) out.first[v] += out.first[v - 1];
        out.vertices.resize(out.first.back());
        std::vector<uint32_t> at(out.first.begin(), out.first.end() - 1);
        for (size_t t = 0; t < out_.triangleCount(); ++t)
            for (size_t k = 0; k < 3 && out_.visible[t]; ++k) {
                const uint32_t v = out_.triangles[3 * t + k];
                out.vertices[at[v]++] = out_.triangles[3 * t + (k + 1) % 3];
                out.vertices[at[v]++] = out_.triangles[3 * t + (k + 2) % 3];
            }
        return out;
    }

    // Along edges of the mesh (Dijkstra with the fade's length as limit), from vertices of a surface that p
    // does not see.
    std::vector<double> distanceFromDark(const std::vector<uint32_t>& common, size_t p,
                                         const Neighbours& around) const {
        std::vector<double> distance(out_.vertices.size(), std::numeric_limits<double>::infinity());
        std::set<std::pair<double, uint32_t>> front;
        for (uint32_t v = 0; v < out_.vertices.size(); ++v)
            if (common[v] != 0xffffffffu && !(common[v] >> p & 1u)) {
                distance[v] = 0;
                front.emplace(0, v);
            }
        while (!front.empty()) {
            const auto [d, v] = *front.begin();
            front.erase(front.begin());
            if (d > options_.falloff) break;
            for (uint32_t i = around.first[v]; i < around.first[v + 1]; ++i) {
                const uint32_t w = around.vertices[i];
                const double through = d + glm::length(out_.vertices[w] - out_.vertices[v]);
                if (through >= distance[w]) continue;
                front.erase({distance[w], w});
                distance[w] = through;
                front.emplace(through, w);
            }
        }
        return distance;
    }

    void measureReach() {
        std::map<uint32_t, SurfaceReach> reach;
        for (size_t t = 0; t < out_.triangleCount(); ++t) {
            const glm::dvec3 a = out_.vertices[out_.triangles[3 * t]],
                             b = out_.vertices[out_.triangles[3 * t + 1]],
                             c = out_.vertices[out_.triangles[3 * t + 2]];
            const double area = 0.5 * glm::length(glm::cross(b - a, c - a));
            SurfaceReach& surface = reach[mesh_.surface[out_.sourcePatch[t]]];
            surface.surface = mesh_.surface[out_.sourcePatch[t]];
            surface.area += area;
            if (!out_.visible[t]) surface.unreachable += area;
        }
        for (const auto& [id, surface] : reach) out_.surfaces.push_back(surface);
    }

    const PatchMesh& mesh_;
    std::span<const OpticalDevice> projectors_;
    ProjectorOptions options_;
    std::vector<ConvexSolid> solids_;
    std::vector<std::array<glm::dvec3, 4>> borders_;
    std::vector<Plane> planes_;
    std::vector<Piece> pieces_;
    std::unordered_map<EdgeKey, std::vector<double>, Hash> edgeCuts_;
    std::unordered_map<std::array<uint32_t, 2>, uint32_t, Hash> corners_;
    std::unordered_map<std::array<uint32_t, 4>, uint32_t, Hash> edgeVertices_;
    std::vector<uint32_t> planeOf_; // per triangle
    ProjectorMesh out_;
};

} // namespace

ProjectorMesh splitByProjectorVisibility(const PatchMesh& mesh, const Occluders& occluders,
                                         std::span<const OpticalDevice> projectors,
                                         const ProjectorOptions& options) {
    if (projectors.size() > 32) throw std::runtime_error("at most 32 projectors can be told apart");
    return VisibilitySplitter(mesh, occluders, projectors, options).split();
}

} // namespace heliodon::geometry
