#include "compute/reference/form_factor_rows.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "compute/convex_regions.h"
#include "geometry/bounds.h"

namespace heliodon::compute::reference {

using glm::dvec3;

namespace {

constexpr double kTouching = 1e-3; // of what counts as one plane: less is rounding of coordinates

struct Heights {
    double low = INFINITY, high = -INFINITY;
};

Heights heights(const Polygon& polygon, const dvec3& onPlane, const dvec3& normal) {
    Heights result;
    for (const dvec3& p : polygon) {
        const double h = glm::dot(p - onPlane, normal);
        result.low = std::min(result.low, h), result.high = std::max(result.high, h);
    }
    return result;
}

} // namespace

FormFactorRows::FormFactorRows(const geometry::PatchMesh& mesh) : mesh_(&mesh) {
    uint32_t rooms = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        polygons_.push_back(geometry::patchCorners(mesh, i));
        areaVectors_.push_back(geometry::patchAreaVector(mesh, i));
        rooms = std::max(rooms, mesh.room[i] + 1);
    }
    samePlane_ = kSamePlane * geometry::boundsOf(mesh.vertices).diagonal();
    blockers_.resize(rooms);
    constexpr uint32_t kMostCorners = 16;
    for (ConvexRegion& region : blockingRegions(mesh, kMostCorners))
        blockers_[region.room].push_back(std::move(region.corners));
}

// A wall must not hide its own patches, however rounding bends it. What faces a patch across a gap, however
// narrow, is another body's and hides all that it covers: wholly before one another, by more than the
// rounding of coordinates.
bool FormFactorRows::inPlaneOf(size_t patch, const Polygon& blocker) const {
    const dvec3 its = glm::normalize(glm::cross(blocker[1] - blocker[0], blocker[2] - blocker[0])),
                own = glm::normalize(areaVectors_[patch]);
    const Polygon& corners = polygons_[patch];
    const Heights over = heights(corners, blocker[0], its), under = heights(blocker, corners[0], own);
    const double facing = glm::dot(its, own);
    const bool gap = facing < 0 && over.low > kTouching * samePlane_ && under.low > kTouching * samePlane_;
    return std::max(std::abs(over.low), std::abs(over.high)) <= samePlane_ && std::abs(facing) > 0.99999 &&
           !gap;
}

// What lies in front of both patches and has them on different sides of its plane.
std::vector<Polygon> FormFactorRows::between(size_t i, size_t j) const {
    std::vector<Polygon> result;
    const Polygon &from = polygons_[i], &to = polygons_[j];
    for (const Polygon& blocker : blockers_[mesh_->room[i]]) {
        if (inPlaneOf(i, blocker) || inPlaneOf(j, blocker)) continue;
        Polygon part = clipped(blocker, from[0], areaVectors_[i]);
        if (!part.empty()) part = clipped(part, to[0], areaVectors_[j]);
        if (part.empty()) continue;
        const dvec3 plane = glm::cross(blocker[1] - blocker[0], blocker[2] - blocker[0]);
        const auto reaches = [&](const Polygon& p, double side) {
            return reachesAbove(p, blocker[0], side * plane);
        };
        if ((reaches(from, 1) && reaches(to, -1)) || (reaches(from, -1) && reaches(to, 1)))
            result.push_back(std::move(part));
    }
    return result;
}

namespace {

// Of a pair that exchanges `open` with nothing between.
void count(FormFactorRows::PairMix& mix, const Estimate& exchange, double open) {
    const double uncertain = std::max(exchange.error, 1e-6 * open);
    if (open <= 0)
        ++mix.apart;
    else if (exchange.value <= uncertain)
        ++mix.hidden;
    else if (exchange.value >= open - uncertain)
        ++mix.visible;
    else
        ++mix.partial;
}

} // namespace

FormFactorRows::Row FormFactorRows::row(size_t i, double tolerance, size_t maxCells) const {
    Row result;
    result.factors.assign(polygons_.size(), 0.0);
    const double area = 0.5 * glm::length(areaVectors_[i]);
    if (area <= 0) return result;
    double squares = 0;
    for (size_t j = 0; j < polygons_.size(); ++j) {
        if (j == i) continue;
        const bool together = mesh_->room[j] == mesh_->room[i] && glm::length(areaVectors_[j]) > 0;
        const double open = together ? exchangeUnoccluded(polygons_[i], polygons_[j]) : 0;
        Estimate exchange{open, 0};
        if (open > 0)
            if (const std::vector<Polygon> blockers = between(i, j); !blockers.empty())
                exchange = exchangeOccluded(polygons_[i], polygons_[j], blockers, tolerance, maxCells);
        count(result.mix, exchange, open);
        result.factors[j] = exchange.value / area;
        squares += exchange.error * exchange.error / (area * area);
    }
    result.error = std::sqrt(squares);
    return result;
}

} // namespace heliodon::compute::reference
