#include "compute/outside_plans.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "compute/outer_sides.h"
#include "geometry/extent.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

constexpr double kOfDistance = 0.25, kOfOpening = 0.125; // the longest cell
// Of boards: how far before one the next may be, in its depths; rows, of which no more than the gap calls
// for.
constexpr double kFarthest = 1.3, kMostRows = 8, kOfGap = 0.25;
constexpr double kNarrower = 0.7; // than cells are elsewhere: rows worth their while
constexpr double kSquare = 1.5;   // length over depth: up to it light falls off either way

double gap(const geometry::Bounds& a, const geometry::Bounds& b) {
    return glm::length(glm::max(dvec3(0), glm::max(a.low - b.high, b.low - a.high)));
}

dvec3 longestSide(std::span<const dvec3> polygon) {
    dvec3 longest(0);
    for (size_t k = 0; k < polygon.size(); ++k)
        if (const dvec3 side = polygon[(k + 1) % polygon.size()] - polygon[k];
            glm::length(side) > glm::length(longest))
            longest = side;
    return glm::normalize(longest);
}

OutsidePlan::Target targetOf(const ConvexRegion& region) {
    return {geometry::boundsOf(region.corners),
            kOfOpening * std::sqrt(0.5 * glm::length(geometry::areaVector(region.corners)))};
}

class Planner {
public:
    Planner(const geometry::PatchMesh& mesh, const OutsideSurfaces& surfaces,
            std::span<const ConvexRegion> openings)
        : mesh_(mesh), surfaces_(surfaces), openings_(openings),
          samePlane_(kSamePlane * geometry::boundsOf(mesh.vertices).diagonal()),
          rays_(surfaces.all, samePlane_), planned_(surfaces.all.size(), false) {}

    void addStanding() {
        if (mesh_.outside.material.empty()) return;
        for (size_t r = 0; r < surfaces_.standing.size(); ++r)
            if (hasColour(surfaces_.standing[r].group)) add(r).targets = openingsSeenBy(r);
    }

    void addOuterSides() {
        if (surfaces_.all.size() == surfaces_.standing.size()) return;
        std::vector<ConvexRegion> glass(openings_.begin(), openings_.end()), lit;
        for (ConvexRegion& opening : glass) std::ranges::reverse(opening.corners); // as seen from outside
        for (const size_t r : sidesAmong(rays_.seenFrom(glass))) addSide(r, openingsSeenBy(r));
        for (const OutsidePlan& plan : plans_) lit.push_back(surfaces_.all[plan.region]);
        for (const size_t r : sidesAmong(rays_.seenFrom(lit))) {
            std::vector<OutsidePlan::Target> targets;
            for (const ConvexRegion& other : lit)
                if (lookAtOneAnother(surfaces_.all[r], other, samePlane_)) targets.push_back(targetOf(other));
            addSide(r, std::move(targets));
        }
    }

    std::vector<OutsidePlan> done() {
        for (OutsidePlan& plan : plans_) plan.board = boardOf(plan);
        return std::move(plans_);
    }

private:
    bool hasColour(uint32_t material) const {
        return !mesh_.materials[material].isOpening() &&
               mesh_.materials[material].reflectance != glm::vec3(0);
    }

    OutsidePlan& add(size_t r) {
        planned_[r] = true;
        const dvec3 normal = normalOf(surfaces_.all[r]), u = longestSide(surfaces_.all[r].corners);
        return plans_.emplace_back(static_cast<uint32_t>(r), normal, u, glm::cross(normal, u));
    }

    // None where cells are no wider than its rows anyway.
    std::optional<OutsidePlan::Board> boardOf(const OutsidePlan& plan) const {
        const ConvexRegion& region = surfaces_.all[plan.region];
        const double length = geometry::extentAlong(region.corners, plan.u).length(),
                     height = geometry::extentAlong(region.corners, plan.v).length(),
                     depth = std::min(length, height), gap = rays_.gapBefore(region),
                     row = std::max(depth / kMostRows, kOfGap * gap);
        if (gap > kFarthest * depth || row > kNarrower * plan.longest(geometry::boundsOf(region.corners)))
            return std::nullopt;
        return OutsidePlan::Board{row, length < kSquare * height};
    }

    void addSide(size_t r, std::vector<OutsidePlan::Target> targets) {
        const ConvexRegion& side = surfaces_.all[r];
        const geometry::Bounds box = geometry::boundsOf(side.corners);
        std::vector<const ConvexRegion*> its;
        for (const ConvexRegion& lining : surfaces_.linings)
            if (geometry::boundsOf(lining.corners).isNear(box, samePlane_) &&
                inPlaneOf(side, lining, samePlane_))
                its.push_back(&lining);
        if (std::ranges::none_of(its, [&](const ConvexRegion* lining) { return hasColour(lining->group); }))
            return;
        OutsidePlan& plan = add(r);
        std::ranges::copy_if(its, std::back_inserter(plan.glass), [&](const ConvexRegion* lining) {
            return mesh_.materials[lining->group].isOpening();
        });
        plan.linings = std::move(its), plan.targets = std::move(targets);
    }

    std::vector<size_t> sidesAmong(const std::vector<bool>& seen) const {
        std::vector<size_t> sides;
        for (size_t r = surfaces_.standing.size(); r < seen.size(); ++r)
            if (seen[r] && !planned_[r]) sides.push_back(r);
        return sides;
    }

    // All where it looks at none, for what it lights looks at some.
    std::vector<OutsidePlan::Target> openingsSeenBy(size_t r) const {
        const ConvexRegion& region = surfaces_.all[r];
        const dvec3 normal = normalOf(region);
        const auto isAhead = [&](const ConvexRegion& opening) {
            return std::ranges::any_of(
                opening.corners, [&](const dvec3& p) { return glm::dot(p - region.corners[0], normal) > 0; });
        };
        const bool looksAtNone = std::ranges::none_of(openings_, isAhead);
        std::vector<OutsidePlan::Target> targets;
        for (const ConvexRegion& opening : openings_)
            if (looksAtNone || isAhead(opening)) targets.push_back(targetOf(opening));
        return targets;
    }

    const geometry::PatchMesh& mesh_;
    const OutsideSurfaces& surfaces_;
    std::span<const ConvexRegion> openings_;
    double samePlane_; // metres
    OutsideRays rays_;
    std::vector<bool> planned_;
    std::vector<OutsidePlan> plans_;
};

} // namespace

double OutsidePlan::longest(const geometry::Bounds& box) const {
    double length = 1e300;
    for (const Target& target : targets)
        length = std::min(length, std::max(target.least, kOfDistance * gap(box, target.box)));
    return length;
}

std::vector<OutsidePlan> outsidePlans(const geometry::PatchMesh& mesh, const OutsideSurfaces& surfaces,
                                      std::span<const ConvexRegion> openings, bool blackStanding) {
    Planner planner(mesh, surfaces, openings);
    if (!blackStanding) planner.addStanding();
    planner.addOuterSides();
    return planner.done();
}

} // namespace heliodon::compute
