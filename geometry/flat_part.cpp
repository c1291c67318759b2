#include "geometry/flat_part.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

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

double FlatPart::spacing() const {
    double twice = 0;
    for (const Piece& p : pieces) twice += cross(p.corner[1] - p.corner[0], p.corner[2] - p.corner[0]);
    return std::sqrt(2 / std::sqrt(3.0) * twice / static_cast<double>(pieces.size()));
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
