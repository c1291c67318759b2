#include "geometry/unrolled_wall.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"

namespace heliodon::geometry {

namespace {

constexpr double kUpright = 0.3; // sine of how far a facet leans at most

bool isUpright(const FlatPart& part) {
    return !part.normals.empty() && std::abs(part.frame.normal.y) < kUpright &&
           std::ranges::all_of(part.normals, [](glm::dvec3 n) { return std::abs(n.y) < kUpright; });
}

// The facets of one wall.
class Unroller {
public:
    Unroller(std::vector<FlatPart>& facets, const PatchMesh& mesh, std::vector<uint32_t>& place)
        : facets_(facets), place_(place) {
        for (const FlatPart& facet : facets)
            for (size_t v = 0; v < facet.vertices.size(); ++v) {
                uint32_t& at = place_[facet.vertices[v]];
                if (at != Piece::kNone) continue;
                at = static_cast<uint32_t>(points_.size());
                vertices_.push_back(facet.vertices[v]);
                points_.push_back(mesh.vertices[facet.vertices[v]]);
                along_.push_back(glm::normalize(glm::cross(glm::dvec3(0, 1, 0), facet.normals[v])));
            }
        connect();
        walk();
    }

    ~Unroller() {
        for (const uint32_t v : vertices_) place_[v] = Piece::kNone;
    }

    void addTo(std::vector<FlatPart>& out) {
        std::map<uint32_t, std::vector<FlatPart>> connected;
        for (FlatPart& facet : facets_)
            if (fits(facet))
                connected[component_[place_[facet.vertices[0]]]].push_back(std::move(facet));
            else
                out.push_back(std::move(facet));
        for (auto& [component, facets] : connected)
            if (facets.size() == 1)
                out.push_back(std::move(facets[0]));
            else
                out.push_back(sheetOf(std::move(facets)));
    }

private:
    void connect() {
        first_.assign(points_.size() + 1, 0);
        const auto eachSide = [&](auto visit) {
            for (const FlatPart& facet : facets_)
                for (const Piece& piece : facet.pieces)
                    for (size_t k = 0; k < 3; ++k)
                        for (const size_t other : {(k + 1) % 3, (k + 2) % 3})
                            visit(place_[facet.vertices[piece.vertex[k]]],
                                  place_[facet.vertices[piece.vertex[other]]]);
        };
        eachSide([&](uint32_t from, uint32_t) { ++first_[from + 1]; });
        for (size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
        neighbours_.resize(first_.back());
        std::vector<uint32_t> at(first_.begin(), first_.end() - 1);
        eachSide([&](uint32_t from, uint32_t to) { neighbours_[at[from]++] = to; });
    }

    // From neighbour to neighbour, each as far along as the chord reaches between the two.
    void walk() {
        flat_.resize(points_.size());
        component_.assign(points_.size(), Piece::kNone);
        std::vector<uint32_t> reached;
        for (uint32_t start = 0; start < points_.size(); ++start) {
            if (component_[start] != Piece::kNone) continue;
            component_[start] = start;
            flat_[start] = {0, points_[start].y};
            reached.assign(1, start);
            for (size_t r = 0; r < reached.size(); ++r)
                for (uint32_t k = first_[reached[r]]; k < first_[reached[r] + 1]; ++k) {
                    const uint32_t from = reached[r], to = neighbours_[k];
                    if (component_[to] != Piece::kNone) continue;
                    component_[to] = start;
                    const glm::dvec3 chord = points_[to] - points_[from],
                                     along = glm::normalize(along_[from] + along_[to]);
                    flat_[to] = {flat_[from].x + glm::dot(chord, along), points_[to].y};
                    reached.push_back(to);
                }
        }
    }

    std::array<glm::dvec2, 3> unrolled(const FlatPart& facet, const Piece& piece) const {
        std::array<glm::dvec2, 3> corner{};
        for (size_t k = 0; k < 3; ++k) corner[k] = flat_[place_[facet.vertices[piece.vertex[k]]]];
        return corner;
    }

    // Whether all of it lies in the sheet nearly as large as it is.
    bool fits(const FlatPart& facet) const {
        constexpr double kStretch = 1.25;
        const uint32_t component = component_[place_[facet.vertices[0]]];
        if (std::ranges::any_of(facet.vertices,
                                [&](uint32_t v) { return component_[place_[v]] != component; }))
            return false;
        return std::ranges::all_of(facet.pieces, [&](const Piece& piece) {
            const auto area = [](const std::array<glm::dvec2, 3>& c) {
                return cross(c[1] - c[0], c[2] - c[0]);
            };
            const double before = area(piece.corner), after = area(unrolled(facet, piece));
            return after < kStretch * before && before < kStretch * after;
        });
    }

    FlatPart sheetOf(std::vector<FlatPart>&& facets) const {
        FlatPart sheet;
        sheet.surface = facets[0].surface;
        std::map<uint32_t, uint32_t> numbers;
        for (uint32_t f = 0; f < facets.size(); ++f)
            for (uint32_t i = 0; i < facets[f].pieces.size(); ++i) {
                Piece piece = facets[f].pieces[i];
                piece.corner = unrolled(facets[f], piece);
                piece.neighbour.fill(Piece::kNone);
                piece.facet = f;
                piece.inFacet = i;
                for (uint32_t& v : piece.vertex) {
                    const uint32_t ofMesh = facets[f].vertices[v];
                    const auto [number, isNew] =
                        numbers.try_emplace(ofMesh, static_cast<uint32_t>(sheet.vertices.size()));
                    if (isNew) sheet.vertices.push_back(ofMesh);
                    v = number->second;
                }
                sheet.pieces.push_back(piece);
            }
        sheet.facets = std::move(facets);
        sheet.link();
        return sheet;
    }

    std::vector<FlatPart>& facets_;
    std::vector<uint32_t>& place_; // of vertices of the mesh; restored
    std::vector<uint32_t> vertices_;
    std::vector<glm::dvec3> points_, along_;
    std::vector<uint32_t> first_, neighbours_;
    std::vector<glm::dvec2> flat_;
    std::vector<uint32_t> component_; // the vertex that its component was reached from
};

} // namespace

std::vector<FlatPart> unrollWalls(std::vector<FlatPart> parts, const PatchMesh& mesh) {
    std::vector<FlatPart> out;
    std::map<uint32_t, std::vector<FlatPart>> walls; // by surface
    for (FlatPart& part : parts)
        if (isUpright(part))
            walls[part.surface].push_back(std::move(part));
        else
            out.push_back(std::move(part));
    std::vector<uint32_t> place(mesh.vertices.size(), Piece::kNone);
    for (auto& [surface, facets] : walls) Unroller(facets, mesh, place).addTo(out);
    return out;
}

void unrollCuts(FlatPart& sheet) {
    std::vector<int> borderEdge(3 * sheet.pieces.size(), -1);
    for (size_t e = 0; e < sheet.borderSides.size(); ++e)
        borderEdge[3 * sheet.borderSides[e].piece + sheet.borderSides[e].corner] = static_cast<int>(e);
    size_t first = 0; // of the facet's pieces
    for (const FlatPart& facet : sheet.facets) {
        for (Cut cut : facet.cuts) {
            for (CutEnd& end : cut)
                if (end.edge < 0) {
                    const size_t i = facet.pieceAt(end.point);
                    end.point = sheet.pieces[first + i].at(facet.pieces[i].barycentric(end.point));
                } else {
                    const auto [piece, k] = facet.borderSides[static_cast<size_t>(end.edge)];
                    const auto& corner = sheet.pieces[first + piece].corner;
                    end.point = corner[k] + end.t * (corner[(k + 1) % 3] - corner[k]);
                    end.edge = borderEdge[3 * (first + piece) + k];
                }
            sheet.cuts.push_back(cut);
        }
        first += facet.pieces.size();
    }
}

} // namespace heliodon::geometry
