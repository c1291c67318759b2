// The triangles of a mesh that lie on one surface and in one plane, with what projectors see of them.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "geometry/patch_mesh.h"
#include "geometry/plane_view.h"
#include "geometry/region_mesh.h"

namespace heliodon::geometry {

struct Piece {
    static constexpr uint32_t kNone = 0xffffffffu;

    std::array<glm::dvec2, 3> corner{};
    std::array<uint32_t, 3> vertex{};                       // of the part
    std::array<uint32_t, 3> neighbour{kNone, kNone, kNone}; // the piece beyond the edge from corner k on
    uint32_t patch = 0;

    glm::dvec3 barycentric(glm::dvec2 p) const;
};

struct FlatPart {
    PlaneFrame frame;
    uint32_t surface = 0;
    std::vector<uint32_t> vertices; // of the mesh, per vertex of the part
    std::vector<Piece> pieces;
    FlatBox box;
    std::vector<glm::dvec3> normals; // cornerNormals() per vertex of the part; none on flat surfaces
    std::vector<PlaneView> views;
    // On curved surfaces, per view: by how much n . d exceeds its least at each vertex of the part, n turning
    // smoothly from facet to facet and the excess linear over each piece; empty where it does so everywhere,
    // for views at any angle, and on flat surfaces, whose views keep to the limit themselves.
    std::vector<std::vector<double>> excess;
    std::vector<Cut> cuts; // their edges are those of `border`
    struct Side {
        uint32_t piece, corner; // the edge from there on
    };
    std::vector<Side> borderSides; // without a piece beyond
    std::vector<Segment> border;   // the same in the plane
    // Vertices of the mesh, the part on their left.
    std::pair<uint32_t, uint32_t> borderEdge(size_t edge) const;

    // Fills in box, neighbours and border.
    void link();
    // Edge length of a regular triangle of the mean area.
    double spacing() const;
    // Adds `excess` for the last of the views, that from `centre`. `at`: the vertices of the mesh.
    void limit(glm::dvec3 centre, const std::vector<glm::dvec3>& at, double leastCosine);
    // Where the excess of the last of the views is zero.
    std::vector<Segment> limitLines() const;
    // Those of the views, as bits, that reach a point of a piece.
    uint32_t seenFrom(const Piece& piece, glm::dvec2 p) const;
};

// Of all patches whose role is `projection`; views, cuts and limits stay empty.
std::vector<FlatPart> flatParts(const PatchMesh& mesh);

// The pieces of a part by cells of a grid.
class PieceGrid {
public:
    PieceGrid(const std::vector<Piece>& pieces, const FlatBox& box, double cell);

    // The piece that a point lies in, or, by a rounding error beside all, the nearest.
    uint32_t at(glm::dvec2 p) const;
    // Marks all pieces that come within `margin` of the segment, and some little farther away.
    void markNear(const Segment& segment, double margin, std::vector<bool>& marked) const;

private:
    int column(double x) const;
    int row(double y) const;
    template<class Visit> void eachCell(const FlatBox& box, Visit visit) const;

    const std::vector<Piece>& pieces_;
    glm::dvec2 low_;
    double cell_;
    int columns_ = 1, rows_ = 1;
    std::vector<uint32_t> first_, items_;
};

} // namespace heliodon::geometry
