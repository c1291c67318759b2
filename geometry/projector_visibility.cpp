// Where the paper casts a ray from each centroid of a mesh cut along silhouettes, we keep the shadow of every
// convex solid on every plane as a polygon: it is both the line to mesh along and, exactly, the test whether
// a piece is dark. Lines meet the border of a flat piece of surface in points that both neighbours share, so
// that no T-vertices arise.
#include "geometry/projector_visibility.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <tuple>
#include <unordered_map>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"
#include "geometry/plane_view.h"
#include "geometry/projector_blend.h"
#include "geometry/region_mesh.h"

namespace heliodon::geometry {

namespace {

struct Hash {
    template<size_t N> size_t operator()(const std::array<int64_t, N>& key) const {
        uint64_t hash = 0;
        for (const int64_t value : key) {
            hash = (hash ^ static_cast<uint64_t>(value)) * 0x9E3779B97F4A7C15ull;
            hash ^= hash >> 32;
        }
        return hash;
    }
};

// A triangle of the mesh.
struct Piece {
    std::array<glm::dvec2, 3> corner{};
    std::array<uint32_t, 3> vertex{};
    uint32_t patch = 0;

    glm::dvec3 barycentric(glm::dvec2 p) const {
        const double whole = cross(corner[1] - corner[0], corner[2] - corner[0]);
        const double b = cross(p - corner[0], corner[2] - corner[0]) / whole,
                     c = cross(corner[1] - corner[0], p - corner[0]) / whole;
        return {1 - b - c, b, c};
    }
};

// Which piece a point lies in, by a grid of boxes.
class PieceFinder {
public:
    PieceFinder(const std::vector<Piece>& pieces, glm::dvec2 low, glm::dvec2 high, double cell)
        : pieces_(pieces), low_(low), cell_(cell) {
        columns_ = static_cast<int>((high.x - low.x) / cell_) + 1;
        rows_ = static_cast<int>((high.y - low.y) / cell_) + 1;
        first_.assign(static_cast<size_t>(columns_) * static_cast<size_t>(rows_) + 1, 0);
        for (const Piece& piece : pieces) eachCell(piece, [&](size_t c) { ++first_[c + 1]; });
        for (size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
        items_.resize(first_.back());
        std::vector<uint32_t> at(first_.begin(), first_.end() - 1);
        for (uint32_t i = 0; i < pieces.size(); ++i)
            eachCell(pieces[i], [&](size_t c) { items_[at[c]++] = i; });
    }

    // The piece that it lies in, or, by a rounding error beside all, the nearest.
    uint32_t at(glm::dvec2 p) const {
        const auto cell = static_cast<size_t>(row(p.y) * columns_ + column(p.x));
        uint32_t best = 0;
        double most = -1e300;
        for (uint32_t k = first_[cell]; k < first_[cell + 1]; ++k) {
            const glm::dvec3 w = pieces_[items_[k]].barycentric(p);
            const double least = std::min({w.x, w.y, w.z});
            if (least <= most) continue;
            most = least;
            best = items_[k];
            if (most >= 0) break;
        }
        return best;
    }

private:
    int column(double x) const { return std::clamp(static_cast<int>((x - low_.x) / cell_), 0, columns_ - 1); }
    int row(double y) const { return std::clamp(static_cast<int>((y - low_.y) / cell_), 0, rows_ - 1); }

    template<class Visit> void eachCell(const Piece& piece, Visit visit) const {
        const glm::dvec2 low = glm::min(piece.corner[0], glm::min(piece.corner[1], piece.corner[2])) -
                               1e-3 * cell_,
                         high = glm::max(piece.corner[0], glm::max(piece.corner[1], piece.corner[2])) +
                                1e-3 * cell_;
        for (int r = row(low.y); r <= row(high.y); ++r)
            for (int c = column(low.x); c <= column(high.x); ++c)
                visit(static_cast<size_t>(r * columns_ + c));
    }

    const std::vector<Piece>& pieces_;
    glm::dvec2 low_;
    double cell_;
    int columns_ = 1, rows_ = 1;
    std::vector<uint32_t> first_, items_;
};

// All pieces of one surface in one plane.
struct FlatPart {
    PlaneFrame frame;
    uint32_t surface = 0;
    std::vector<Piece> pieces;
    glm::dvec2 low{}, high{};
    std::vector<PlaneView> views;
    std::vector<Cut> cuts;
    std::vector<std::array<uint32_t, 2>> borderEdges; // vertices, the pieces on their left
    std::vector<Segment> border;                      // the same in the plane

    void bound() {
        low = high = pieces[0].corner[0];
        for (const Piece& piece : pieces)
            for (const glm::dvec2 p : piece.corner) {
                low = glm::min(low, p);
                high = glm::max(high, p);
            }
    }

    // Edge length of a regular triangle of the mean area.
    double spacing() const {
        double twice = 0;
        for (const Piece& p : pieces) twice += cross(p.corner[1] - p.corner[0], p.corner[2] - p.corner[0]);
        return std::sqrt(2 / std::sqrt(3.0) * twice / static_cast<double>(pieces.size()));
    }

    // Edges that only one piece has.
    void findBorder() {
        struct Side {
            uint32_t low, high, piece, k;
        };
        std::vector<Side> sides;
        for (uint32_t i = 0; i < pieces.size(); ++i)
            for (uint32_t k = 0; k < 3; ++k) {
                const auto [a, b] = std::minmax(pieces[i].vertex[k], pieces[i].vertex[(k + 1) % 3]);
                sides.push_back({a, b, i, k});
            }
        std::ranges::sort(sides, {}, [](const Side& s) { return std::tuple(s.low, s.high, s.piece); });
        const auto same = [](const Side& s, const Side& o) { return s.low == o.low && s.high == o.high; };
        for (size_t i = 0; i < sides.size(); ++i) {
            if ((i > 0 && same(sides[i - 1], sides[i])) ||
                (i + 1 < sides.size() && same(sides[i + 1], sides[i])))
                continue;
            const Piece& piece = pieces[sides[i].piece];
            const size_t k = sides[i].k, next = (k + 1) % 3;
            borderEdges.push_back({piece.vertex[k], piece.vertex[next]});
            border.push_back({piece.corner[k], piece.corner[next]});
        }
    }
};

class VisibilitySplitter {
public:
    VisibilitySplitter(const PatchMesh& mesh, const Occluders& occluders,
                       std::span<const OpticalDevice> projectors, const ProjectorOptions& options)
        : mesh_(mesh), projectors_(projectors), options_(options) {
        for (ConvexSolid& solid : convexSolids(occluders)) casters_.emplace_back(std::move(solid));
        for (const OpticalDevice& device : projectors) borders_.push_back(pictureBorders(device));
        out_.projectorCount = projectors.size();
    }

    ProjectorMesh split() {
        corners_.reserve(2 * mesh_.vertices.size());
        collectParts();
        for (FlatPart& part : parts_) findCuts(part);
        for (auto& [edge, cuts] : edgeCuts_) tidy(edge, cuts);
        for (FlatPart& part : parts_) build(part);
        blendProjectors(out_, projectors_, normals_, options_.falloff);
        measureReach();
        return std::move(out_);
    }

private:
    using EdgeKey = std::array<int64_t, 2>; // vertices, the lower number first

    void collectParts() {
        std::unordered_map<std::array<int64_t, 5>, size_t, Hash> planes;
        for (uint32_t i = 0; i < mesh_.patchCount(); ++i) {
            if (mesh_.role[i] != Role::projection) continue;
            const glm::dvec3 n = patchNormal(mesh_, i), p = mesh_.vertices[mesh_.patch(i)[0]];
            const auto [place, isNew] =
                planes.try_emplace({mesh_.surface[i], std::llround(n.x * 1e7), std::llround(n.y * 1e7),
                                    std::llround(n.z * 1e7), std::llround(glm::dot(n, p) * 1e7)},
                                   parts_.size());
            if (isNew) {
                FlatPart& part = parts_.emplace_back();
                const glm::dvec3 u = perpendicular(n);
                part.frame = {p, u, glm::cross(n, u), n};
                part.surface = mesh_.surface[i];
            }
            FlatPart& part = parts_[place->second];
            const auto corner = mesh_.patch(i);
            for (size_t k = 1; k + 1 < corner.size(); ++k) {
                Piece& piece = part.pieces.emplace_back();
                piece.vertex = {corner[0], corner[k], corner[k + 1]};
                for (size_t c = 0; c < 3; ++c)
                    piece.corner[c] = part.frame.flat(mesh_.vertices[piece.vertex[c]]);
                piece.patch = i;
            }
        }
    }

    void findCuts(FlatPart& part) {
        part.bound();
        std::vector<glm::dvec2> hull{
            part.low, {part.high.x, part.low.y}, part.high, {part.low.x, part.high.y}};
        if (part.pieces.size() == 1) hull.assign(part.pieces[0].corner.begin(), part.pieces[0].corner.end());
        std::vector<Segment> outline;
        for (size_t p = 0; p < projectors_.size(); ++p) {
            part.views.push_back(viewOfPlane(part.frame, hull, projectors_[p].centre(), borders_[p],
                                             options_.leastCosine, casters_));
            appendOutline(part.views.back(), part.low, part.high, outline);
        }
        if (outline.empty()) return;
        part.findBorder();
        part.cuts = clipToRegion(outline, part.border);
        for (const Cut& cut : part.cuts)
            for (const CutEnd& end : cut)
                if (end.edge >= 0 && end.t > 0 && end.t < 1) {
                    const auto& [a, b] = part.borderEdges[static_cast<size_t>(end.edge)];
                    edgeCuts_[keyOf(a, b)].push_back(a < b ? end.t : 1 - end.t);
                }
    }

    static EdgeKey keyOf(uint32_t a, uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

    // Both surfaces at the edge cut it, each by its own reckoning.
    void tidy(const EdgeKey& edge, std::vector<double>& cuts) const {
        std::ranges::sort(cuts);
        const double same = kSameInRegion / glm::length(mesh_.vertices[static_cast<size_t>(edge[1])] -
                                                        mesh_.vertices[static_cast<size_t>(edge[0])]);
        std::vector<double> kept;
        for (const double t : cuts)
            if (t > same && t < 1 - same && (kept.empty() || t - kept.back() > same)) kept.push_back(t);
        cuts = std::move(kept);
    }

    // The vertex of the result at a corner of the mesh, on this surface.
    uint32_t cornerVertex(uint32_t v, uint32_t surface) {
        const auto [place, isNew] =
            corners_.try_emplace({v, surface}, static_cast<uint32_t>(out_.vertices.size()));
        if (isNew) addVertex(mesh_.vertices[v], {v, v, v}, {1, 0, 0});
        return place->second;
    }

    uint32_t edgeVertex(const EdgeKey& edge, size_t index, uint32_t surface) {
        const auto [place, isNew] =
            edgeVertices_.try_emplace({edge[0], edge[1], static_cast<int64_t>(index), surface},
                                      static_cast<uint32_t>(out_.vertices.size()));
        if (isNew) {
            const double t = edgeCuts_.at(edge)[index];
            const auto a = static_cast<uint32_t>(edge[0]), b = static_cast<uint32_t>(edge[1]);
            addVertex(mesh_.vertices[a] + t * (mesh_.vertices[b] - mesh_.vertices[a]), {a, b, a},
                      {1 - t, t, 0});
        }
        return place->second;
    }

    void addVertex(glm::dvec3 p, std::array<uint32_t, 3> source, glm::dvec3 weight) {
        out_.vertices.push_back(p);
        out_.sourceVertex.push_back(source);
        out_.sourceWeight.emplace_back(weight);
    }

    void addTriangle(const std::array<uint32_t, 3>& vertex, const std::array<glm::dvec2, 3>& corner,
                     uint32_t patch, const FlatPart& part) {
        out_.triangles.insert(out_.triangles.end(), vertex.begin(), vertex.end());
        out_.sourcePatch.push_back(patch);
        normals_.push_back(part.frame.normal);
        uint32_t seen = 0;
        for (size_t p = 0; p < part.views.size(); ++p)
            if (part.views[p].reaches((corner[0] + corner[1] + corner[2]) / 3.0)) seen |= 1u << p;
        out_.visible.push_back(seen);
    }

    bool bordersOnCuts(const FlatPart& part) const {
        return std::ranges::any_of(part.pieces, [&](const Piece& piece) {
            for (size_t k = 0; k < 3; ++k)
                if (edgeCuts_.contains(keyOf(piece.vertex[k], piece.vertex[(k + 1) % 3]))) return true;
            return false;
        });
    }

    void build(FlatPart& part) {
        if (!part.cuts.empty() || bordersOnCuts(part)) return rebuild(part);
        for (const Piece& piece : part.pieces) {
            std::array<uint32_t, 3> vertex{};
            for (size_t k = 0; k < 3; ++k) vertex[k] = cornerVertex(piece.vertex[k], part.surface);
            addTriangle(vertex, piece.corner, piece.patch, part);
        }
    }

    // A border edge with the points that cuts have made on it, as indices of the region's border points.
    struct Chain {
        std::vector<uint32_t> points;
        std::vector<double> places; // 0 .. 1
    };

    void rebuild(FlatPart& part) {
        if (part.border.empty()) part.findBorder();
        Region region;
        region.spacing = part.spacing();
        std::vector<uint32_t> vertices; // of the result, per point of the region
        std::unordered_map<uint32_t, uint32_t> onBorder;
        std::vector<Chain> chains;
        const auto borderCorner = [&](uint32_t v, glm::dvec2 p) {
            const auto [place, isNew] = onBorder.try_emplace(v, static_cast<uint32_t>(region.border.size()));
            if (isNew) {
                region.border.push_back(p);
                vertices.push_back(cornerVertex(v, part.surface));
            }
            return place->second;
        };
        for (size_t e = 0; e < part.border.size(); ++e) {
            const auto [a, b] = part.borderEdges[e];
            Chain chain;
            chain.points.push_back(borderCorner(a, part.border[e][0]));
            chain.places.push_back(0);
            const EdgeKey key = keyOf(a, b);
            const auto cuts = edgeCuts_.find(key);
            const size_t n = cuts == edgeCuts_.end() ? 0 : cuts->second.size();
            for (size_t c = 0; c < n; ++c) {
                const size_t index = a < b ? c : n - 1 - c;
                chain.points.push_back(static_cast<uint32_t>(region.border.size()));
                chain.places.push_back(a < b ? cuts->second[index] : 1 - cuts->second[index]);
                vertices.push_back(edgeVertex(key, index, part.surface));
                region.border.push_back(part.frame.flat(out_.vertices[vertices.back()]));
            }
            chain.points.push_back(borderCorner(b, part.border[e][1]));
            chain.places.push_back(1);
            for (size_t k = 0; k + 1 < chain.points.size(); ++k)
                region.borderEdges.emplace_back(chain.points[k], chain.points[k + 1]);
            chains.push_back(std::move(chain));
        }
        for (const Cut& cut : part.cuts) {
            RegionLine line;
            for (size_t k = 0; k < 2; ++k) {
                line.point[k] = cut[k].point;
                if (cut[k].edge >= 0)
                    line.border[k] =
                        static_cast<int>(nearest(chains[static_cast<size_t>(cut[k].edge)], cut[k].t));
            }
            region.lines.push_back(line);
        }
        const std::vector<uint32_t> seeds = addSeeds(part, onBorder, region);
        const RegionMesh mesh = meshRegion(region);
        for (const uint32_t s : mesh.keptSeeds) vertices.push_back(cornerVertex(seeds[s], part.surface));
        const PieceFinder finder(part.pieces, part.low, part.high, 1.5 * region.spacing);
        for (size_t i = vertices.size(); i < mesh.points.size(); ++i) {
            const Piece& piece = part.pieces[finder.at(mesh.points[i])];
            vertices.push_back(static_cast<uint32_t>(out_.vertices.size()));
            addVertex(part.frame.inSpace(mesh.points[i]), piece.vertex, piece.barycentric(mesh.points[i]));
        }
        for (const auto& t : mesh.triangles)
            addTriangle({vertices[t[0]], vertices[t[1]], vertices[t[2]]},
                        {mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]}, part.pieces[0].patch,
                        part);
    }

    static uint32_t nearest(const Chain& chain, double t) {
        size_t best = 0;
        for (size_t k = 1; k < chain.points.size(); ++k)
            if (std::abs(chain.places[k] - t) < std::abs(chain.places[best] - t)) best = k;
        return chain.points[best];
    }

    // The vertices inside the part, with the mean length of the edges there.
    static std::vector<uint32_t>
    addSeeds(const FlatPart& part, const std::unordered_map<uint32_t, uint32_t>& onBorder, Region& region) {
        std::vector<uint32_t> seeds;
        std::unordered_map<uint32_t, uint32_t> known;
        std::vector<double> count;
        for (const Piece& piece : part.pieces)
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t v = piece.vertex[k];
                if (onBorder.contains(v)) continue;
                const auto [place, isNew] = known.try_emplace(v, static_cast<uint32_t>(seeds.size()));
                if (isNew) {
                    seeds.push_back(v);
                    region.seeds.push_back(piece.corner[k]);
                    region.seedSpacing.push_back(0);
                    count.push_back(0);
                }
                region.seedSpacing[place->second] += glm::length(piece.corner[(k + 1) % 3] - piece.corner[k]);
                ++count[place->second];
            }
        for (size_t s = 0; s < seeds.size(); ++s) region.seedSpacing[s] /= count[s];
        return seeds;
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
    std::vector<ShadowCaster> casters_;
    std::vector<std::array<glm::dvec3, 4>> borders_;
    std::vector<FlatPart> parts_;
    std::unordered_map<EdgeKey, std::vector<double>, Hash> edgeCuts_;
    std::unordered_map<std::array<int64_t, 2>, uint32_t, Hash> corners_;
    std::unordered_map<std::array<int64_t, 4>, uint32_t, Hash> edgeVertices_;
    std::vector<glm::dvec3> normals_; // per triangle
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
