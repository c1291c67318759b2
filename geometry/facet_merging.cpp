#include "geometry/facet_merging.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/ray_crossing.h"

namespace heliodon::geometry {

namespace {

using Frame = MeshDomain::Frame;

constexpr double kColumn = 0.93;    // of an edge: what facets become
constexpr double kMostTurn = 0.25;  // radians in such a facet: chords take up to 1 % off
constexpr double kSamePlace = 1e-6; // of the wall's length

// A place where a domain's outline has a vertex.
struct Use {
    uint32_t domain, loop;
    size_t corner;
};

// A wall of one outline, from fold to fold.
struct Strip {
    std::vector<double> folds;                // along the wall, its two ends included
    std::vector<uint32_t> columnOf;           // per frame: the facet between two folds
    std::vector<uint32_t> frameAt;            // per facet: one of its frames
    std::vector<std::vector<size_t>> corners; // of the outline, per fold
};

// None where anything but floor and ceiling, or another wall's edge, has a corner on its border.
std::optional<Strip> stripOf(const Building& building, const MeshDomain& domain) {
    if (domain.frames.size() < 2 || domain.loops.size() != 1) return std::nullopt;
    Strip strip;
    const std::vector<uint32_t>& loop = domain.loops[0];
    std::vector<double> places;
    for (size_t k = 0; k < loop.size(); ++k)
        places.push_back(domain.frames[domain.frameOf[0][k]].coordinates(building.vertices[loop[k]]).x);
    std::vector<size_t> order(loop.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::ranges::sort(order, {}, [&](size_t k) { return places[k]; });
    const double same = kSamePlace * (places[order.back()] - places[order.front()]);
    for (const size_t k : order) {
        if (strip.folds.empty() || places[k] > strip.folds.back() + same) {
            strip.folds.push_back(places[k]);
            strip.corners.emplace_back();
        }
        strip.corners.back().push_back(k);
    }
    for (const auto& corners : strip.corners)
        if (corners.size() != 2) return std::nullopt;
    strip.frameAt.resize(strip.folds.size() - 1);
    for (uint32_t f = 0; f < domain.frames.size(); ++f) {
        const Frame& frame = domain.frames[f];
        const auto after = std::ranges::upper_bound(strip.folds, 0.5 * (frame.low + frame.high));
        if (after == strip.folds.begin() || after == strip.folds.end() || frame.low < *(after - 1) - same ||
            frame.high > *after + same)
            return std::nullopt;
        strip.columnOf.push_back(static_cast<uint32_t>(after - strip.folds.begin()) - 1);
        strip.frameAt[strip.columnOf[f]] = f;
    }
    return strip;
}

class FacetMerger {
public:
    FacetMerger(const Building& building, std::vector<MeshDomain>& domains, double edge)
        : building_(building), domains_(domains), edge_(edge), uses_(building.vertices.size()) {
        for (uint32_t d = 0; d < domains.size(); ++d)
            for (uint32_t l = 0; l < domains[d].loops.size(); ++l)
                for (size_t k = 0; k < domains[d].loops[l].size(); ++k)
                    uses_[domains[d].loops[l][k]].push_back({d, l, k});
    }

    void merge() {
        kept_.assign(building_.vertices.size(), true);
        for (uint32_t d = 0; d < domains_.size(); ++d)
            if (const auto strip = stripOf(building_, domains_[d])) thin(d, *strip);
        for (MeshDomain& domain : domains_) domain.keepCorners(kept_);
    }

private:
    glm::dvec3 at(uint32_t vertex) const { return building_.vertices[vertex]; }

    // The other domain's corner that goes with one of the wall's; none where the fold must stay.
    std::optional<Use> partner(uint32_t d, size_t corner) const {
        const auto& loop = domains_[d].loops[0];
        const auto& uses = uses_[loop[corner]];
        if (uses.size() != 2) return std::nullopt;
        const Use other = uses[0].domain == d ? uses[1] : uses[0];
        const MeshDomain& flat = domains_[other.domain];
        if (other.domain == d || flat.frames.size() != 1 || building_.faces[flat.faces[0]].twin >= 0)
            return std::nullopt;
        const auto& its = flat.loops[other.loop];
        const auto next = [](const auto& of, size_t k, size_t by) { return of[(k + by) % of.size()]; };
        if (next(loop, corner, 1) != next(its, other.corner, its.size() - 1) ||
            next(loop, corner, loop.size() - 1) != next(its, other.corner, 1) || its.size() < 4)
            return std::nullopt;
        return other;
    }

    static double turnAt(const MeshDomain& domain, const Strip& strip, size_t fold) {
        const glm::dvec3 before = domain.frames[strip.frameAt[fold - 1]].u,
                         after = domain.frames[strip.frameAt[fold]].u;
        return std::abs(std::atan2(glm::length(glm::cross(before, after)), glm::dot(before, after)));
    }

    // The wall's corner at a fold, the lower or the upper one.
    uint32_t cornerAt(const MeshDomain& domain, const Strip& strip, size_t fold, bool upper) const {
        uint32_t a = domain.loops[0][strip.corners[fold][0]], b = domain.loops[0][strip.corners[fold][1]];
        return (at(a).y > at(b).y) == upper ? a : b;
    }

    // Between two folds, whether the straight line cuts off nothing of the outlines above and below.
    bool isFree(uint32_t d, const Strip& strip, size_t from, size_t to) const {
        for (const bool upper : {false, true}) {
            std::vector<uint32_t> outline;
            for (size_t fold = from; fold <= to; ++fold)
                outline.push_back(cornerAt(domains_[d], strip, fold, upper));
            const std::set<uint32_t> own(outline.begin(), outline.end());
            std::set<uint32_t> flat;
            for (size_t k = 1; k + 1 < outline.size(); ++k)
                for (const Use& use : uses_[outline[k]])
                    if (use.domain != d) flat.insert(use.domain);
            glm::dvec3 low = at(outline[0]), high = low;
            for (const uint32_t v : outline) low = glm::min(low, at(v)), high = glm::max(high, at(v));
            const auto isNear = [&](glm::dvec3 p) {
                return p.x >= low.x && p.x <= high.x && p.z >= low.z && p.z <= high.z;
            };
            for (const uint32_t other : flat)
                for (const auto& loop : domains_[other].loops)
                    for (const uint32_t v : loop)
                        if (isNear(at(v)) && !own.contains(v) && isWithin(outline, at(v))) return false;
        }
        return true;
    }

    // In the plan.
    bool isWithin(const std::vector<uint32_t>& outline, glm::dvec3 p) const {
        bool in = false;
        for (size_t k = 0; k < outline.size(); ++k) {
            const glm::dvec3 a = at(outline[k]), b = at(outline[(k + 1) % outline.size()]);
            if (rayCrosses({p.x, p.z}, {a.x, a.z}, {b.x, b.z})) in = !in;
        }
        return in;
    }

    void thin(uint32_t d, const Strip& strip) {
        const MeshDomain& domain = domains_[d];
        const size_t last = strip.folds.size() - 1;
        std::vector<size_t> kept{0};
        for (size_t fold = 1, start = 0; fold <= last; ++fold) {
            const bool mayGo = fold < last && std::ranges::all_of(strip.corners[fold], [&](size_t corner) {
                                   return partner(d, corner).has_value();
                               });
            if (mayGo) continue;
            keepSome(d, strip, start, fold, kept);
            start = fold;
        }
        if (kept.size() == strip.folds.size()) return;
        for (size_t k = 0, fold = 0; fold <= last; ++fold) {
            if (k < kept.size() && kept[k] == fold) {
                ++k;
                continue;
            }
            for (const size_t corner : strip.corners[fold]) kept_[domain.loops[0][corner]] = false;
        }
        reframe(d, strip, kept);
    }

    // Of the folds from one that stays to the next, those that stay, but for the first.
    void keepSome(uint32_t d, const Strip& strip, size_t from, size_t to, std::vector<size_t>& kept) const {
        const double length = strip.folds[to] - strip.folds[from];
        double turn = 0;
        for (size_t fold = from + 1; fold < to; ++fold) turn += turnAt(domains_[d], strip, fold);
        // As many for each, so that those of one wall stay even.
        const auto narrow = static_cast<double>(to - from);
        const double fitting = std::round(narrow * kColumn * edge_ / length),
                     gentle = std::floor(narrow * kMostTurn / std::max(turn, kMostTurn)),
                     each = std::min({fitting, gentle, narrow / 2}),
                     wide = each > 1 ? std::ceil(narrow / each) : narrow;
        const bool merges = wide < narrow;
        for (size_t fold = from + 1; fold <= to; ++fold) {
            const double share = (strip.folds[fold] - strip.folds[from]) / length * wide,
                         before = (strip.folds[fold - 1] - strip.folds[from]) / length * wide,
                         after = fold < to ? (strip.folds[fold + 1] - strip.folds[from]) / length * wide : 0;
            const double off = std::abs(share - std::round(share));
            const bool nearest = off <= std::abs(before - std::round(share)) &&
                                 off < std::abs(after - std::round(share)) && std::round(share) > 0;
            if (fold < to && merges && !nearest) continue;
            if (fold - kept.back() > 1 && !isFree(d, strip, kept.back(), fold))
                for (size_t between = kept.back() + 1; between < fold; ++between) kept.push_back(between);
            kept.push_back(fold);
        }
    }

    // The wall's facets anew, from one fold that stays to the next.
    void reframe(uint32_t d, const Strip& strip, const std::vector<size_t>& kept) {
        MeshDomain& domain = domains_[d];
        const double level = domain.frames[0].origin.y;
        std::vector<Frame> frames;
        double offset = strip.folds[0];
        for (size_t k = 0; k + 1 < kept.size(); ++k) {
            glm::dvec3 from = at(cornerAt(domain, strip, kept[k], false)),
                       to = at(cornerAt(domain, strip, kept[k + 1], false));
            from.y = to.y = level;
            Frame frame;
            frame.origin = from;
            frame.u = glm::normalize(to - from);
            frame.v = {0, 1, 0};
            frame.offset = frame.low = offset;
            frame.high = offset += glm::length(to - from);
            frames.push_back(frame);
        }
        for (uint32_t& frame : domain.frameOf[0]) {
            const size_t column = strip.columnOf[frame];
            const auto after = std::ranges::upper_bound(kept, column);
            frame = static_cast<uint32_t>(after - kept.begin()) - 1;
        }
        domain.frames = std::move(frames);
    }

    const Building& building_;
    std::vector<MeshDomain>& domains_;
    double edge_;
    std::vector<std::vector<Use>> uses_; // per vertex
    std::vector<bool> kept_;             // per vertex
};

} // namespace

void mergeFacets(const Building& building, std::vector<MeshDomain>& domains, double edge) {
    FacetMerger(building, domains, edge).merge();
}

} // namespace heliodon::geometry
