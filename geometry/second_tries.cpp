#include "geometry/second_tries.h"

#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace heliodon::geometry {

namespace {

constexpr double kApart = 0.45;       // angles are better now with this, now with less
constexpr double kWorthWhile = 0.002; // in terms of a cosine
constexpr size_t kFew = 8; // bad triangles: more take long, unless they are too many to be mended well

} // namespace

PlanarMesh SecondTries::best(PlanarMesh first, const PlanarDomain& domain, size_t mostAdded, Range range) {
    static const double kSmall = std::cos(36 * std::numbers::pi / 180);
    PlanarDomain again = domain;
    again.apart = kApart;
    for (const double lattice : {0.95, 1.03}) {
        const SmallAngles& small = first.small;
        if (small.worst <= kSmall || !small.atInner || most_ < 0) break;
        if (small.triangles > kFew && !small.crowded) break;
        std::optional<PlanarNet> net = draftMesh(again, latticeSeeds(again, lattice * again.size.edge()));
        if (!net) continue;
        const auto drafted = static_cast<double>(net->corner.size());
        most_ -= drafted;
        // Each point that optimisation adds makes two triangles.
        if (drafted > range.most || drafted + 2 * static_cast<double>(mostAdded) < range.least) continue;
        PlanarMesh mesh = improvedMesh(std::move(*net), again, mostAdded);
        const auto count = static_cast<double>(mesh.triangles.size());
        if (count < range.least || count > range.most || mesh.small.worst > small.worst - kWorthWhile)
            continue;
        first = std::move(mesh);
    }
    return first;
}

} // namespace heliodon::geometry
