#include "geometry/spare_vertices.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include <glm/geometric.hpp>

#include "geometry/segment_distance.h"

namespace heliodon::geometry {

namespace {

// Of the edges beside the vertex, from point to point without it: where lines are few, and where they are so
// many, per piece of a part, that they make small triangles themselves.
constexpr double kLongest = 1.25, kLongestOfMany = 2, kFew = 0.2, kMany = 0.26;
constexpr double kStraight = 1e-5;               // metres
constexpr double kEndsThere = 3 * kSameInRegion; // metres: a line so near may end in the vertex
constexpr uint32_t kNone = Piece::kNone;

class SpareFinder {
public:
    SpareFinder(std::span<const FlatPart> parts, const std::vector<glm::dvec3>& at)
        : parts_(parts), at_(at), of_(at.size()) {}

    std::vector<bool> find() {
        std::vector<bool> spare(at_.size(), false);
        for (const FlatPart& part : parts_) findCuts(part);
        if (cuts_.empty()) return spare;
        std::ranges::sort(cuts_);
        for (const FlatPart& part : parts_) followBorder(part);
        const double longest = longestEdge();
        for (uint32_t v = 0; v < of_.size(); ++v) {
            const Vertex& vertex = of_[v];
            if (!vertex.besideCut || vertex.lineEnds || vertex.branches || vertex.parts != vertex.borders ||
                vertex.along[1] == kNone)
                continue;
            const auto [a, b] = vertex.along;
            double free = 0, edges = 0;
            bool held = true;
            for (const uint32_t next : vertex.along) {
                const double edge = glm::length(at_[next] - at_[v]), cut = nearestCut(v, next);
                held = held && (cut < 1 || !spare[next]);
                free += cut * edge;
                edges += edge;
            }
            spare[v] =
                held && free < 0.5 * longest * edges && distanceToSegment(at_[v], at_[a], at_[b]) < kStraight;
        }
        return spare;
    }

private:
    struct Vertex {
        bool besideCut = false, lineEnds = false, branches = false;
        uint32_t parts = 0, borders = 0;             // that have it; on whose border it is
        std::array<uint32_t, 2> along{kNone, kNone}; // the vertices between which the borders run
    };
    struct EdgeCut {
        uint32_t from, to;
        double at; // 0 .. 1
        auto operator<=>(const EdgeCut&) const = default;
    };

    void findCuts(const FlatPart& part) {
        for (const Cut& cut : part.cuts)
            for (const CutEnd& end : cut) {
                if (end.edge < 0) continue;
                const auto [a, b] = part.borderEdge(static_cast<size_t>(end.edge));
                const double length = glm::length(at_[b] - at_[a]);
                for (const EdgeCut& seen : {EdgeCut{a, b, end.t}, EdgeCut{b, a, 1 - end.t}}) {
                    cuts_.push_back(seen);
                    of_[seen.from].besideCut = true;
                    if (seen.at * length < kEndsThere) of_[seen.from].lineEnds = true;
                }
            }
    }

    double longestEdge() const {
        double pieces = 0, lines = 0;
        for (const FlatPart& part : parts_) {
            pieces += static_cast<double>(part.pieces.size());
            lines += static_cast<double>(part.cuts.size());
        }
        const double many = std::clamp((lines / pieces - kFew) / (kMany - kFew), 0.0, 1.0);
        return kLongest + many * (kLongestOfMany - kLongest);
    }

    void followBorder(const FlatPart& part) {
        for (const uint32_t v : part.vertices) ++of_[v].parts;
        for (size_t e = 0; e < part.border.size(); ++e) {
            const auto [a, b] = part.borderEdge(e);
            ++of_[a].borders; // of its two sides there the one that leaves
            goOn(of_[a], b);
            goOn(of_[b], a);
        }
    }

    static void goOn(Vertex& vertex, uint32_t next) {
        for (uint32_t& known : vertex.along) {
            if (known == kNone) known = next;
            if (known == next) return;
        }
        vertex.branches = true;
    }

    // From a on, as a part of the edge; 1 without any.
    double nearestCut(uint32_t a, uint32_t b) const {
        const auto found = std::ranges::lower_bound(cuts_, EdgeCut{a, b, 0});
        return found != cuts_.end() && found->from == a && found->to == b ? found->at : 1;
    }

    std::span<const FlatPart> parts_;
    const std::vector<glm::dvec3>& at_;
    std::vector<Vertex> of_;
    std::vector<EdgeCut> cuts_; // each seen from both its ends
};

} // namespace

std::vector<bool> spareVertices(std::span<const FlatPart> parts, const std::vector<glm::dvec3>& vertices) {
    return SpareFinder(parts, vertices).find();
}

} // namespace heliodon::geometry
