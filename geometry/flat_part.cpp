#include "geometry/flat_part.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/corner_normals.h"
#include "geometry/key_hash.h"
#include "geometry/perpendicular.h"
#include "geometry/segment_distance.h"

namespace heliodon::geometry {

glm::dvec3 Piece::barycentric(glm::dvec2 p) const {
    const double whole = cross(corner[1] - corner[0], corner[2] - corner[0]);
    const double b = cross(p - corner[0], corner[2] - corner[0]) / whole,
                 c = cross(corner[1] - corner[0], p - corner[0]) / whole;
    return {1 - b - c, b, c};
}

void FlatPart::link() {
    for (const Piece& piece : pieces)
        for (const glm::dvec2 p : piece.corner) box.grow(p);
    // Sides by the lower of their vertices, as lists of 3 piece + corner.
    std::vector<uint32_t> first(vertices.size(), Piece::kNone), next(3 * pieces.size(), Piece::kNone);
    for (uint32_t i = 0; i < pieces.size(); ++i)
        for (uint32_t k = 0; k < 3; ++k) {
            const auto [a, b] = std::minmax(pieces[i].vertex[k], pieces[i].vertex[(k + 1) % 3]);
            const auto isSame = [&, low = a, high = b](uint32_t side) {
                const auto& v = pieces[side / 3].vertex;
                const uint32_t from = v[side % 3], to = v[(side % 3 + 1) % 3];
                return std::min(from, to) == low && std::max(from, to) == high;
            };
            uint32_t other = first[a];
            while (other != Piece::kNone && !isSame(other)) other = next[other];
            if (other == Piece::kNone) {
                next[3 * i + k] = first[a];
                first[a] = 3 * i + k;
            } else {
                pieces[i].neighbour[k] = other / 3;
                pieces[other / 3].neighbour[other % 3] = i;
            }
        }
    for (uint32_t i = 0; i < pieces.size(); ++i)
        for (uint32_t k = 0; k < 3; ++k)
            if (pieces[i].neighbour[k] == Piece::kNone) {
                borderSides.push_back({i, k});
                border.push_back({pieces[i].corner[k], pieces[i].corner[(k + 1) % 3]});
            }
}

std::pair<uint32_t, uint32_t> FlatPart::borderEdge(size_t edge) const {
    const auto [piece, k] = borderSides[edge];
    const auto& v = pieces[piece].vertex;
    return {vertices[v[k]], vertices[v[(k + 1) % 3]]};
}

double FlatPart::spacing() const {
    double twice = 0;
    for (const Piece& p : pieces) twice += cross(p.corner[1] - p.corner[0], p.corner[2] - p.corner[0]);
    return std::sqrt(2 / std::sqrt(3.0) * twice / static_cast<double>(pieces.size()));
}

namespace {

// The planes of each surface, with their pieces.
std::vector<FlatPart> planesOf(const PatchMesh& mesh) {
    using PlaneKey = std::array<int64_t, 5>;
    constexpr double kPlanes = 1e4; // per radian and metre: models in single precision have flat walls too
    std::vector<FlatPart> parts;
    std::unordered_map<PlaneKey, size_t, KeyHash> planes;
    PlaneKey last{};
    size_t at = 0;
    for (uint32_t i = 0; i < mesh.patchCount(); ++i) {
        if (mesh.role[i] != Role::projection) continue;
        const glm::dvec3 n = patchNormal(mesh, i), p = mesh.vertices[mesh.patch(i)[0]];
        const PlaneKey key{mesh.surface[i], std::llround(n.x * kPlanes), std::llround(n.y * kPlanes),
                           std::llround(n.z * kPlanes), std::llround(glm::dot(n, p) * kPlanes)};
        if (parts.empty() || key != last) {
            const auto [place, isNew] = planes.try_emplace(key, parts.size());
            if (isNew) {
                FlatPart& part = parts.emplace_back();
                const glm::dvec3 u = perpendicular(n);
                part.frame = {p, u, glm::cross(n, u), n};
                part.surface = mesh.surface[i];
            }
            at = place->second;
            last = key;
        }
        const auto corner = mesh.patch(i);
        for (size_t k = 1; k + 1 < corner.size(); ++k) {
            Piece& piece = parts[at].pieces.emplace_back();
            piece.vertex = {corner[0], corner[k], corner[k + 1]}; // of the mesh, for now
            piece.patch = i;
        }
    }
    return parts;
}

void addNormals(const PatchMesh& mesh, std::vector<FlatPart>& parts) {
    std::unordered_map<uint32_t, int> planes; // of each surface
    for (const FlatPart& part : parts) ++planes[part.surface];
    if (planes.size() == parts.size()) return;
    const std::vector<glm::dvec3> normals = cornerNormals(mesh);
    if (normals.empty()) return;
    for (FlatPart& part : parts) {
        if (planes[part.surface] == 1) continue;
        part.normals.resize(part.vertices.size());
        for (const Piece& piece : part.pieces)
            for (uint32_t c = mesh.firstCorner[piece.patch]; c < mesh.firstCorner[piece.patch + 1]; ++c)
                for (const uint32_t v : piece.vertex)
                    if (part.vertices[v] == mesh.corners[c]) part.normals[v] = normals[c];
    }
}

} // namespace

std::vector<FlatPart> flatParts(const PatchMesh& mesh) {
    std::vector<FlatPart> parts = planesOf(mesh);
    std::vector<uint32_t> numbered(mesh.vertices.size()), place(mesh.vertices.size());
    for (uint32_t number = 1; FlatPart & part : parts) {
        for (Piece& piece : part.pieces)
            for (size_t k = 0; k < 3; ++k) {
                uint32_t& v = piece.vertex[k];
                piece.corner[k] = part.frame.flat(mesh.vertices[v]);
                if (numbered[v] != number) {
                    numbered[v] = number;
                    place[v] = static_cast<uint32_t>(part.vertices.size());
                    part.vertices.push_back(v);
                }
                v = place[v];
            }
        part.link();
        ++number;
    }
    addNormals(mesh, parts);
    return parts;
}

void FlatPart::limit(glm::dvec3 centre, const std::vector<glm::dvec3>& at, double leastCosine) {
    std::vector<double> values;
    for (size_t v = 0; v < vertices.size(); ++v)
        values.push_back(glm::dot(normals[v], glm::normalize(centre - at[vertices[v]])) - leastCosine);
    const auto inside = [](double value) { return value > 0; };
    if (std::ranges::none_of(values, inside)) views.back().seen = false;
    if (std::ranges::all_of(values, inside)) values.clear();
    excess.resize(views.size());
    excess.back() = std::move(values);
}

std::vector<Segment> FlatPart::limitLines() const {
    std::vector<Segment> lines;
    if (excess.size() < views.size() || excess.back().empty() || !views.back().seen) return lines;
    const std::vector<double>& value = excess.back();
    for (const Piece& piece : pieces) {
        Segment line;
        size_t ends = 0;
        for (size_t k = 0; k < 3; ++k) {
            const size_t next = (k + 1) % 3;
            const double from = value[piece.vertex[k]], to = value[piece.vertex[next]];
            if ((from > 0) == (to > 0)) continue;
            line[ends++] = piece.corner[k] + from / (from - to) * (piece.corner[next] - piece.corner[k]);
        }
        if (ends == 2) lines.push_back(line);
    }
    return lines;
}

uint32_t FlatPart::seenFrom(const Piece& piece, glm::dvec2 p) const {
    uint32_t seen = 0;
    for (size_t v = 0; v < views.size(); ++v) {
        if (!views[v].reaches(p)) continue;
        if (v < excess.size() && !excess[v].empty()) {
            const auto at = [&](size_t k) { return excess[v][piece.vertex[k]]; };
            if (!(glm::dot(piece.barycentric(p), glm::dvec3(at(0), at(1), at(2))) > 0)) continue;
        }
        seen |= 1u << v;
    }
    return seen;
}

PieceGrid::PieceGrid(const std::vector<Piece>& pieces, const FlatBox& box, double cell)
    : pieces_(pieces), low_(box.low), cell_(cell) {
    columns_ = static_cast<int>((box.high.x - box.low.x) / cell_) + 1;
    rows_ = static_cast<int>((box.high.y - box.low.y) / cell_) + 1;
    first_.assign(static_cast<size_t>(columns_) * static_cast<size_t>(rows_) + 1, 0);
    const auto eachOf = [&](const Piece& piece, auto visit) {
        FlatBox around = boxOf(piece.corner);
        around.low -= 1e-3 * cell_;
        around.high += 1e-3 * cell_;
        eachCell(around, visit);
    };
    for (const Piece& piece : pieces) eachOf(piece, [&](size_t c) { ++first_[c + 1]; });
    for (size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    items_.resize(first_.back());
    std::vector<uint32_t> at(first_.begin(), first_.end() - 1);
    for (uint32_t i = 0; i < pieces.size(); ++i) eachOf(pieces[i], [&](size_t c) { items_[at[c]++] = i; });
}

uint32_t PieceGrid::at(glm::dvec2 p) const {
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

// By the circle round a piece's centroid.
void PieceGrid::markNear(const Segment& segment, double margin, std::vector<bool>& marked) const {
    const glm::dvec2 whole = segment[1] - segment[0];
    const double parts = std::max(1.0, std::ceil(glm::length(whole) / (2 * cell_)));
    for (double part = 0; part < parts; ++part) { // short ones have small boxes
        const glm::dvec2 a = segment[0] + part / parts * whole, d = whole / parts;
        FlatBox around = boxOf(std::array{a, a + d});
        around.low -= margin;
        around.high += margin;
        eachCell(around, [&](size_t cell) {
            for (uint32_t k = first_[cell]; k < first_[cell + 1]; ++k) {
                if (marked[items_[k]]) continue;
                const auto& [p, q, r] = pieces_[items_[k]].corner;
                const glm::dvec2 middle = (p + q + r) / 3.0;
                const double radius =
                    std::sqrt(std::max({glm::dot(p - middle, p - middle), glm::dot(q - middle, q - middle),
                                        glm::dot(r - middle, r - middle)}));
                if (distanceToSegment(middle, a, a + d) <= radius + margin) marked[items_[k]] = true;
            }
        });
    }
}

int PieceGrid::column(double x) const {
    return std::clamp(static_cast<int>((x - low_.x) / cell_), 0, columns_ - 1);
}

int PieceGrid::row(double y) const {
    return std::clamp(static_cast<int>((y - low_.y) / cell_), 0, rows_ - 1);
}

template<class Visit> void PieceGrid::eachCell(const FlatBox& box, Visit visit) const {
    const int left = column(box.low.x), right = column(box.high.x), top = row(box.high.y);
    for (int r = row(box.low.y); r <= top; ++r)
        for (int c = left; c <= right; ++c) visit(static_cast<size_t>(r * columns_ + c));
}

} // namespace heliodon::geometry
