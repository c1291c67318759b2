#include "geometry/standing_faces.h"

#include <algorithm>

#include <glm/geometric.hpp>

#include "geometry/constrained_delaunay.h"
#include "geometry/disjoint_sets.h"
#include "geometry/perpendicular.h"

namespace heliodon::geometry {

namespace {

constexpr double kLooksDown = 0.2; // of a normal: walls may lean in by 12 degrees
constexpr double kStraight = 1e-9; // sine of an angle

using Polygon = std::vector<uint32_t>; // counter-clockwise

// More than zero where it turns to the left at b.
double turn(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
    return cross(b - a, c - b) / (glm::length(b - a) * glm::length(c - b));
}

// Few convex polygons of a part, by corners of the part: after Hertel and Mehlhorn, triangles of its outline
// joined wherever that makes no corner that looks in.
class ConvexPieces {
public:
    explicit ConvexPieces(const FlatPart& part) : part_(part), at_(part.vertices.size()) {
        for (const Piece& piece : part.pieces)
            for (size_t k = 0; k < 3; ++k) at_[piece.vertex[k]] = piece.corner[k];
    }

    std::vector<Polygon> make() {
        if (!triangulate())
            for (const Piece& piece : part_.pieces)
                polygons_.emplace_back(piece.vertex.begin(), piece.vertex.end());
        std::erase_if(polygons_, [](const Polygon& polygon) { return polygon.empty(); });
        for (Polygon& polygon : polygons_) dropStraight(polygon);
        return std::move(polygons_);
    }

private:
    bool triangulate() {
        std::vector<uint32_t> place(at_.size(), Piece::kNone), corners;
        std::vector<glm::dvec2> points;
        std::vector<std::pair<uint32_t, uint32_t>> edges;
        const auto pointOf = [&](uint32_t corner) {
            if (place[corner] == Piece::kNone) {
                place[corner] = static_cast<uint32_t>(points.size());
                points.push_back(at_[corner]);
                corners.push_back(corner);
            }
            return place[corner];
        };
        for (const auto& [piece, k] : part_.borderSides) {
            const auto& v = part_.pieces[piece].vertex;
            edges.emplace_back(pointOf(v[k]), pointOf(v[(k + 1) % 3]));
        }
        const auto net = constrainedDelaunay(points, edges);
        if (!net) return false;
        for (const auto& t : net->corner) polygons_.push_back({corners[t[0]], corners[t[1]], corners[t[2]]});
        DisjointSets joined(polygons_.size()); // triangles; the root names the polygon
        for (uint32_t t = 0; t < net->corner.size(); ++t)
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t other = net->neighbour[t][k];
                if (net->fixed[t][k] || other == kNoTriangle || other < t) continue;
                const uint32_t one = joined.root(t), two = joined.root(other);
                if (join(polygons_[one], polygons_[two], corners[net->corner[t][(k + 1) % 3]],
                         corners[net->corner[t][(k + 2) % 3]]))
                    joined.join(two, one);
            }
        return true;
    }

    // Across the edge from `from` to `to` of the first; false, and nothing done, where that is not convex.
    bool join(Polygon& one, Polygon& two, uint32_t from, uint32_t to) const {
        std::ranges::rotate(one, std::ranges::find(one, to));
        std::ranges::rotate(two, std::ranges::find(two, from));
        const auto convex = [&](uint32_t before, uint32_t corner, uint32_t after) {
            return turn(at_[before], at_[corner], at_[after]) > -kStraight;
        };
        if (!convex(one[one.size() - 2], from, two[1]) || !convex(two[two.size() - 2], to, one[1]))
            return false;
        one.insert(one.end(), two.begin() + 1, two.end() - 1);
        two.clear();
        return true;
    }

    void dropStraight(Polygon& polygon) const {
        Polygon kept;
        for (size_t k = 0; k < polygon.size(); ++k) {
            const uint32_t before = kept.empty() ? polygon.back() : kept.back();
            if (turn(at_[before], at_[polygon[k]], at_[polygon[(k + 1) % polygon.size()]]) > kStraight)
                kept.push_back(polygon[k]);
        }
        if (kept.size() >= 3) polygon = std::move(kept);
    }

    const FlatPart& part_;
    std::vector<glm::dvec2> at_; // per vertex of the part
    std::vector<Polygon> polygons_;
};

} // namespace

std::vector<ConvexSolid> standingFaces(std::span<const FlatPart> parts, const std::vector<glm::dvec3>& at) {
    std::vector<ConvexSolid> solids;
    for (const FlatPart& part : parts) {
        if (part.frame.normal.y < -kLooksDown) continue;
        for (const Polygon& polygon : ConvexPieces(part).make()) {
            ConvexSolid& solid = solids.emplace_back();
            for (uint32_t k = 0; k < polygon.size(); ++k) {
                solid.corners.push_back(at[part.vertices[polygon[k]]]);
                solid.edges.emplace_back(k, static_cast<uint32_t>((k + 1) % polygon.size()));
            }
        }
    }
    return solids;
}

} // namespace heliodon::geometry
