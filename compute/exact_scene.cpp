#include "compute/exact_scene.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <future>
#include <set>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "compute/closed_solid.h"
#include "compute/convex_regions.h"
#include "compute/exact_clusters.h"
#include "compute/gpu/device.h"
#include "compute/narrow_gaps.h"
#include "geometry/bounds.h"
#include "geometry/outline_area.h"
#include "shaders/io/exact_form_factors.io.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

// A position from the scene's centre in two floats a coordinate.
void splitPosition(const dvec3& relative, glm::vec3& high, glm::vec3& low) {
    for (int c = 0; c < 3; ++c) {
        // Through memory: GCC 12 at -O3 otherwise takes the float back to the double it came from.
        volatile float rounded = static_cast<float>(relative[c]);
        high[c] = rounded;
        low[c] = static_cast<float>(relative[c] - static_cast<double>(rounded));
    }
}

// A position in the frame of exact_scene.glsl: of a sliver that lies askew, float32 would lose the width.
glm::dvec2 inPlane(const std::vector<dvec3>& corners, const dvec3& normal, const dvec3& p) {
    const dvec3 edge = corners[1] - corners[0], along = edge - glm::dot(edge, normal) * normal;
    const double size = glm::length(along);
    if (!(size > 0)) return {0, 0};
    const dvec3 u = along / size, d = p - corners[0];
    return {glm::dot(d, u), glm::dot(d, glm::cross(normal, u))};
}

struct Faces {
    dvec3 centre{0}; // subtracted from all corners
    std::vector<glm::vec4> high, low, normal, middle;
    std::vector<glm::uvec4> range;

    // `normal` and the first corner fix the plane; zero area makes a face that faces nothing.
    // `more`: of pieces their place in the tile, of blockers whether they bound a solid.
    void add(const std::vector<dvec3>& corners, const dvec3& unitNormal, uint32_t room, uint32_t more = 0) {
        range.push_back(
            {static_cast<uint32_t>(high.size()), static_cast<uint32_t>(corners.size()), room, more});
        dvec3 area{0}, weighted{0};
        double total = 0;
        for (size_t k = 1; k + 1 < corners.size(); ++k) {
            const dvec3 u = corners[k] - corners[0], v = corners[k + 1] - corners[0],
                        c = 0.5 * glm::cross(u, v);
            area += c;
            weighted += glm::length(c) * (u + v) / 3.0;
            total += glm::length(c);
        }
        const dvec3 middleD = corners[0] + (total > 0 ? weighted / total : dvec3(0));
        double radius = 0;
        for (const dvec3& p : corners) {
            glm::vec3 h, l;
            splitPosition(p - centre, h, l);
            const glm::vec2 flat(inPlane(corners, unitNormal, p));
            high.emplace_back(h, flat.x);
            low.emplace_back(l, flat.y);
            radius = std::max(radius, glm::length(p - middleD));
        }
        normal.emplace_back(glm::vec3(total > 0 ? unitNormal : dvec3(0)), static_cast<float>(total));
        middle.emplace_back(glm::vec3(middleD - corners[0]), static_cast<float>(radius));
    }
};

dvec3 unitOrZero(const dvec3& v) {
    const double size = glm::length(v);
    return size > 0 ? v / size : dvec3(0);
}

constexpr double kNarrow =
    1e-6; // of faces' sizes: gaps that heights in float32, see kFlat, do not tell surely
// Behind more blockers than kCrowd fewer than kFewPieces are cut into about kCutPieces (measured: louvres).
constexpr size_t kCrowd = 12, kFewPieces = 150, kCutPieces = 500;
// Needles, of less than so much of their length's square, are cut to so many roots of a piece's area (all
// twice the area): few points along the narrow face of a board err alike towards all parts of a wall. At most
// kMostCut times as many pieces come of that.
constexpr double kNeedle = 0.2, kLongest = 0.8;
constexpr size_t kMostCut = 4;
constexpr double kSliver = 1e-7; // of a patch: triangles that are what rounding left of cuts

// Patches of many corners are cut into fans; of those that others cover across a narrow gap what is left,
// into triangles, for which most is made.
std::vector<RadiatingPiece> piecesOf(const geometry::PatchMesh& mesh, std::span<const uint32_t> planes,
                                     const NarrowGaps& gaps) {
    std::vector<RadiatingPiece> pieces;
    const auto add = [&](const std::vector<dvec3>& outline, size_t i, size_t most, double least) {
        const dvec3 normal = unitOrZero(geometry::patchAreaVector(mesh, i));
        for (size_t first = 1; first + 1 < outline.size(); first += most - 2) {
            std::vector<dvec3> corners{outline[0]};
            for (size_t k = first; k < std::min(outline.size(), first + most - 1); ++k)
                corners.push_back(outline[k]);
            if (glm::length(geometry::areaVector(corners)) <= least) continue;
            double size = 0;
            for (const dvec3& p : corners) size = std::max(size, glm::distance(p, corners[0]));
            pieces.push_back(
                {std::move(corners), normal, static_cast<uint32_t>(i), mesh.room[i], planes[i], 0, size});
        }
    };
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const auto open = gaps.open.find(static_cast<uint32_t>(i));
        if (open == gaps.open.end())
            add(geometry::patchCorners(mesh, i), i, io::kExactPieceCorners, -1); // without area too
        else
            for (const std::vector<dvec3>& part : open->second)
                add(part, i, 3, kSliver * geometry::patchArea(mesh, i));
    }
    // All is covered: a point, which sees nothing, stands for a tile.
    if (pieces.empty() && mesh.patchCount() > 0)
        pieces.push_back({std::vector<dvec3>(3, dvec3(0)), dvec3(0), 0, mesh.room[0], planes[0], 0, 0});
    return pieces;
}

// Triangles, halved across their longest edge until none is larger than `most`, nor a needle longer than
// `longest`.
void cut(const RadiatingPiece& piece, double most, double longest, std::vector<RadiatingPiece>& parts) {
    const std::vector<dvec3>& p = piece.corners;
    if (p.size() > 3) {
        for (size_t k = 1; k + 1 < p.size(); ++k) {
            RadiatingPiece part = piece;
            part.corners = {p[0], p[k], p[k + 1]};
            cut(part, most, longest, parts);
        }
        return;
    }
    RadiatingPiece half = piece;
    half.size = std::max(glm::distance(p[0], p[1]), glm::distance(p[0], p[2]));
    size_t k = 0; // the longest edge begins there
    for (size_t e : {1, 2})
        if (glm::distance(p[e], p[(e + 1) % 3]) > glm::distance(p[k], p[(k + 1) % 3])) k = e;
    const dvec3 a = p[k], b = p[(k + 1) % 3], c = p[(k + 2) % 3], middle = 0.5 * (a + b);
    const double area = glm::length(geometry::areaVector(p)), edge = glm::distance(a, b);
    const bool needle = area < kNeedle * edge * edge && edge > longest;
    if (!(area > most) && !needle) return parts.push_back(std::move(half));
    half.corners = {a, middle, c};
    cut(half, most, longest, parts);
    half.corners = {middle, b, c};
    cut(half, most, longest, parts);
}

// What stands between two large pieces is all walked along from each point of either; small ones have little
// between them, and near ones less to err by.
std::vector<RadiatingPiece> cutPieces(std::span<const RadiatingPiece> pieces, size_t count) {
    double area = 0;
    for (const RadiatingPiece& piece : pieces) area += glm::length(geometry::areaVector(piece.corners));
    const double most = area / static_cast<double>(count);
    std::vector<RadiatingPiece> parts;
    for (double longest = kLongest * std::sqrt(most);; longest *= 2) {
        parts.clear();
        for (const RadiatingPiece& piece : pieces) cut(piece, most, longest, parts);
        if (parts.size() <= kMostCut * count || !(longest < HUGE_VAL)) return parts;
    }
}

struct Blockers {
    std::vector<ConvexRegion> regions;
    std::vector<bool> ofSolids;
};

// Of a sheet with two sides one blocks: in float32 the border of two shadows that are one may count twice, or
// not at all. Of solids, whose fronts alone block, both do.
Blockers blockersOf(const geometry::PatchMesh& mesh) {
    std::vector<ConvexRegion> all = blockingRegions(mesh, io::kExactBlockerCorners);
    const std::vector<bool> ofSolids = regionsOfSolids(mesh, all);
    std::set<std::pair<uint32_t, std::vector<std::array<double, 3>>>> outlines;
    Blockers blockers;
    for (size_t k = 0; k < all.size(); ++k) {
        std::vector<std::array<double, 3>> outline;
        for (const dvec3& p : all[k].corners) outline.push_back({p.x, p.y, p.z});
        std::ranges::sort(outline);
        if (!ofSolids[k] && !outlines.emplace(all[k].room, std::move(outline)).second) continue;
        blockers.regions.push_back(std::move(all[k]));
        blockers.ofSolids.push_back(ofSolids[k]);
    }
    return blockers;
}

std::vector<ExactScene::Covered> coveredOf(const NarrowGaps& gaps) {
    std::vector<ExactScene::Covered> covered;
    for (const NarrowGaps::Overlap& overlap : gaps.overlaps) {
        const double border = geometry::perimeter(overlap.outline), area = overlap.area();
        covered.push_back({overlap.first, overlap.second, area, std::min(0.5 * overlap.gap * border, area)});
    }
    return covered;
}

std::vector<ExactTileRange> tilesOf(std::vector<RadiatingPiece>& pieces, uint32_t most, uint32_t patchCount) {
    std::vector<ExactTileRange> tiles;
    for (uint32_t begin = 0; begin < pieces.size();) {
        uint32_t end = begin;
        while (end < pieces.size()) { // patch by patch
            uint32_t next = end + 1;
            while (next < pieces.size() && pieces[next].patch == pieces[end].patch) ++next;
            if (end > begin && next - begin > most) break;
            end = next;
        }
        for (uint32_t k = begin; k < end; ++k) pieces[k].place = k - begin;
        tiles.push_back({pieces[begin].patch, 0, begin, end - begin, 0, 0});
        begin = end;
    }
    // Patches without pieces (fewer than three corners, or covered) belong to a neighbour.
    for (size_t k = 0; k < tiles.size(); ++k) {
        tiles[k].firstPatch = k == 0 ? 0 : tiles[k].firstPatch;
        const uint32_t next = k + 1 < tiles.size() ? tiles[k + 1].firstPatch : patchCount;
        tiles[k].patches = next - tiles[k].firstPatch;
        tiles[k].piecesArePatches = tiles[k].pieces == tiles[k].patches;
        for (uint32_t p = 0; p < tiles[k].pieces; ++p)
            if (pieces[tiles[k].firstPiece + p].patch != tiles[k].firstPatch + p)
                tiles[k].piecesArePatches = false;
    }
    return tiles;
}

} // namespace

ExactScene exactScene(gpu::Device& device, const geometry::PatchMesh& mesh, uint32_t tilePieces,
                      bool cutsCrowds) {
    ExactScene scene;
    scene.patchCount = static_cast<uint32_t>(mesh.patchCount());
    Faces faces;
    const geometry::Bounds box = geometry::boundsOf(mesh.vertices);
    scene.centre = faces.centre = box.centre();
    scene.samePlane = static_cast<float>(kSamePlane * box.diagonal());
    // Half of the work, beside the other.
    std::future<Blockers> blockers = std::async(std::launch::async, [&] { return blockersOf(mesh); });
    const std::vector<uint32_t> planes = planeNumbers(mesh);
    const NarrowGaps gaps = narrowGaps(mesh, planes, kNarrow);
    scene.covered = coveredOf(gaps);
    std::vector<RadiatingPiece> pieces = piecesOf(mesh, planes, gaps);
    const auto [regions, ofSolids] = blockers.get();
    if (cutsCrowds && regions.size() > kCrowd && pieces.size() < kFewPieces)
        pieces = cutPieces(pieces, kCutPieces);
    for (size_t i = 0; i < mesh.patchCount(); ++i) scene.patchArea.push_back(geometry::patchArea(mesh, i));
    scene.pieceCount = static_cast<uint32_t>(pieces.size());
    scene.tiles = tilesOf(pieces, tilePieces, scene.patchCount);
    std::vector<PieceCluster> clusters;
    for (ExactTileRange& tile : scene.tiles) {
        tile.firstCluster = static_cast<uint32_t>(clusters.size());
        for (PieceCluster& cluster :
             clusterPieces(std::span(pieces).subspan(tile.firstPiece, tile.pieces), tile.firstPiece))
            clusters.push_back(std::move(cluster));
        tile.clusters = static_cast<uint32_t>(clusters.size()) - tile.firstCluster;
        tile.piecesArePatches = tile.piecesArePatches && scene.covered.empty();
    }
    std::vector<glm::uvec2> rowOfPiece;
    for (const RadiatingPiece& piece : pieces) {
        scene.mostCorners = std::max(scene.mostCorners, static_cast<uint32_t>(piece.corners.size()));
        faces.add(piece.corners, piece.normal, piece.room, piece.place);
        const float area = faces.normal.back().w;
        scene.area.push_back(area);
        scene.shareOfPatch.push_back(
            area > 0 ? static_cast<float>(std::min(1.0, double{area} / scene.patchArea[piece.patch])) : 0.0f);
        rowOfPiece.emplace_back(piece.patch, std::bit_cast<uint32_t>(scene.shareOfPatch.back()));
    }
    for (size_t k = 0; k < regions.size(); ++k)
        faces.add(regions[k].corners, unitOrZero(geometry::areaVector(regions[k].corners)), regions[k].room,
                  ofSolids[k] ? 1 : 0);
    scene.blockerCount = static_cast<uint32_t>(regions.size());
    std::vector<glm::uvec4> clusterData;
    for (const PieceCluster& cluster : clusters) {
        clusterData.emplace_back(cluster.first, cluster.count, faces.range.size(), cluster.flat ? 1u : 0u);
        const std::vector<dvec3> point(3, pieces[cluster.first].corners[0]);
        faces.add(cluster.flat ? cluster.rectangle : point, cluster.normal, cluster.room);
    }
    scene.cornerHigh = gpu::Buffer::from(device, faces.high, "exact corners, high");
    scene.cornerLow = gpu::Buffer::from(device, faces.low, "exact corners, low");
    scene.faceNormal = gpu::Buffer::from(device, faces.normal, "exact normals");
    scene.faceCentre = gpu::Buffer::from(device, faces.middle, "exact centres");
    scene.faceRange = gpu::Buffer::from(device, faces.range, "exact ranges");
    scene.rowOfPiece = gpu::Buffer::from(device, rowOfPiece, "exact rows");
    scene.pieces = std::move(pieces);
    scene.clusters = gpu::Buffer::from(device, clusterData, "exact clusters");
    return scene;
}

} // namespace heliodon::compute
