#include "geometry/glass_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "geometry/bounds.h"
#include "geometry/box_tree.h"
#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"
#include "geometry/ray_crossing.h"
#include "geometry/segment_distance.h"
#include "geometry/twin_faces.h"

namespace heliodon::geometry {

namespace {

// What walls are no thicker than, so that windows across a yard stay apart, in whatever unit: of the model's
// extent, and of the height of the lower room beside it (0.9 of 3 m).
constexpr double kThickestOfExtent = 0.05, kThickestOfHeight = 0.3;
constexpr size_t kAnyCorners = std::numeric_limits<size_t>::max();
const double kSkew = std::sqrt(1 / (kBackToBack * kBackToBack) - 1); // tangent between sides of a wall
constexpr double kAlike = 0.1; // of the longest side: corners of faces that are nearly one shape

double longestSide(const Building& building, const Face& face) {
    const auto& loop = face.loops[0];
    double longest = 0;
    for (size_t i = 0; i < loop.size(); ++i)
        longest = std::max(longest, glm::distance(building.vertices[loop[i]],
                                                  building.vertices[loop[(i + 1) % loop.size()]]));
    return longest;
}

class GlassPairer {
public:
    GlassPairer(Building& building, double tolerance, double extent)
        : building_(building), tolerance_(tolerance), thickest_(kThickestOfExtent * extent) {
        const std::vector<double> heights = heightsOfRooms();
        for (uint32_t f = 0; f < building.faces.size(); ++f) {
            const Face& face = building.faces[f];
            if (!building.materials[face.material].isOpening()) continue;
            Glass glass{f, heights[face.room], {}, {}};
            glass.normal = glm::normalize(areaVector(building.vertices, face.loops[0]));
            glass.origin = building.vertices[face.loops[0][0]];
            glasses_.push_back(glass);
        }
        findCandidates();
    }

    GlassPairs pair() {
        GlassPairs out;
        for (const bool dividing : {false, true}) {
            for (const auto& [i, j] : candidates_)
                if (backToBack(glasses_[i], glasses_[j])) match(glasses_[i], glasses_[j], dividing);
            // Corners of triangles are their own: none is there because something meets an edge.
            out.nearly += matchNearly(dividing ? kAnyCorners : 3);
        }
        for (const auto& [i, j] : candidates_) {
            const Glass &a = glasses_[i], &b = glasses_[j];
            if (lone(a) && lone(b) && backToBack(a, b) && (holdsMiddle(a, b) || holdsMiddle(b, a)))
                out.odd.emplace_back(a.face, b.face);
        }
        return out;
    }

private:
    struct Glass {
        uint32_t face;
        double roomHeight;
        glm::dvec3 origin, normal;
    };

    Face& faceOf(const Glass& glass) const { return building_.faces[glass.face]; }
    bool lone(const Glass& glass) const { return faceOf(glass).twin < 0; }

    std::vector<double> heightsOfRooms() const {
        std::vector<double> low, high;
        for (const Face& face : building_.faces) {
            if (face.room >= low.size()) {
                low.resize(face.room + 1, std::numeric_limits<double>::infinity());
                high.resize(face.room + 1, -std::numeric_limits<double>::infinity());
            }
            for (const uint32_t v : face.loops[0]) {
                low[face.room] = std::min(low[face.room], building_.vertices[v].y);
                high[face.room] = std::max(high[face.room], building_.vertices[v].y);
            }
        }
        for (size_t r = 0; r < low.size(); ++r) high[r] -= low[r];
        return high;
    }

    double thickestBetween(const Glass& a, const Glass& b) const {
        return std::min(thickest_, kThickestOfHeight * std::min(a.roomHeight, b.roomHeight));
    }

    // Those that look away from one another and are no farther apart than a wall is thick.
    void findCandidates() {
        std::vector<Bounds> boxes;
        std::vector<glm::dvec3> corners;
        for (const Glass& glass : glasses_) {
            corners.clear();
            for (const uint32_t v : faceOf(glass).loops[0]) corners.push_back(building_.vertices[v]);
            boxes.push_back(boundsOf(corners));
        }
        const BoxTree tree(boxes);
        const glm::dvec3 reach(thickest_ + tolerance_);
        for (uint32_t i = 0; i < glasses_.size(); ++i)
            tree.anyHolding(boxes[i].high + reach, boxes[i].low - reach, [&](uint32_t j) {
                if (j > i && glm::dot(glasses_[i].normal, glasses_[j].normal) < kBackToBack)
                    candidates_.emplace_back(i, j);
                return false; // all of them
            });
        std::ranges::sort(candidates_);
    }

    // Each behind the other, and no farther than a wall is thick.
    bool backToBack(const Glass& a, const Glass& b) const {
        const double apart = -glm::dot(b.origin - a.origin, a.normal);
        return glm::dot(a.normal, b.normal) < -1 + 1e-9 && apart >= -tolerance_ &&
               apart <= thickestBetween(a, b);
    }

    void match(const Glass& a, const Glass& b, bool dividing) {
        Face &face = faceOf(a), &other = faceOf(b);
        if (face.twin >= 0 || other.twin >= 0 || face.loops.size() != 1 || other.loops.size() != 1) return;
        const glm::dvec3 shift = shiftBetween(building_, face, other);
        if (glm::length(shift - glm::dot(shift, a.normal) * a.normal) > tolerance_)
            return; // of another window
        if (!oppositeLoops(building_, face, other, tolerance_)) {
            if (!dividing) return;
            const std::vector<Put> there = missing(a, b), here = missing(b, a);
            if (there.empty() && here.empty()) return;
            // Only where that is all that tells them apart.
            if (face.loops[0].size() + here.size() != other.loops[0].size() + there.size()) return;
            if (!outlinesAgree(a, b) || !outlinesAgree(b, a)) return;
            for (const Put& put : there) divide(put);
            for (const Put& put : here) divide(put);
            if (!oppositeLoops(building_, face, other, tolerance_)) return;
        }
        face.twin = static_cast<int32_t>(b.face);
        other.twin = static_cast<int32_t>(a.face);
    }

    // How far two lone faces that are nearly one shape are from being opposite; infinite for others.
    double aside(const Glass& a, const Glass& b) const {
        constexpr double kNone = std::numeric_limits<double>::infinity();
        const Face &face = faceOf(a), &other = faceOf(b);
        if (face.loops[0].size() != other.loops[0].size()) return kNone;
        const glm::dvec3 shift = shiftBetween(building_, face, other);
        const double apart = -glm::dot(shift, a.normal), off = glm::length(shift + apart * a.normal);
        if (apart < 0 || apart > thickestBetween(a, b)) return kNone;
        const double length = std::min(longestSide(building_, face), longestSide(building_, other));
        if (off > tolerance_ + kAlike * length + kSkew * apart) return kNone; // of another window
        const bool alike = holdsMiddle(a, b) && holdsMiddle(b, a) &&
                           oppositeLoops(building_, face, other, kAlike * length).has_value();
        return alike ? off : kNone;
    }

    // Faces of so many corners at most that are each the nearest to the other one.
    size_t matchNearly(size_t corners) {
        struct Nearest {
            double aside = std::numeric_limits<double>::infinity();
            uint32_t glass = 0;
        };
        const auto plain = [&](const Glass& glass) {
            const auto& loops = faceOf(glass).loops;
            return lone(glass) && loops.size() == 1 && loops[0].size() <= corners;
        };
        std::vector<Nearest> nearest(glasses_.size());
        for (const auto& [i, j] : candidates_) {
            if (!plain(glasses_[i]) || !plain(glasses_[j])) continue;
            const double off = aside(glasses_[i], glasses_[j]);
            if (off < nearest[i].aside) nearest[i] = {off, j};
            if (off < nearest[j].aside) nearest[j] = {off, i};
        }
        size_t count = 0;
        for (uint32_t i = 0; i < glasses_.size(); ++i) {
            const uint32_t j = nearest[i].glass;
            if (std::isinf(nearest[i].aside) || i > j || nearest[j].glass != i) continue;
            faceOf(glasses_[i]).twin = static_cast<int32_t>(glasses_[j].face);
            faceOf(glasses_[j]).twin = static_cast<int32_t>(glasses_[i].face);
            ++count;
        }
        return count;
    }

    struct Put { // a new corner on the edge from a to b
        uint32_t a, b;
        glm::dvec3 place;
    };

    // The corner of one glass in the plane of the other.
    glm::dvec3 across(const Glass& other, uint32_t v) const {
        const glm::dvec3 p = building_.vertices[v];
        return p - glm::dot(p - other.origin, other.normal) * other.normal;
    }

    // Corners of `from` that stand opposite the middle of an edge of `to`.
    std::vector<Put> missing(const Glass& from, const Glass& to) const {
        std::vector<Put> out;
        for (const uint32_t v : faceOf(from).loops[0]) {
            const glm::dvec3 p = across(to, v);
            const auto& loop = faceOf(to).loops[0];
            Put best{};
            double least = tolerance_;
            bool corner = false;
            for (size_t i = 0; i < loop.size(); ++i) {
                const uint32_t a = loop[i], b = loop[(i + 1) % loop.size()];
                const glm::dvec3 q = building_.vertices[a], d = building_.vertices[b] - q;
                corner = corner || glm::length(p - q) <= tolerance_;
                const double t = glm::dot(p - q, d) / glm::dot(d, d);
                const double off = glm::length(p - q - t * d);
                if (t <= 0 || t >= 1 || off > least) continue;
                least = off;
                best = {a, b, q + t * d};
            }
            if (!corner && best.a != best.b) out.push_back(best);
        }
        return out;
    }

    // Every corner of `from` stands opposite the outline of `to`.
    bool outlinesAgree(const Glass& from, const Glass& to) const {
        return std::ranges::all_of(faceOf(from).loops[0], [&](uint32_t v) {
            const glm::dvec3 p = across(to, v);
            const auto& loop = faceOf(to).loops[0];
            double least = std::numeric_limits<double>::infinity();
            for (size_t i = 0; i < loop.size(); ++i) {
                least = std::min(least, distanceToSegment(p, building_.vertices[loop[i]],
                                                          building_.vertices[loop[(i + 1) % loop.size()]]));
            }
            return least <= tolerance_;
        });
    }

    // In the edge's two faces. An edge that was divided before is by then another one.
    void divide(const Put& put) {
        const auto added = static_cast<uint32_t>(building_.vertices.size());
        bool used = false;
        for (Face& face : building_.faces)
            for (auto& loop : face.loops)
                for (size_t i = 0; i < loop.size(); ++i) {
                    const uint32_t a = loop[i], b = loop[(i + 1) % loop.size()];
                    if (std::minmax(a, b) != std::minmax(put.a, put.b)) continue;
                    loop.insert(loop.begin() + static_cast<std::ptrdiff_t>(i + 1), added);
                    used = true;
                    break;
                }
        if (used) building_.vertices.push_back(put.place);
    }

    // The middle of b's corners, moved on to a's plane, lies in a's outline.
    bool holdsMiddle(const Glass& a, const Glass& b) const {
        glm::dvec3 sum{0};
        for (const uint32_t v : faceOf(b).loops[0]) sum += building_.vertices[v];
        const glm::dvec3 u = perpendicular(a.normal), v = glm::cross(a.normal, u);
        const glm::dvec3 p = sum / static_cast<double>(faceOf(b).loops[0].size()) - a.origin;
        const auto flat = [&](glm::dvec3 q) { return glm::dvec2(glm::dot(q, u), glm::dot(q, v)); };
        bool in = false;
        const auto& loop = faceOf(a).loops[0];
        for (size_t i = 0; i < loop.size(); ++i) {
            const glm::dvec3 q = building_.vertices[loop[i]] - a.origin,
                             r = building_.vertices[loop[(i + 1) % loop.size()]] - a.origin;
            if (rayCrosses(flat(p), flat(q), flat(r))) in = !in;
        }
        return in;
    }

    Building& building_;
    double tolerance_, thickest_;
    std::vector<Glass> glasses_;
    std::vector<std::pair<uint32_t, uint32_t>> candidates_; // glasses, the lower first
};

enum class Fit { none, nearly, exact };

Fit fitOf(const Building& building, const Face& a, const Face& b, double tolerance) {
    if (a.loops.size() != 1 || b.loops.size() != 1 || !building.materials[a.material].isOpening() ||
        !building.materials[b.material].isOpening())
        return Fit::none;
    const glm::dvec3 m = glm::normalize(areaVector(building.vertices, a.loops[0])),
                     n = glm::normalize(areaVector(building.vertices, b.loops[0])),
                     shift = shiftBetween(building, a, b);
    const double apart = -glm::dot(m, shift), off = glm::length(shift + apart * m),
                 most = kAlike * std::min(longestSide(building, a), longestSide(building, b));
    if (glm::dot(m, n) >= kBackToBack || apart <= 0 || off > most + kSkew * apart ||
        !oppositeLoops(building, a, b, most))
        return Fit::none;
    return off <= tolerance && oppositeLoops(building, a, b, tolerance) ? Fit::exact : Fit::nearly;
}

} // namespace

std::optional<GlassPairs> pairAsSaid(Building& building, std::span<const std::pair<uint32_t, uint32_t>> pairs,
                                     double tolerance) {
    std::vector<int32_t> twin(building.faces.size(), kNoTwin);
    GlassPairs out;
    for (const auto& [f, g] : pairs) {
        if (f == g || f >= twin.size() || g >= twin.size() || twin[f] != kNoTwin || twin[g] != kNoTwin)
            return std::nullopt;
        const Fit fit = fitOf(building, building.faces[f], building.faces[g], tolerance);
        if (fit == Fit::none) return std::nullopt;
        out.nearly += fit == Fit::nearly;
        twin[f] = static_cast<int32_t>(g);
        twin[g] = static_cast<int32_t>(f);
    }
    for (size_t f = 0; f < twin.size(); ++f) building.faces[f].twin = twin[f];
    return out;
}

GlassPairs pairGlasses(Building& building, double tolerance, double extent) {
    return GlassPairer(building, tolerance, extent).pair();
}

} // namespace heliodon::geometry
