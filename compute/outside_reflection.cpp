#include "compute/outside_reflection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "compute/outside_walls.h"
#include "compute/parallel.h"
#include "compute/view_cells.h"
#include "geometry/bounds.h"
#include "geometry/clip_polygon.h"
#include "geometry/luminance.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

constexpr double kSkyAngle = 0.15, kCellAngle = 0.1; // radians, of one piece
constexpr double kSettled = 1e-5;                    // change of light, over the most of any cell
constexpr int kMostRounds = 200;

// A box round the origin, its sides cut at the horizon: each face sky alone or ground alone.
std::vector<PointView::Polygon> boxOfView() {
    std::vector<PointView::Polygon> faces;
    const std::array<dvec3, 4> round{dvec3(1, 0, 1), dvec3(1, 0, -1), dvec3(-1, 0, -1), dvec3(-1, 0, 1)};
    for (const double y : {1.0, -1.0}) {
        const dvec3 away(0, y, 0);
        PointView::Polygon& end = faces.emplace_back();
        for (const dvec3& p : round) end.push_back(p + away);
        for (size_t k = 0; k < 4; ++k) {
            const dvec3 a = round[k], b = round[(k + 1) % 4];
            faces.push_back({a, b, b + away, a + away});
        }
    }
    return faces;
}

// What a region may see, or be hidden by, each cut to what lies before its plane.
struct Surroundings {
    struct Other {
        size_t region;
        PointView::Polygon part;
    };
    std::vector<Other> others;              // that reflect
    std::vector<PointView::Polygon> hiding; // all of these, and those that are black
};

Surroundings surroundings(const OutsideCells& outside, size_t at, double tolerance) {
    const ConvexRegion& own = outside.regions()[at];
    const dvec3 normal = normalOf(own);
    Surroundings result;
    for (const ConvexRegion* other : seenFrom(own, outside.regions(), tolerance)) {
        PointView::Polygon part;
        geometry::clip<dvec3>(
            other->corners, [&](const dvec3& p) { return glm::dot(p - own.corners[0], normal) - tolerance; },
            part);
        if (part.empty()) continue;
        result.hiding.push_back(part);
        const auto region = static_cast<size_t>(other - outside.regions().data());
        if (outside.reflects(region)) result.others.push_back({region, std::move(part)});
    }
    return result;
}

// What the centre of a cell sees.
class CellView {
public:
    CellView(const PointScene& scene, const OutsideCell& cell, const Surroundings& around)
        : scene_(scene), cells_(scene.outside()), around_(around),
          view_(scene.blockers(), cell.centre, cell.normal), least_(scene.blockers().tolerance()) {
        for (const PointView::Polygon& polygon : around.hiding) hiding_.push_back(&polygon);
    }

    // Adds lux for each cd/m2 of the elements.
    void seeSky(const daylight::SkyPatches& sky, std::span<const PointView::Polygon> box,
                std::span<float> lux) const {
        std::vector<PointView::Polygon> parts;
        PointView::Polygon moved;
        for (const PointView::Polygon& face : box) {
            moved.clear();
            for (const dvec3& p : face) moved.push_back(view_.position() + p);
            if (view_.factor(moved, parts) <= 0) continue;
            view_.hideBeyond(hiding_, parts);
            const bool above = face[2].y > 0;
            for (const PointView::Polygon& part : parts)
                forSamples(view_, part, kSkyAngle, [&](dvec3 centre, double factor) {
                    const size_t element =
                        above ? sky.elementOf(glm::normalize(centre)) : sky.groundElement();
                    lux[element] += static_cast<float>(std::numbers::pi * factor);
                });
        }
        seeThroughRooms(sky, lux);
    }

    std::vector<OutsideShare> others() const {
        std::vector<OutsideShare> seen;
        std::vector<PointView::Polygon> parts;
        const PointView::Hiding hiding = view_.hidingBehind(hiding_);
        for (const auto& [region, part] : around_.others) {
            const ConvexRegion& whole = cells_.regions()[region];
            if (glm::dot(view_.position() - whole.corners[0], normalOf(whole)) <= least_) continue;
            if (view_.factor(part, parts) <= 0) continue;
            view_.hideBehind(hiding, parts);
            for (const PointView::Polygon& seenPart : parts)
                cells_.forParts(region, view_.position(), seenPart, kCellAngle,
                                [&](uint32_t cell, std::span<const dvec3> of) {
                                    const auto factor = static_cast<float>(view_.unhinderedFactor(of));
                                    seen.push_back({cell, glm::vec3(factor)});
                                });
        }
        mergeShares(seen);
        return seen;
    }

private:
    // Light that comes in by one window and goes out by another.
    void seeThroughRooms(const daylight::SkyPatches& sky, std::span<float> lux) const {
        PointView::Polygon halves[2];
        scene_.forOutsideThrough(
            view_, view_.hidingBehind(hiding_),
            [&](const PointView::Polygon& part, const PointScene::GlassBefore& glass) {
                splitAtHorizon(part, halves[0], halves[1]);
                for (const PointView::Polygon& half : halves) {
                    if (half.size() < 3) continue;
                    const bool above = &half == halves;
                    forSamples(view_, half, kSkyAngle, [&](dvec3 centre, double factor) {
                        const dvec3 towards = glm::normalize(centre);
                        const size_t element = above ? sky.elementOf(towards) : sky.groundElement();
                        lux[element] += static_cast<float>(
                            std::numbers::pi * factor *
                            geometry::photometric(glm::vec3(glass.transmittance(towards))));
                    });
                }
            });
    }

    const PointScene& scene_;
    const OutsideCells& cells_;
    const Surroundings& around_;
    PointView view_;
    double least_; // length
    std::vector<const PointView::Polygon*> hiding_;
};

} // namespace

OutsideReflection::OutsideReflection(const PointScene& scene, const daylight::SkyPatches& sky)
    : mesh_(&scene.mesh()), cells_(&scene.outside()) {
    if (isEmpty()) return;
    const double tolerance = kSamePlane * geometry::boundsOf(mesh_->vertices).diagonal();
    std::vector<Surroundings> around(cells_->regions().size());
    inParallel(around.size(), [&](size_t r) {
        if (cells_->reflects(r)) around[r] = surroundings(*cells_, r, tolerance);
    });
    elements_ = sky.elementCount();
    bySky_.assign(cells().size() * elements_, 0);
    std::vector<std::vector<OutsideShare>> seen(cells().size());
    const std::vector<PointView::Polygon> box = boxOfView();
    inParallel(cells().size(), [&](size_t c) {
        const CellView view(scene, cells()[c], around[cells()[c].region]);
        view.seeSky(sky, box, {&bySky_[c * elements_], elements_});
        seen[c] = view.others();
    });
    for (const std::vector<OutsideShare>& of : seen) {
        for (const OutsideShare& share : of) shares_.push_back({share.cell, share.weight.x});
        first_.push_back(shares_.size());
    }
}

std::vector<glm::vec3> OutsideReflection::reflectances() const {
    std::vector<glm::vec3> all;
    for (const OutsideCell& cell : cells()) {
        dvec3 mean(0);
        for (const auto& [material, share] : cell.materials)
            if (const geometry::Material& m = mesh_->materials[material]; !m.isOpening())
                mean += share * dvec3(m.reflectance);
        all.emplace_back(mean);
    }
    return all;
}

bool OutsideReflection::isGrey() const {
    return std::ranges::all_of(cells(), [&](const OutsideCell& cell) {
        return std::ranges::all_of(cell.materials, [&](const MaterialShare& m) {
            return geometry::isGrey(mesh_->materials[m.material].reflectance);
        });
    });
}

std::string OutsideReflection::inWords() const {
    const std::string what = "what stands outside: ",
                      crowd = "so many surfaces before a window that they are taken for black";
    if (!isEmpty() && cells_->tooMany())
        return what + crowd +
               fmt::format("; reflected light of {} cells of the rooms' outer sides", cells().size());
    if (!isEmpty()) return what + fmt::format("reflected light of {} cells", cells().size());
    if (mesh_->outside.triangles.empty() && !cells_->hasOuterSides()) return what + "nothing";
    if (mesh_->outside.triangles.empty()) return what + "nothing that reflects";
    return what + (cells_->tooMany() ? crowd : "black, reflects nothing");
}

std::vector<float> OutsideReflection::skyLight(std::span<const double> luminances) const {
    std::vector<float> lux;
    for (size_t c = 0; c < cells().size(); ++c) {
        double sum = 0;
        for (size_t e = 0; e < elements_; ++e) sum += double{bySky_[c * elements_ + e]} * luminances[e];
        lux.push_back(static_cast<float>(sum));
    }
    return lux;
}

std::vector<glm::vec3> OutsideReflection::sunlight(const SunPatches& sun) const {
    std::vector<glm::vec3> lit;
    for (const OutsideCell& cell : cells()) lit.emplace_back(sun.onStanding(cell.corners));
    return lit;
}

std::vector<glm::vec3> OutsideReflection::exitance(std::span<const glm::vec3> straight) const {
    const size_t n = straight.size();
    const std::vector<glm::vec3> rho = reflectances();
    std::vector<glm::vec3> sent(n), next(n);
    for (size_t c = 0; c < n; ++c) sent[c] = rho[c] * straight[c];
    for (int round = 0; round < kMostRounds && !shares_.empty(); ++round) {
        float change = 0, most = 0;
        for (size_t c = 0; c < n; ++c) {
            glm::vec3 lux = straight[c];
            for (const Share& share : seenFrom(c)) lux += share.factor * sent[share.cell];
            next[c] = rho[c] * lux;
            const glm::vec3 step = glm::abs(next[c] - sent[c]);
            change = std::max({change, step.x, step.y, step.z});
            most = std::max({most, next[c].x, next[c].y, next[c].z});
        }
        sent.swap(next);
        if (change <= kSettled * most) break;
    }
    return sent;
}

void OutsideReflection::answer(uint32_t channel, std::span<float> answers) const {
    const size_t n = answers.size();
    const auto axis = static_cast<int>(channel);
    const std::vector<glm::vec3> rho = reflectances();
    const std::vector<float> straight(answers.begin(), answers.end());
    std::vector<float> next(n);
    for (int round = 0; round < kMostRounds && !shares_.empty(); ++round) {
        next = straight;
        for (size_t c = 0; c < n; ++c) {
            const float sent = rho[c][axis] * answers[c];
            for (const Share& share : seenFrom(c)) next[share.cell] += share.factor * sent;
        }
        float change = 0, most = 0;
        for (size_t c = 0; c < n; ++c) {
            change = std::max(change, std::abs(next[c] - answers[c]));
            most = std::max(most, next[c]);
            answers[c] = next[c];
        }
        if (change <= kSettled * most) break;
    }
    for (size_t c = 0; c < n; ++c) answers[c] *= rho[c][axis];
}

} // namespace heliodon::compute
