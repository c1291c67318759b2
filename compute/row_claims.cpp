#include "compute/row_claims.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "compute/contour_exchange.h"
#include "compute/convex_regions.h"
#include "compute/hierarchical.h"
#include "compute/monte_carlo.h"
#include "compute/narrow_gaps.h"
#include "geometry/bounds.h"
#include "geometry/outline_area.h"

namespace heliodon::compute {

namespace {

// Rays begin and end at planes to within float32's rounding of the scene: of faces nearer to one another they
// leave one and miss the other, so that what lies under a neighbour may lose all its light.
void claimGapsThatRaysMiss(const geometry::PatchMesh& mesh, FormFactorReport& report) {
    std::vector<double> covered(mesh.patchCount(), 0.0);
    double widest = 0;
    for (const NarrowGaps::Overlap& overlap : narrowGaps(mesh, planeNumbers(mesh)).overlaps) {
        const double area = overlap.area();
        covered[overlap.first] += area, covered[overlap.second] += area;
        widest = std::max(widest, overlap.gap);
    }
    double squares = 0;
    for (size_t i = 0; i < covered.size(); ++i)
        if (covered[i] > 0) squares += std::pow(covered[i] / geometry::patchArea(mesh, i), 2);
    if (!(squares > 0)) return;
    report.claimedRowError =
        std::hypot(report.claimedRowError, std::sqrt(squares / static_cast<double>(covered.size())));
    report.warnings.push_back(fmt::format(
        "{} patches face others across gaps of at most {:.1g} m, which rays do not tell from none: light "
        "between them is lost; --kernel exact or hierarchical keeps it",
        std::ranges::count_if(covered, [](double area) { return area > 0; }), widest));
}

// And along the foot of a wall, where they take it for their own plane: a strip of each patch, along its
// border, may lose what it sends there, half of its light.
void claimFeetThatRaysMiss(const geometry::PatchMesh& mesh, FormFactorReport& report) {
    const double strip = kMonteCarloInPlane * geometry::boundsOf(mesh.vertices).diagonal();
    double squares = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const double area = geometry::patchArea(mesh, i);
        if (!(area > 0)) continue;
        const double border = geometry::perimeter(geometry::patchCorners(mesh, i));
        squares += std::pow(0.5 * std::min(strip * border / area, 1.0), 2);
    }
    report.claimedRowError =
        std::hypot(report.claimedRowError, std::sqrt(squares / static_cast<double>(mesh.patchCount())));
}

} // namespace

// No patch sends more than all of its light: what a row has above one is an error, whatever its kernel
// claims. Sums may be off by more than their row as long as errors of entries are alike; beyond that the
// claims grow.
void claimExcess(std::span<const double> rowSums, FormFactorReport& report) {
    constexpr double kRounding = 1e-5;
    const double likely =
        std::max({kSumOverRow * report.claimedRowError, report.claimedRowSumError, kRounding});
    double squares = 0, worst = 0;
    size_t rows = 0;
    for (double sum : rowSums)
        if (sum - 1 > likely) {
            squares += (sum - 1) * (sum - 1);
            worst = std::max(worst, sum - 1);
            ++rows;
        }
    if (rows == 0) return;
    report.claimedRowError =
        std::hypot(report.claimedRowError, std::sqrt(squares / static_cast<double>(rowSums.size())));
    report.claimedRowSumError = std::max(report.claimedRowSumError, worst);
    report.warnings.push_back(fmt::format(
        "the form factors of {} patch{} sum to more than one, by up to {:.2g}: of patches much smaller than "
        "others, or where faces nearly or wholly lie in one place",
        rows, rows == 1 ? "" : "es", worst));
}

// Which of faces in one place light meets is not defined: kernels give it to one, to each or in parts, so
// that an entry may be off by all that they get together.
void claimDuplicates(const geometry::PatchMesh& mesh, const MatrixOnHost& F, FormFactorReport& report) {
    const size_t n = mesh.patchCount();
    const std::vector<std::vector<uint32_t>> groups = patchesInOnePlace(mesh);
    if (groups.empty()) return;
    double squares = 0;
    for (const std::vector<uint32_t>& group : groups) {
        for (size_t i = 0; i < n; ++i) {
            double together = 0;
            for (uint32_t j : group) together += double{F[i * n + j]};
            squares += static_cast<double>(group.size() - 1) * together * together;
        }
        // Their own rows are parted alike, by what light sees of each.
        for (uint32_t i : group)
            for (size_t j = 0; j < n; ++j) squares += std::pow(double{F[i * n + j]}, 2);
    }
    report.claimedRowError = std::hypot(report.claimedRowError, std::sqrt(squares / static_cast<double>(n)));
}

void claimCrossings(const geometry::PatchMesh& mesh, const MatrixOnHost& F, FormFactorReport& report) {
    const size_t n = mesh.patchCount();
    std::map<std::pair<uint32_t, uint32_t>, double> covered; // m2
    for (const NarrowGaps::Overlap& overlap : crossedGaps(mesh, planeNumbers(mesh)))
        for (const auto& pair : {std::pair(overlap.first, overlap.second), std::pair(overlap.second, overlap.first)})
            covered[pair] += overlap.area();
    if (covered.empty()) return;
    double squares = 0;
    for (const auto& [pair, area] : covered) {
        const float* row = F.data() + pair.first * n;
        const double lost = std::max(0.0, std::min(1.0, area / geometry::patchArea(mesh, pair.first)) -
                                              double{row[pair.second]});
        double rest = 0; // has what is lost
        for (size_t j = 0; j < n; ++j) rest += std::pow(double{row[j]}, 2);
        squares += lost * lost * (1 + rest);
    }
    report.claimedRowError = std::hypot(report.claimedRowError, std::sqrt(squares / static_cast<double>(n)));
}

void claimWhatRaysMiss(const geometry::PatchMesh& mesh, FormFactorReport& report) {
    claimGapsThatRaysMiss(mesh, report);
    claimFeetThatRaysMiss(mesh, report);
}

// What two faces lack that share an edge and open so little that float32 takes both planes for one: needles.
void claimWedges(const geometry::PatchMesh& mesh, const MatrixOnHost& F, FormFactorReport& report) {
    constexpr double kFlat = 5e-7, kNothing = 1e-12; // of the scene
    constexpr double kOpens = 0.99;                  // cosine between normals of what is no wall in pieces
    const size_t n = mesh.patchCount();
    const double size = geometry::boundsOf(mesh.vertices).diagonal();
    std::map<std::array<double, 7>, uint32_t> byEdge;
    const auto edgeOf = [&](size_t i, glm::dvec3 a, glm::dvec3 b) {
        return std::array<double, 7>{1.0 * mesh.room[i], a.x, a.y, a.z, b.x, b.y, b.z};
    };
    const auto highest = [&](size_t plane, const std::vector<glm::dvec3>& corners) {
        double height = 0;
        for (const glm::dvec3& p : corners)
            height = std::max(height, glm::dot(geometry::patchNormal(mesh, plane),
                                               p - mesh.vertices[mesh.patch(plane)[0]]));
        return height;
    };
    const auto flat = [&](double height) { return height > kNothing * size && height <= kFlat * size; };
    double squares = 0;
    for (uint32_t i = 0; i < n; ++i) {
        const std::vector<glm::dvec3> own = geometry::patchCorners(mesh, i);
        for (size_t k = 0; k < own.size(); ++k) {
            const glm::dvec3 a = own[k], b = own[(k + 1) % own.size()];
            byEdge.emplace(edgeOf(i, a, b), i);
            const auto found = byEdge.find(edgeOf(i, b, a));
            if (found == byEdge.end()) continue;
            const uint32_t j = found->second;
            if (!(geometry::patchArea(mesh, i) > 0) || !(geometry::patchArea(mesh, j) > 0) ||
                glm::dot(geometry::patchNormal(mesh, i), geometry::patchNormal(mesh, j)) > kOpens)
                continue;
            const std::vector<glm::dvec3> other = geometry::patchCorners(mesh, j);
            if (!flat(highest(i, other)) || !flat(highest(j, own))) continue;
            const double exchange = contourExchange(own, other);
            for (const auto& [p, q] : {std::pair(i, j), std::pair(j, i)})
                squares += std::pow(
                    std::max(0.0, exchange / geometry::patchArea(mesh, p) - double{F[p * n + q]}), 2);
        }
    }
    report.claimedRowError = std::hypot(report.claimedRowError, std::sqrt(squares / static_cast<double>(n)));
}

} // namespace heliodon::compute
