#include "engine/passes/projector_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "engine/passes/weighted_quantile.h"

namespace heliodon::passes {

namespace {

// A. van Oosterom and J. Strackee, "The solid angle of a plane triangle" (1983).
double solidAngle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
    const double volume = glm::dot(a, glm::cross(b, c)), la = glm::length(a), lb = glm::length(b),
                 lc = glm::length(c);
    return 2 * std::atan2(std::abs(volume),
                          la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
}

} // namespace

double fullIntensity(const geometry::Projector& projector) {
    // A grid over the panel follows the lens; its cells are small enough to be taken as flat.
    constexpr int kCells = 16;
    const auto corner = [&](int i, int j) {
        return glm::dvec3(projector.lens.planeFromPixel({-0.5 + projector.width * i / double{kCells},
                                                         -0.5 + projector.height * j / double{kCells}}),
                          1);
    };
    double total = 0;
    for (int i = 0; i < kCells; ++i)
        for (int j = 0; j < kCells; ++j)
            total += solidAngle(corner(i, j), corner(i + 1, j), corner(i, j + 1)) +
                     solidAngle(corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
    return projector.lumens / total;
}

namespace {

// Exitance of each triangle's middle at which the first of its projectors is at its full; 0 where none sees
// it.
std::vector<double> reachOfTriangles(const ShownMesh& shown, const geometry::Rig& rig) {
    std::vector<double> reachable(shown.blend.visible.size());
    std::vector<glm::dvec3> centres;
    for (const geometry::Projector& projector : rig.projectors) centres.push_back(projector.centre());
    for (size_t t = 0; t < reachable.size(); ++t) {
        const DrawCorner* corner = &shown.mesh.corners[3 * t];
        const glm::dvec3 a(corner[0].position), b(corner[1].position), c(corner[2].position),
            normal(corner[0].normal);
        const glm::dvec3 middle = (a + b + c) / 3.0;
        const std::vector<double> shares = geometry::blendShares(shown.blend, t, middle, normal, centres);
        double reach = std::numeric_limits<double>::infinity();
        for (size_t p = 0; p < shares.size(); ++p)
            if (shares[p] > 0)
                reach = std::min(reach, shown.blend.candela[p] * rig.surfaceReflectance *
                                            geometry::steepnessAt(middle, normal, centres[p]) / shares[p]);
        if (std::isfinite(reach)) reachable[t] = reach;
    }
    return reachable;
}

} // namespace

PaintedPatches paintedPatches(const geometry::PatchMesh& mesh, const ShownMesh& shown,
                              const geometry::Rig& rig) {
    const std::vector<double> reach = reachOfTriangles(shown, rig);
    std::vector<double> all(mesh.patchCount()), seen(mesh.patchCount()), sum(mesh.patchCount());
    std::vector<std::pair<double, double>> reachAndArea;
    double seenInAll = 0;
    for (size_t t = 0; t < reach.size(); ++t) {
        const double area = shown.mesh.area(t);
        all[shown.mesh.patch[t]] += area;
        if (!(reach[t] > 0)) continue;
        seen[shown.mesh.patch[t]] += area, sum[shown.mesh.patch[t]] += area * reach[t];
        reachAndArea.emplace_back(reach[t], area);
        seenInAll += area;
    }
    PaintedPatches painted;
    painted.reflectance = rig.surfaceReflectance;
    std::sort(reachAndArea.begin(), reachAndArea.end());
    painted.white = reachAndArea.empty() ? 0 : weightedQuantile(reachAndArea, seenInAll, 0.1);
    for (size_t p = 0; p < all.size(); ++p) {
        painted.share.push_back(seen[p] > 0 ? static_cast<float>(seen[p] / all[p]) : 0.0f);
        painted.reach.push_back(seen[p] > 0 ? static_cast<float>(sum[p] / seen[p]) : 0.0f);
    }
    return painted;
}

} // namespace heliodon::passes
