#include "geometry/doubled_faces.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "geometry/closed_pieces.h"
#include "geometry/key_hash.h"
#include "geometry/outline_area.h"
#include "geometry/shell_faces.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr size_t kOnePart = 20; // of a piece's faces, one may be drawn for one side alone

class FaceHalver {
public:
    FaceHalver(std::vector<SoupFace>& faces, const std::function<bool(uint32_t)>& isGlass, double tolerance)
        : faces_(faces), isGlass_(isGlass), tolerance_(tolerance), back_(faces.size()) {}

    size_t halve() {
        if (std::ranges::none_of(faces_, [&](const SoupFace& f) { return isGlass_(f.material); })) return 0;
        if (!mayBeDoubled() || !findBacks()) return 0;
        std::vector<ClosedPiece> pieces = doubledPieces(false);
        for (ClosedPiece& piece : doubledPieces(true)) pieces.push_back(std::move(piece));
        return keepOne(pieces);
    }

private:
    bool isOpaque(size_t k) const { return !isGlass_(faces_[k].material); }

    // Far sooner than findBacks(): false where no two faces have the same corners.
    bool mayBeDoubled() const {
        std::vector<size_t> keys; // of corners in whatever order
        for (size_t k = 0; k < faces_.size(); ++k) {
            if (!isOpaque(k)) continue;
            size_t& key = keys.emplace_back(0);
            for (const auto& loop : faces_[k].loops)
                for (const dvec3 p : loop)
                    key += KeyHash()(std::array{std::bit_cast<int64_t>(p.x), std::bit_cast<int64_t>(p.y),
                                                std::bit_cast<int64_t>(p.z)});
        }
        std::ranges::sort(keys);
        return std::ranges::adjacent_find(keys) != keys.end();
    }

    // Of faces with the same corners the first that looks the other way, as programs write both alike.
    bool findBacks() {
        std::map<std::vector<std::array<double, 3>>, std::vector<uint32_t>> alike;
        for (uint32_t k = 0; k < faces_.size(); ++k)
            if (isOpaque(k)) alike[sortedCorners(faces_[k])].push_back(k);
        isBack_.assign(faces_.size(), false);
        bool any = false;
        for (const auto& [corners, copies] : alike) {
            if (copies.size() != 2 ||
                glm::dot(areaVector(faces_[copies[0]].loops[0]), areaVector(faces_[copies[1]].loops[0])) >= 0)
                continue;
            back_[copies[0]] = copies[1];
            isBack_[copies[1]] = any = true;
        }
        return any;
    }

    // Of what is no glass and, where `withGlass`, of what did not close without it.
    std::vector<ClosedPiece> doubledPieces(bool withGlass) {
        std::vector<SoupFace> once;
        for (uint32_t k = 0; k < faces_.size(); ++k)
            if (!isBack_[k] && !taken_.contains(k) && (withGlass || isOpaque(k))) {
                once.push_back(faces_[k]);
                once.back().surface = k;
            }
        const Building welded = weldFaces(once, 1, tolerance_, true);
        std::vector<ClosedPiece> out;
        for (ClosedPiece& piece : closedPieces(welded)) {
            taken_.insert(piece.faces.begin(), piece.faces.end());
            if (isDoubled(piece)) out.push_back(std::move(piece));
        }
        return out;
    }

    bool isDoubled(const ClosedPiece& piece) const {
        const auto single = std::ranges::count_if(
            piece.faces, [&](uint32_t k) { return isOpaque(k) && !back_[k].has_value(); });
        return static_cast<size_t>(single) * kOnePart <= piece.faces.size();
    }

    size_t keepOne(const std::vector<ClosedPiece>& pieces) {
        std::vector<bool> gone(faces_.size(), false);
        size_t count = 0;
        for (const ClosedPiece& piece : pieces) {
            const bool hasGlass = !std::ranges::all_of(piece.faces, [&](uint32_t k) { return isOpaque(k); });
            const bool wrongWay = piece.looksIn != hasGlass; // rooms look in, furniture out
            for (size_t f = 0; f < piece.faces.size(); ++f) {
                const uint32_t k = piece.faces[f];
                if (!back_[k].has_value()) {
                    if (piece.turned[f] != wrongWay) turnOver(faces_[k]);
                    continue;
                }
                gone[piece.turned[f] == wrongWay ? *back_[k] : k] = true;
                ++count;
            }
        }
        size_t kept = 0;
        for (size_t k = 0; k < faces_.size(); ++k)
            if (!gone[k]) std::swap(faces_[kept++], faces_[k]);
        faces_.resize(kept);
        return count;
    }

    std::vector<SoupFace>& faces_;
    const std::function<bool(uint32_t)>& isGlass_;
    double tolerance_;
    std::vector<std::optional<uint32_t>> back_; // per face, of the first of two: the other one
    std::vector<bool> isBack_;
    std::set<uint32_t> taken_; // of closed pieces
};

} // namespace

size_t dropDoubledFaces(std::vector<SoupFace>& faces, const std::function<bool(uint32_t)>& isGlass,
                        double tolerance) {
    return FaceHalver(faces, isGlass, tolerance).halve();
}

} // namespace heliodon::geometry
