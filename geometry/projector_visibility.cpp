// Where the paper casts a ray from each centroid of a mesh cut along silhouettes, we keep the shadow of every
// convex solid on every plane as a polygon: it is both the line to mesh along and, exactly, the test whether
// a piece is dark. Lines meet the border of a flat piece of surface in points that both neighbours share, so
// that no T-vertices arise.
#include "geometry/projector_visibility.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <unordered_map>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/flat_part.h"
#include "geometry/key_hash.h"
#include "geometry/region_mesh.h"
#include "geometry/spare_vertices.h"
#include "geometry/standing_faces.h"

namespace heliodon::geometry {

namespace {

class VisibilitySplitter {
public:
    VisibilitySplitter(const PatchMesh& mesh, const Occluders& occluders,
                       std::span<const OpticalDevice> projectors, const ProjectorOptions& options)
        : mesh_(mesh), options_(options), parts_(flatParts(mesh)),
          casters_(occluders.triangles.empty() ? standingFaces(parts_, mesh.vertices)
                                               : convexSolids(occluders)) {
        for (const OpticalDevice& device : projectors) beams_.emplace_back(device, casters_);
    }

    ProjectorMesh split() {
        copies_.assign(mesh_.vertices.size(), Piece::kNone);
        cutVertices_.assign(mesh_.vertices.size(), false);
        for (FlatPart& part : parts_) findCuts(part);
        for (auto& [edge, cuts] : edgeCuts_) tidy(edge, cuts);
        spare_ = spareVertices(parts_, mesh_.vertices);
        for (FlatPart& part : parts_) build(part);
        measureReach();
        return std::move(out_);
    }

private:
    using EdgeKey = std::array<int64_t, 2>; // vertices, the lower number first

    void findCuts(FlatPart& part) {
        const auto& [low, high] = part.box;
        std::vector<glm::dvec2> hull{low, {high.x, low.y}, high, {low.x, high.y}};
        if (part.pieces.size() == 1) hull.assign(part.pieces[0].corner.begin(), part.pieces[0].corner.end());
        outline_.clear();
        for (size_t b = 0; b < beams_.size(); ++b) {
            const Beam& beam = beams_[b];
            const double least = options_.atAnyAngle >> b & 1u ? 0 : options_.leastCosine;
            const bool curved = !part.normals.empty() && least > 0;
            part.views.push_back(viewOfPlane(part.frame, hull, beam, curved ? 0 : least));
            if (curved) part.limit(beam.centre, mesh_.vertices, least);
            appendOutline(part.views.back(), part.box, part.limitLines(), outline_);
        }
        if (outline_.empty()) return;
        part.cuts = clipToRegion(outline_, part.border);
        for (const Cut& cut : part.cuts)
            for (const CutEnd& end : cut)
                if (end.edge >= 0 && end.t > 0 && end.t < 1) {
                    const auto [a, b] = part.borderEdge(static_cast<size_t>(end.edge));
                    edgeCuts_[keyOf(a, b)].push_back(a < b ? end.t : 1 - end.t);
                    cutVertices_[a] = cutVertices_[b] = true;
                }
    }

    static EdgeKey keyOf(uint32_t a, uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

    // Where the edge is cut, from the lower of its vertices on; null when nowhere.
    const std::vector<double>* cutsOf(uint32_t a, uint32_t b) const {
        if (!cutVertices_[a] || !cutVertices_[b]) return nullptr;
        const auto found = edgeCuts_.find(keyOf(a, b));
        return found == edgeCuts_.end() ? nullptr : &found->second;
    }

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
        for (uint32_t copy = copies_[v]; copy != Piece::kNone; copy = cornerCopies_[copy].next)
            if (cornerCopies_[copy].surface == surface) return cornerCopies_[copy].vertex;
        const auto made = static_cast<uint32_t>(out_.vertices.size());
        cornerCopies_.push_back({surface, made, copies_[v]});
        copies_[v] = static_cast<uint32_t>(cornerCopies_.size() - 1);
        addVertex(mesh_.vertices[v], {v, v, v}, {1, 0, 0}, ProjectorMesh::kCorner);
        return made;
    }

    uint32_t edgeVertex(const EdgeKey& edge, size_t index, uint32_t surface, uint32_t patch) {
        const auto [place, isNew] =
            edgeVertices_.try_emplace({edge[0], edge[1], static_cast<int64_t>(index), surface},
                                      static_cast<uint32_t>(out_.vertices.size()));
        if (isNew) {
            const double t = edgeCuts_.at(edge)[index];
            const auto a = static_cast<uint32_t>(edge[0]), b = static_cast<uint32_t>(edge[1]);
            addVertex(mesh_.vertices[a] + t * (mesh_.vertices[b] - mesh_.vertices[a]), {a, b, a},
                      {1 - t, t, 0}, patch);
        }
        return place->second;
    }

    void addVertex(glm::dvec3 p, std::array<uint32_t, 3> source, glm::dvec3 weight, uint32_t patch) {
        out_.vertices.push_back(p);
        out_.sourceVertex.push_back(source);
        out_.sourceWeight.emplace_back(weight);
        out_.vertexPatch.push_back(patch);
    }

    // `beneath`: the piece under its middle.
    void addTriangle(const std::array<uint32_t, 3>& vertex, glm::dvec2 middle, const Piece& beneath,
                     const FlatPart& part) {
        out_.triangles.insert(out_.triangles.end(), vertex.begin(), vertex.end());
        out_.sourcePatch.push_back(beneath.patch);
        out_.visible.push_back(part.seenFrom(beneath, middle));
    }

    // As it is in the mesh.
    void keep(const Piece& piece, const FlatPart& part) {
        std::array<uint32_t, 3> vertex{};
        for (size_t k = 0; k < 3; ++k) vertex[k] = cornerVertex(part.vertices[piece.vertex[k]], part.surface);
        addTriangle(vertex, (piece.corner[0] + piece.corner[1] + piece.corner[2]) / 3.0, piece, part);
    }

    void build(FlatPart& part) {
        cutEdges_.clear();
        for (size_t e = 0; e < part.border.size(); ++e) {
            const auto [a, b] = part.borderEdge(e);
            cutEdges_.push_back(cutsOf(a, b));
        }
        if (part.cuts.empty() && std::ranges::all_of(cutEdges_, [](const auto* cuts) { return !cuts; })) {
            for (const Piece& piece : part.pieces) keep(piece, part);
        } else {
            rebuild(part);
        }
    }

    // A border edge with the points that cuts have made on it, as indices of the region's border points.
    struct Chain {
        std::vector<uint32_t> points;
        std::vector<double> places; // 0 .. 1
    };

    // What of a part is meshed anew.
    struct Remeshed {
        std::vector<bool> touched; // per piece
        Region region;
        std::vector<uint32_t> vertices; // of the result, per point of the region
        std::vector<uint32_t> onBorder; // per vertex of the part: its point of the region's border, or kNone
        std::vector<Chain> chains;      // per border edge of the part; empty where nothing is touched
    };

    // Pieces that lines or points on the border come near are meshed anew, the others stay.
    void rebuild(FlatPart& part) {
        Remeshed anew;
        anew.region.spacing = part.spacing();
        const PieceGrid grid(part.pieces, part.box, 1.5 * anew.region.spacing);
        anew.touched = touchedPieces(part, grid, anew.region.spacing);
        for (size_t i = 0; i < part.pieces.size(); ++i)
            if (!anew.touched[i]) keep(part.pieces[i], part);

        anew.onBorder.assign(part.vertices.size(), Piece::kNone);
        addChains(part, anew);
        addRim(part, anew);
        addLines(part, anew);
        const std::vector<uint32_t> seeds = addSeeds(part, anew.touched, anew.onBorder, anew.region);
        addMeshed(part, grid, seeds, meshRegion(anew.region), anew.vertices);
    }

    uint32_t borderPoint(const FlatPart& part, const Piece& piece, size_t k, Remeshed& anew) {
        uint32_t& place = anew.onBorder[piece.vertex[k]];
        if (place == Piece::kNone) {
            place = static_cast<uint32_t>(anew.region.border.size());
            anew.region.border.push_back(piece.corner[k]);
            anew.vertices.push_back(cornerVertex(part.vertices[piece.vertex[k]], part.surface));
        }
        return place;
    }

    // The part's own border, with the points that cuts have made on it and without vertices that are spare.
    void addChains(const FlatPart& part, Remeshed& anew) {
        Region& region = anew.region;
        anew.chains.resize(part.border.size());
        std::map<uint32_t, std::array<uint32_t, 2>> across; // points before and after a spare vertex
        for (size_t e = 0; e < part.border.size(); ++e) {
            const auto [i, k] = part.borderSides[e];
            if (!anew.touched[i]) continue;
            const auto [a, b] = part.borderEdge(e);
            Chain& chain = anew.chains[e];
            if (!spare_[a]) {
                chain.points.push_back(borderPoint(part, part.pieces[i], k, anew));
                chain.places.push_back(0);
            }
            const size_t n = cutEdges_[e] ? cutEdges_[e]->size() : 0;
            for (size_t c = 0; c < n; ++c) {
                const size_t index = a < b ? c : n - 1 - c;
                const double t = (*cutEdges_[e])[index];
                chain.points.push_back(static_cast<uint32_t>(region.border.size()));
                chain.places.push_back(a < b ? t : 1 - t);
                anew.vertices.push_back(edgeVertex(keyOf(a, b), index, part.surface, part.pieces[i].patch));
                region.border.push_back(part.frame.flat(out_.vertices[anew.vertices.back()]));
            }
            if (!spare_[b]) {
                chain.points.push_back(borderPoint(part, part.pieces[i], (k + 1) % 3, anew));
                chain.places.push_back(1);
            }
            for (size_t c = 0; c + 1 < chain.points.size(); ++c)
                region.borderEdges.emplace_back(chain.points[c], chain.points[c + 1]);
            if (spare_[a]) across[a][1] = chain.points.front();
            if (spare_[b]) across[b][0] = chain.points.back();
        }
        for (const auto& [v, points] : across) region.borderEdges.emplace_back(points[0], points[1]);
    }

    // The border towards pieces that stay.
    void addRim(const FlatPart& part, Remeshed& anew) {
        for (size_t i = 0; i < part.pieces.size(); ++i)
            for (size_t k = 0; k < 3 && anew.touched[i]; ++k) {
                const Piece& piece = part.pieces[i];
                if (piece.neighbour[k] == Piece::kNone || anew.touched[piece.neighbour[k]]) continue;
                const uint32_t from = borderPoint(part, piece, k, anew),
                               to = borderPoint(part, piece, (k + 1) % 3, anew);
                anew.region.borderEdges.emplace_back(from, to);
            }
    }

    static void addLines(const FlatPart& part, Remeshed& anew) {
        for (const Cut& cut : part.cuts) {
            RegionLine line;
            for (size_t k = 0; k < 2; ++k) {
                line.point[k] = cut[k].point;
                if (cut[k].edge >= 0)
                    line.border[k] =
                        static_cast<int>(nearest(anew.chains[static_cast<size_t>(cut[k].edge)], cut[k].t));
            }
            anew.region.lines.push_back(line);
        }
    }

    // `vertices`: of the mesh's border points; the others' are appended.
    void addMeshed(const FlatPart& part, const PieceGrid& grid, const std::vector<uint32_t>& seeds,
                   const RegionMesh& mesh, std::vector<uint32_t>& vertices) {
        for (const uint32_t s : mesh.keptSeeds) vertices.push_back(cornerVertex(seeds[s], part.surface));
        for (size_t i = vertices.size(); i < mesh.points.size(); ++i) {
            const Piece& piece = part.pieces[grid.at(mesh.points[i])];
            std::array<uint32_t, 3> source{};
            for (size_t k = 0; k < 3; ++k) source[k] = part.vertices[piece.vertex[k]];
            vertices.push_back(static_cast<uint32_t>(out_.vertices.size()));
            addVertex(part.frame.inSpace(mesh.points[i]), source, piece.barycentric(mesh.points[i]),
                      piece.patch);
        }
        for (const auto& t : mesh.triangles) {
            const glm::dvec2 middle = (mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]]) / 3.0;
            addTriangle({vertices[t[0]], vertices[t[1]], vertices[t[2]]}, middle,
                        part.pieces[grid.at(middle)], part);
        }
    }

    std::vector<bool> touchedPieces(const FlatPart& part, const PieceGrid& grid, double spacing) const {
        constexpr double kMargin = 0.3; // of the spacing: lines stay as far away from what is not meshed anew
        std::vector<bool> touched(part.pieces.size());
        for (size_t i = 0; i < touched.size(); ++i)
            touched[i] = std::ranges::any_of(part.pieces[i].vertex,
                                             [&](uint32_t v) { return spare_[part.vertices[v]]; });
        for (const Cut& cut : part.cuts) {
            grid.markNear({cut[0].point, cut[1].point}, kMargin * spacing, touched);
            for (const CutEnd& end : cut)
                if (end.edge >= 0) touched[part.borderSides[static_cast<size_t>(end.edge)].piece] = true;
        }
        for (size_t e = 0; e < part.border.size(); ++e)
            if (cutEdges_[e]) {
                touched[part.borderSides[e].piece] = true;
                const auto [a, b] = part.borderEdge(e);
                for (const double t : *cutEdges_[e]) {
                    const glm::dvec2 p = part.border[e][a < b ? 0 : 1], q = part.border[e][a < b ? 1 : 0];
                    grid.markNear({p + t * (q - p), p + t * (q - p)}, kMargin * spacing, touched);
                }
            }
        return touched;
    }

    static uint32_t nearest(const Chain& chain, double t) {
        size_t best = 0;
        for (size_t k = 1; k < chain.points.size(); ++k)
            if (std::abs(chain.places[k] - t) < std::abs(chain.places[best] - t)) best = k;
        return chain.points[best];
    }

    // The vertices of the mesh inside the region, with the mean length of the edges there.
    std::vector<uint32_t> addSeeds(const FlatPart& part, const std::vector<bool>& touched,
                                   const std::vector<uint32_t>& onBorder, Region& region) const {
        std::vector<uint32_t> seeds, known(part.vertices.size(), Piece::kNone);
        std::vector<double> count;
        for (size_t i = 0; i < part.pieces.size(); ++i) {
            if (!touched[i]) continue;
            const Piece& piece = part.pieces[i];
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t v = piece.vertex[k];
                if (onBorder[v] != Piece::kNone || spare_[part.vertices[v]]) continue;
                if (known[v] == Piece::kNone) {
                    known[v] = static_cast<uint32_t>(seeds.size());
                    seeds.push_back(part.vertices[v]);
                    region.seeds.push_back(piece.corner[k]);
                    region.seedSpacing.push_back(0);
                    count.push_back(0);
                }
                region.seedSpacing[known[v]] += glm::length(piece.corner[(k + 1) % 3] - piece.corner[k]);
                ++count[known[v]];
            }
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
    ProjectorOptions options_;
    std::vector<FlatPart> parts_;
    std::vector<ConvexSolid> casters_;
    std::vector<Beam> beams_; // per projector
    std::unordered_map<EdgeKey, std::vector<double>, KeyHash> edgeCuts_;
    std::vector<bool> cutVertices_;                    // of the mesh: ends of edges that are cut
    std::vector<bool> spare_;                          // of the mesh: make way for cuts beside them
    std::vector<const std::vector<double>*> cutEdges_; // of the part at hand, per border edge, or null
    std::vector<Segment> outline_;                     // likewise
    struct CornerCopy {
        uint32_t surface, vertex, next; // vertex of the result; next copy of the same corner
    };
    std::vector<CornerCopy> cornerCopies_;
    std::vector<uint32_t> copies_; // per vertex of the mesh: the last of its copies
    std::unordered_map<std::array<int64_t, 4>, uint32_t, KeyHash> edgeVertices_;
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
