#include "geometry/twin_faces.h"

#include <algorithm>
#include <limits>

#include <glm/geometric.hpp>

#include "geometry/mesh_domains.h"

namespace heliodon::geometry {

namespace {

glm::dvec3 middleOf(const Building& building, const Face& face) {
    glm::dvec3 low(1e300), high(-1e300);
    for (const uint32_t v : face.loops[0]) {
        low = glm::min(low, building.vertices[v]);
        high = glm::max(high, building.vertices[v]);
    }
    return 0.5 * (low + high);
}

} // namespace

glm::dvec3 shiftBetween(const Building& building, const Face& from, const Face& to) {
    return middleOf(building, to) - middleOf(building, from);
}

std::optional<std::vector<OppositeLoop>> oppositeLoops(const Building& building, const Face& face,
                                                       const Face& other, double tolerance) {
    if (face.loops.size() != other.loops.size()) return std::nullopt;
    const glm::dvec3 shift = shiftBetween(building, face, other);
    std::vector<OppositeLoop> out;
    std::vector<bool> taken(other.loops.size(), false);
    for (size_t l = 0; l < face.loops.size(); ++l) {
        const auto& loop = face.loops[l];
        const size_t n = loop.size();
        OppositeLoop best;
        double least = std::numeric_limits<double>::infinity();
        for (size_t m = 0; m < other.loops.size(); ++m) {
            if (taken[m] || other.loops[m].size() != n || (m == 0) != (l == 0)) continue;
            for (size_t first = 0; first < n; ++first) {
                const OppositeLoop tried{m, first};
                double worst = 0;
                for (size_t k = 0; k < n && worst < least; ++k)
                    worst =
                        std::max(worst, glm::length(building.vertices[loop[k]] + shift -
                                                    building.vertices[other.loops[m][tried.corner(k, n)]]));
                if (worst >= least) continue;
                least = worst;
                best = tried;
            }
        }
        if (!(least <= tolerance)) return std::nullopt;
        taken[best.loop] = true;
        out.push_back(best);
    }
    return out;
}

bool twinsMirror(const Building& building, double tolerance) {
    return std::ranges::all_of(building.faces, [&](const Face& face) {
        if (face.twin < 0) return true;
        const Face& other = building.faces[static_cast<size_t>(face.twin)];
        return other.twin >= 0 && &building.faces[static_cast<size_t>(other.twin)] == &face &&
               glm::dot(faceNormal(building, face), faceNormal(building, other)) < kBackToBack &&
               oppositeLoops(building, face, other, tolerance).has_value();
    });
}

} // namespace heliodon::geometry
