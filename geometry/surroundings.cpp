#include "geometry/surroundings.h"

#include <algorithm>

#include <glm/geometric.hpp>

#include "geometry/segment_distance.h"

namespace heliodon::geometry {

namespace {

constexpr double kFinestSize = 0.01 * kMetresPerInch; // below, in the tip of a wedge, triangles vanish
// A triangle may be so much longer along a strip than the strip is wide, beside what it may be at a short
// edge.
constexpr double kFacing = 1.6;

} // namespace

std::vector<std::vector<double>> surroundingsOf(const MeshDomain& domain) {
    std::vector<std::vector<double>> sizes(domain.loops.size());
    for (size_t l = 0; l < domain.loops.size(); ++l)
        for (size_t k = 0, count = domain.loops[l].size(); k < count; ++k) {
            const uint32_t v = domain.loops[l][k];
            const glm::dvec2 p = domain.planar[l][k];
            double size = std::min(glm::length(domain.planar[l][(k + 1) % count] - p),
                                   glm::length(domain.planar[l][(k + count - 1) % count] - p));
            for (size_t m = 0; m < domain.loops.size(); ++m)
                for (size_t i = 0, n = domain.loops[m].size(); i < n; ++i) {
                    const size_t j = (i + 1) % n;
                    if (domain.loops[m][i] == v || domain.loops[m][j] == v) continue;
                    size = std::min(size,
                                    kFacing * distanceToSegment(p, domain.planar[m][i], domain.planar[m][j]));
                }
            sizes[l].push_back(std::max(size, kFinestSize));
        }
    return sizes;
}

} // namespace heliodon::geometry
