#include "compute/ribbon_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>

#include "compute/daylight/quadrature.h"
#include "compute/lighting.h"
#include "compute/patch_points.h"
#include "geometry/clip_polygon.h"
#include "geometry/outline_area.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr auto kGauss3 = daylight::gaussLegendre<3>();
constexpr double kStep = 0.6;                   // radians of azimuth at first
constexpr double kAgrees = 1e-3, kSmall = 2e-5; // of a step's light and of all so far: what may be off
constexpr int kDeepest = 10;                    // halvings of a step
// Heights between which rows of the ribbon lie: its light reaches up to the last where b is small or below 0.
constexpr std::array kCuts{0.0, 0.025, 0.08, daylight::kRibbonTop};
const double kTopSlope = daylight::kRibbonTop / std::sqrt(1 - daylight::kRibbonTop * daylight::kRibbonTop);
// Of how far a patch's points lie apart, what four of them may be off, and of many, over their number; of the
// last change, what may be left. Off by this share of its light and the usual one, it is told by more points.
constexpr double kCurved = 0.1, kEdge = 0.5, kChangeLeft = 0.5, kOff = 0.01;
constexpr double kTowardsMiddle = 0.02; // of corners, so that they lie on their patch

// By more than rounding; so is a polygon whose corners are: what lies above is convex.
bool isAboveRibbon(const dvec3& p) {
    constexpr double kSurely = 1 + 1e-6;
    return p.y > kSurely * kTopSlope * std::sqrt(p.x * p.x + p.z * p.z);
}

} // namespace

// A convex polygon seen from a point: planes through its edges, which bound heights by azimuth.
struct RibbonLight::Fan {
    std::vector<dvec3> sides; // inward normals
    std::vector<double> turns;

    explicit Fan(const PointView::Polygon& part) {
        dvec3 middle(0);
        for (const dvec3& p : part) middle += p;
        const double sign = glm::dot(geometry::areaVector(part), middle) < 0 ? -1 : 1;
        for (size_t k = 0; k < part.size(); ++k) {
            const dvec3 side = glm::cross(part[k], part[(k + 1) % part.size()] - part[k]);
            const double length = glm::length(side);
            if (length > 0) sides.push_back(sign / length * side);
            turns.push_back(std::atan2(part[k].x, -part[k].z));
        }
        std::ranges::sort(turns);
        turns.push_back(turns[0] + 2 * kPi);
    }
    // Slopes between which it is seen in the direction of a level unit vector; none where first >= second.
    std::pair<double, double> slopes(dvec3 level) const {
        double low = 0, high = kTopSlope;
        for (const dvec3& side : sides) {
            const double at = glm::dot(side, level);
            if (std::abs(side.y) < 1e-12) {
                if (at < 0) return {0, 0};
            } else if (side.y > 0) {
                low = std::max(low, -at / side.y);
            } else {
                high = std::min(high, -at / side.y);
            }
        }
        return {low, high};
    }
};

RibbonLight::RibbonLight(const PointScene& scene, const daylight::Sky& sky)
    : scene_(&scene), sky_(&sky), ribbon_(sky.formula) {
    static_assert(kCuts.size() == std::tuple_size_v<decltype(rows_)> + 1);
    for (size_t k = 0; k < rows_.size(); ++k) rows_[k] = ribbon_.between(kCuts[k], kCuts[k + 1]);
}

dvec3 RibbonLight::ofPart(const PointView::Polygon& part, dvec3 normal,
                          const PointScene::GlassBefore& glass) const {
    const Fan fan(part);
    const auto height = [](double slope) { return slope / std::sqrt(1 + slope * slope); };
    // At one azimuth, of what lies between two heights. What changes slowly with height is taken at the
    // light's mean height.
    const auto row = [&](dvec3 level, const daylight::HorizonRibbon::Integral& between) {
        const auto [light, moment] = between;
        if (light <= 0) return dvec3(0);
        const double z = moment / light;
        const dvec3 direction = std::sqrt(1 - z * z) * level + dvec3(0, z, 0);
        const double cosine = glm::dot(direction, normal),
                     around = daylight::indicatrix(sky_->formula, glm::dot(direction, sky_->shapeDirection));
        if (cosine <= 0 || around <= 0) return dvec3(0);
        return light * cosine * around * glass.transmittance(direction);
    };
    const auto along = [&](double turn) {
        const dvec3 level(std::sin(turn), 0, -std::cos(turn));
        const auto [low, high] = fan.slopes(level);
        dvec3 sum(0);
        if (low >= high) return sum;
        const double top = height(high);
        double from = height(low);
        for (size_t k = 0; k < rows_.size(); ++k) {
            const double to = std::min(kCuts[k + 1], top);
            if (from >= to) continue;
            const bool whole = from == kCuts[k] && to == kCuts[k + 1]; // most, through tall windows
            sum += row(level, whole ? rows_[k] : ribbon_.between(from, to));
            from = to;
        }
        return sum;
    };
    const auto rule = [&](double from, double to) {
        dvec3 sum(0);
        for (const auto& [x, weight] : kGauss3) sum += weight * (to - from) * along(from + x * (to - from));
        return sum;
    };
    dvec3 sum(0);
    const auto refine = [&](const auto& self, double from, double to, dvec3 whole, int depth) -> void {
        const double middle = 0.5 * (from + to);
        const dvec3 first = rule(from, middle), second = rule(middle, to), both = first + second;
        const double much = photometric(both), off = std::abs(photometric(both - whole));
        if (depth == 0 || off <= kAgrees * much + kSmall * photometric(sum)) {
            sum += both;
            return;
        }
        self(self, from, middle, first, depth - 1);
        self(self, middle, to, second, depth - 1);
    };
    for (size_t k = 0; k + 1 < fan.turns.size(); ++k) {
        const double from = fan.turns[k], all = fan.turns[k + 1] - from;
        if (all <= 1e-12) continue;
        const dvec3 between(std::sin(from + 0.5 * all), 0, -std::cos(from + 0.5 * all));
        if (const auto [low, high] = fan.slopes(between); low >= high && all >= kPi) continue; // behind
        const auto steps = static_cast<int>(std::ceil(all / kStep));
        for (int j = 0; j < steps; ++j) {
            const double a = from + all * j / steps, b = from + all * (j + 1) / steps;
            refine(refine, a, b, rule(a, b), kDeepest);
        }
    }
    return sky_->formula.scale * sum;
}

dvec3 RibbonLight::at(dvec3 position, dvec3 normal, uint32_t room) const {
    dvec3 sum(0);
    if (!scene_->mayShowLow(position, normal, room, kTopSlope)) return sum;
    PointView::Polygon above;
    scene_->forOutside(PointView(scene_->blockers(), position, normal, room), room,
                       [&](const PointView::Polygon& part, const PointScene::GlassBefore& glass) {
                           if (std::ranges::all_of(part, isAboveRibbon)) return; // as skylights' are
                           geometry::clip<dvec3>(
                               part, [](const dvec3& p) { return p.y; }, above);
                           if (!above.empty()) sum += ofPart(above, normal, glass);
                       });
    return sum;
}

dvec3 RibbonLight::byWalls(const NearLight& near, uint32_t room) const {
    dvec3 sum(0);
    for (const NearLight::Cell& cell : near.cells)
        sum += dvec3(cell.answer) * at(cell.middle, cell.normal, room);
    return sum;
}

RibbonLight::Mean RibbonLight::onPatch(uint32_t patch, double usual) const {
    const geometry::PatchMesh& mesh = scene_->mesh();
    const dvec3 normal = scene_->patches()[patch].normal, middle = scene_->patches()[patch].centre;
    double least = 1e300, most = 0;
    const auto see = [&](dvec3 position) {
        const dvec3 lux = at(position, normal, mesh.room[patch]);
        const double much = photometric(lux);
        least = std::min(least, much), most = std::max(most, much);
        return lux;
    };
    const auto mean = [&](std::span<const dvec3> points) {
        dvec3 sum(0);
        for (const dvec3& point : points) sum += see(point);
        return sum / static_cast<double>(points.size());
    };
    std::vector<dvec3> four;
    for (const Viewpoint& v : patchViewpoints(mesh, 4, patch, 1).viewpoints) four.push_back(v.position);
    Mean result{mean(four), 0};
    for (const dvec3& corner : geometry::patchCorners(mesh, patch))
        see(glm::mix(corner, middle, kTowardsMiddle));
    result.error = kCurved * (most - least);
    for (uint32_t points = 16; points <= 256; points *= 4) {
        if (result.error <= kOff * (photometric(result.lux) + usual)) break;
        const dvec3 before = std::exchange(result.lux, mean(spreadPoints(mesh, patch, points)));
        // An edge of light that runs through the patch is told by the points on either side.
        result.error = std::max(kChangeLeft * std::abs(photometric(result.lux - before)),
                                kEdge * (most - least) / points);
    }
    return result;
}

} // namespace heliodon::compute
