#include "compute/outside_cells.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "compute/view_cells.h"
#include "geometry/bounds.h"
#include "geometry/clip_polygon.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

constexpr double kOfDistance = 0.25; // the widest cell over its distance from the nearest opening
constexpr size_t kMostCells = 2048;
constexpr double kSliver = 1e-9; // of a region's area, which is no cell

double gap(const geometry::Bounds& a, const geometry::Bounds& b) {
    return glm::length(glm::max(dvec3(0), glm::max(a.low - b.high, b.low - a.high)));
}

double areaOf(std::span<const dvec3> polygon) {
    return 0.5 * glm::length(geometry::areaVector(polygon));
}

// Axes of a region's plane along its longest side, and the box round it.
struct Frame {
    dvec3 u, v, origin;
    double width, height;
};

Frame frameOf(const ConvexRegion& region) {
    const std::vector<dvec3>& c = region.corners;
    dvec3 longest(0);
    for (size_t k = 0; k < c.size(); ++k)
        if (const dvec3 side = c[(k + 1) % c.size()] - c[k]; glm::length(side) > glm::length(longest))
            longest = side;
    Frame frame{glm::normalize(longest), {}, c[0], 0, 0};
    frame.v = glm::cross(normalOf(region), frame.u);
    double lowU = 0, lowV = 0, highU = 0, highV = 0;
    for (const dvec3& p : c) {
        const double x = glm::dot(p - c[0], frame.u), y = glm::dot(p - c[0], frame.v);
        lowU = std::min(lowU, x), lowV = std::min(lowV, y);
        highU = std::max(highU, x), highV = std::max(highV, y);
    }
    frame.origin += lowU * frame.u + lowV * frame.v;
    frame.width = highU - lowU, frame.height = highV - lowV;
    return frame;
}

uint32_t parts(double length, double widest, uint32_t most) {
    return widest * most <= length ? most : static_cast<uint32_t>(std::max(1.0, std::ceil(length / widest)));
}

} // namespace

void mergeShares(std::vector<OutsideShare>& shares) {
    std::ranges::stable_sort(shares, {}, &OutsideShare::cell);
    size_t kept = 0;
    for (const OutsideShare& share : shares)
        if (kept > 0 && shares[kept - 1].cell == share.cell)
            shares[kept - 1].weight += share.weight;
        else
            shares[kept++] = share;
    shares.resize(kept);
}

OutsideCells::OutsideCells(const geometry::PatchMesh& mesh, std::vector<ConvexRegion> regions,
                           std::span<const ConvexRegion> openings)
    : regions_(std::move(regions)), grids_(regions_.size()) {
    if (mesh.outside.material.empty() || openings.empty()) return;
    std::vector<size_t> bright;
    std::vector<Frame> frames;
    std::vector<double> widest;
    for (size_t r = 0; r < regions_.size(); ++r) {
        if (mesh.materials[regions_[r].group].reflectance == glm::vec3(0)) continue;
        bright.push_back(r);
        frames.push_back(frameOf(regions_[r]));
        const geometry::Bounds box = geometry::boundsOf(regions_[r].corners);
        double nearest = 1e300;
        for (const ConvexRegion& opening : openings)
            nearest = std::min(nearest, gap(box, geometry::boundsOf(opening.corners)));
        widest.push_back(kOfDistance * nearest);
    }
    for (uint32_t most = 8; most > 0; --most) {
        size_t count = 0;
        for (size_t k = 0; k < bright.size(); ++k) {
            Grid& grid = grids_[bright[k]];
            grid.across = parts(frames[k].width, widest[k], most);
            grid.along = parts(frames[k].height, widest[k], most);
            count += size_t{grid.across} * grid.along;
        }
        if (count <= kMostCells) break;
    }
    for (size_t k = 0; k < bright.size(); ++k) {
        Grid& grid = grids_[bright[k]];
        grid.origin = frames[k].origin;
        grid.u = frames[k].u * (grid.across / frames[k].width);
        grid.v = frames[k].v * (grid.along / frames[k].height);
        cut(bright[k], grid);
    }
}

void OutsideCells::cut(size_t region, Grid& grid) {
    const ConvexRegion& whole = regions_[region];
    const dvec3 normal = normalOf(whole);
    const double least = kSliver * areaOf(whole.corners);
    constexpr uint32_t kNone = UINT32_MAX;
    std::vector<dvec3> one, two;
    for (uint32_t j = 0; j < grid.along; ++j)
        for (uint32_t i = 0; i < grid.across; ++i) {
            const auto beyond = [&](dvec3 axis, double from, double side, const std::vector<dvec3>& in,
                                    std::vector<dvec3>& out) {
                geometry::clip<dvec3>(
                    in, [&](const dvec3& p) { return side * (glm::dot(p - grid.origin, axis) - from); }, out);
            };
            beyond(grid.u, i, 1, whole.corners, one), beyond(grid.u, i + 1, -1, one, two);
            beyond(grid.v, j, 1, two, one), beyond(grid.v, j + 1, -1, one, two);
            if (two.size() < 3 || areaOf(two) <= least) {
                grid.cell.push_back(kNone);
                continue;
            }
            grid.cell.push_back(static_cast<uint32_t>(cells_.size()));
            cells_.push_back(
                {two, viewCell(two, normal).centre, normal, static_cast<uint32_t>(region), whole.group});
        }
    // Beside slivers: the nearest cell.
    const std::vector<uint32_t> found = grid.cell;
    for (size_t at = 0; at < found.size(); ++at) {
        if (found[at] != kNone) continue;
        long best = -1;
        for (size_t other = 0; other < found.size(); ++other) {
            if (found[other] == kNone) continue;
            const auto step = [&](size_t k) {
                const long x = long(k % grid.across) - long(at % grid.across),
                           y = long(k / grid.across) - long(at / grid.across);
                return x * x + y * y;
            };
            if (best < 0 || step(other) < step(static_cast<size_t>(best))) best = static_cast<long>(other);
        }
        grid.cell[at] = found[static_cast<size_t>(best)];
    }
}

uint32_t OutsideCells::cellAt(size_t region, dvec3 point) const {
    const Grid& grid = grids_[region];
    const auto place = [&](dvec3 axis, uint32_t count) {
        return static_cast<uint32_t>(
            std::clamp(std::floor(glm::dot(point - grid.origin, axis)), 0.0, double(count - 1)));
    };
    return grid.cell[place(grid.v, grid.along) * grid.across + place(grid.u, grid.across)];
}

} // namespace heliodon::compute
