#include "geometry/fold_leaning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "geometry/ray_crossing.h"
#include "geometry/segment_distance.h"

namespace heliodon::geometry {

namespace {

// Triangles do not lean across turns of more radians, nor where they would lie farther off the facets, in the
// wall's solids or before them, than so many metres.
constexpr double kMostTurn = 0.45, kDeepest = 0.0025;
// Where triangles may lean across folds: radians along an edge, metres in the wall's solids and before them.
constexpr double kMostLeaning = 0.5, kDeep = 0.0008, kCutOff = 0.003;
// What stands on a wall at a blunter angle (radians) is not in their way.
constexpr double kBlunt = kMostLeaning, kLevel = 1e-6; // the latter: metres, of rounding
constexpr double kSpan = 2; // of the edge length: none reaches farther along the wall
// Metres: what is farther from a wall is in no one's way. Over kSpan edges they lie at most kSpan squared
// times as deep as over one.
constexpr double kFarOff = 2 * kSpan * kSpan * kCutOff;
constexpr double kNarrowFacets = 0.45; // of the edge length: too narrow for triangles each within one

glm::dvec2 inPlan(glm::dvec3 p) {
    return {p.x, p.z};
}

bool nearInPlan(const Bounds& box, glm::dvec3 a, glm::dvec3 b) {
    const glm::dvec3 low = glm::min(a, b), high = glm::max(a, b);
    return low.x < box.high.x + kFarOff && high.x > box.low.x - kFarOff && low.z < box.high.z + kFarOff &&
           high.z > box.low.z - kFarOff;
}

} // namespace

FoldLeaning::FoldLeaning(const Building& building, const std::vector<MeshDomain>& domains)
    : building_(building), domains_(domains), clearances_(domains.size(), kFarOff) {
    if (std::ranges::all_of(domains, [](const MeshDomain& domain) { return domain.folds.empty(); })) return;
    std::vector<Bounds> boxes;
    std::map<std::pair<uint32_t, uint32_t>, std::vector<uint32_t>> edges;
    for (uint32_t d = 0; d < domains.size(); ++d) {
        std::vector<glm::dvec3> corners;
        for (const auto& loop : domains[d].loops)
            for (size_t i = 0; i < loop.size(); ++i) {
                corners.push_back(position(loop[i]));
                edges[std::minmax(loop[i], loop[(i + 1) % loop.size()])].push_back(d);
            }
        boxes.push_back(boundsOf(corners));
    }
    for (size_t d = 0; d < domains.size(); ++d)
        if (!domains[d].folds.empty()) clearances_[d] = clearanceOf(d, boxes, edges);
}

// At that place of the plan; of curved walls anywhere.
bool FoldLeaning::standsAt(size_t d, glm::dvec2 place, double height) const {
    const MeshDomain& domain = domains_[d];
    if (domain.frames.size() > 1) return true;
    return isInside(domain.planar, domain.frames[0].coordinates({place.x, height, place.y}));
}

// Edges between these heights, with those at the floor on which something stands, and at the ceiling from
// which something hangs.
bool FoldLeaning::isBetween(const Edges::value_type& edge, const Bounds& box,
                            const std::vector<Bounds>& boxes) const {
    const auto [low, high] = std::minmax({position(edge.first.first).y, position(edge.first.second).y});
    return std::ranges::any_of(edge.second, [&](uint32_t other) {
        const double bottom = boxes[other].low.y, top = boxes[other].high.y;
        const bool flat = top - bottom < kLevel;
        const double above = !flat && low < bottom + kLevel ? 3 * kLevel : 0,
                     below = !flat && high > top - kLevel ? 3 * kLevel : 0;
        return low - below < box.high.y - kLevel && high + above > box.low.y + kLevel;
    });
}

// In the plan, between the heights of a curved wall: its facets and folds and the edges of all else, with
// those below and above between which a wall stands there.
double FoldLeaning::clearanceOf(size_t d, const std::vector<Bounds>& boxes, const Edges& edges) const {
    std::set<uint32_t> own;
    for (const auto& loop : domains_[d].loops) own.insert(loop.begin(), loop.end());
    const Bounds& box = boxes[d];
    const double middle = 0.5 * (box.low.y + box.high.y);
    std::vector<std::array<glm::dvec2, 2>> facets;
    for (const MeshDomain::Frame& frame : domains_[d].frames)
        facets.push_back({inPlan(frame.origin + (frame.low - frame.offset) * frame.u),
                          inPlan(frame.origin + (frame.high - frame.offset) * frame.u)});
    double least = kFarOff;
    for (const auto& edge : edges) {
        const auto [from, to] = edge.first;
        if (!nearInPlan(box, position(from), position(to)) ||
            std::ranges::find(edge.second, d) != edge.second.end())
            continue;
        const bool between = isBetween(edge, box, boxes);
        const auto wallAt = [&](glm::dvec2 p) {
            return std::ranges::any_of(edge.second, [&](uint32_t other) {
                return boxes[other].low.y < middle && boxes[other].high.y > middle &&
                       standsAt(other, p, middle);
            });
        };
        std::vector<glm::dvec2> on; // ends of it, or corners of what it is an edge of, on the wall
        const auto addOwn = [&](uint32_t v) {
            if (own.contains(v)) on.push_back(inPlan(position(v)));
        };
        if (between) {
            for (const uint32_t v : {from, to}) addOwn(v);
        } else {
            for (const uint32_t other : edge.second)
                for (const auto& loop : domains_[other].loops) std::ranges::for_each(loop, addOwn);
        }
        const auto consider = [&](glm::dvec2 p, double distance) {
            if (std::ranges::all_of(on, [&](glm::dvec2 end) { // kLevel: where it stands on the wall itself
                    return distance < kBlunt * glm::length(p - end) - kLevel;
                }))
                least = std::min(least, distance);
        };
        const glm::dvec2 a = inPlan(position(from)), b = inPlan(position(to));
        for (const auto& facet : facets) {
            for (const uint32_t v : {from, to})
                if (const glm::dvec2 p = inPlan(position(v)); between && !own.contains(v))
                    consider(p, distanceToSegment(p, facet[0], facet[1]));
            for (const glm::dvec2 end : facet)
                if (const double distance = distanceToSegment(end, a, b);
                    distance < least && (between || wallAt(a + placeOnSegment(end, a, b) * (b - a))))
                    consider(end, distance);
        }
    }
    return least;
}

// Of a straight line across a fold in its middle, and across the others within its length: for small angles
// each fold adds its own share.
double FoldLeaning::deepestLean(size_t d, double edge) const {
    const auto [low, high] = extentOf(domains_[d]);
    const double half = std::min(kSpan * edge, high - low) / 2;
    double deepest = 0;
    for (const auto& [x, own] : domains_[d].folds) {
        double depth = 0;
        for (const auto& [at, turn] : domains_[d].folds)
            depth += std::abs(turn) * std::max(0.0, half - std::abs(at - x)) / 2;
        deepest = std::max(deepest, depth);
    }
    return deepest;
}

// Whether triangles that lean across the folds meet nothing else and, as long as an edge, lie next to nowhere
// in the wall's solids and cut off little.
bool FoldLeaning::mayLean(size_t d, double edge) const {
    if (clearances_[d] < kFarOff && clearances_[d] <= deepestLean(d, edge)) return false;
    const MeshDomain& domain = domains_[d];
    const auto [low, high] = extentOf(domain);
    for (size_t k = 0; k < domain.folds.size(); ++k) {
        const double before = k > 0 ? domain.folds[k - 1].at : low,
                     after = k + 1 < domain.folds.size() ? domain.folds[k + 1].at : high,
                     turn = domain.folds[k].turn,
                     turned = std::abs(turn) * std::max(1.0, 2 * edge / (after - before)); // along an edge
        if (turned > kMostLeaning || turned * edge > 8 * (turn > 0 ? kDeep : kCutOff)) return false;
    }
    return true;
}

std::vector<double> FoldLeaning::folds(size_t d, double edge, double narrowest) const {
    const MeshDomain& domain = domains_[d];
    if (domain.folds.empty()) return {};
    const auto [low, high] = extentOf(domain);
    std::vector<double> kept;
    const double narrow = kNarrowFacets * edge * static_cast<double>(domain.folds.size() + 1);
    if (high - low < narrow && mayLean(d, edge)) return {};
    const double least = clearances_[d] < kCutOff ? 0 : narrowest * edge;
    double turned = 0; // since the last that is kept
    for (const auto& [x, turn] : domain.folds) {
        turned += std::abs(turn);
        const double width = std::min(x - (kept.empty() ? low : kept.back()), high - x);
        if (width < least && turned < kMostTurn && turned * width < kDeepest) continue;
        kept.push_back(x);
        turned = 0;
    }
    return kept;
}

} // namespace heliodon::geometry
