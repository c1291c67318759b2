#include "compute/sun_edges.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "compute/lighting.h"
#include "tests/compute/rooms.h"

namespace heliodon::compute {
namespace {

// A box with a slab in it, which hides parts of the walls from most places.
geometry::PatchMesh roomWithSlab() {
    geometry::PatchMesh mesh = test::boxRoom({.cells = {10, 8, 12}});
    const size_t room = mesh.corners.size();
    test::addBox(mesh, {.low = {1, 0.9, 2.2}, .high = {2.6, 1, 3.6}, .cells = {1, 1, 1}});
    std::reverse(mesh.corners.begin() + static_cast<long>(room), mesh.corners.end()); // it faces outwards
    std::ranges::fill(mesh.room, 0u);
    return mesh;
}

// Each patch lit in one of its corners in an hour of its own.
std::vector<std::vector<SunEdges::Edge>> cornersLit(const geometry::PatchMesh& mesh, float light,
                                                    float beyond) {
    std::vector<std::vector<SunEdges::Edge>> hours;
    for (uint32_t i = 0; i < mesh.patchCount(); ++i) {
        const std::vector<glm::dvec3> p = geometry::patchCorners(mesh, i);
        const std::vector<glm::dvec3> corner{p[0], glm::mix(p[0], p[1], 0.4), glm::mix(p[0], p[2], 0.3)};
        hours.push_back(SunEdges::edgesOf(mesh, {{i, {{corner, glm::vec3(light)}}}}, 1));
        hours.back()[0].beyond = glm::vec3(beyond);
    }
    return hours;
}

struct Places {
    geometry::PatchMesh mesh = roomWithSlab();
    PointScene scene{mesh};
    std::vector<std::vector<float>> even;
    std::vector<SunEdges::Place> places;

    explicit Places(size_t count) {
        std::minstd_rand random(5);
        std::uniform_real_distribution<double> part(0.1, 0.9), slant(-1, 1);
        even.resize(count);
        for (std::vector<float>& row : even) {
            const glm::dvec3 at(4 * part(random), 0.6 * part(random), 5 * part(random));
            const PointView view(scene.blockers(), at,
                                 glm::normalize(glm::dvec3(slant(random), 1, slant(random))), 0);
            for (uint32_t i = 0; i < mesh.patchCount(); ++i)
                row.push_back(static_cast<float>(scene.factor(view, i)));
            places.push_back({view, 0, row.data()});
        }
    }

    // Whether a patch is near, hidden in part or cut by the horizon, be it by a sliver above: middles do not
    // tell its edges.
    bool isIntricate(const SunEdges::Place& place, uint32_t patch) const {
        std::vector<glm::dvec3> above;
        const std::vector<glm::dvec3> corners = geometry::patchCorners(mesh, patch);
        double lowest = 0, highest = 0;
        for (const glm::dvec3& corner : corners) {
            const double height = glm::dot(corner - place.view.position(), place.view.normal());
            lowest = std::min(lowest, height), highest = std::max(highest, height);
        }
        return place.even[patch] >= 0.0201F || -lowest > 0.06 * (highest - lowest) ||
               place.even[patch] < 0.94 * place.view.openFactor(corners, above);
    }

    double exact(const SunEdges::Place& place, const SunEdges::Edge& edge) const {
        double lux = -double{place.even[edge.patch]} * photometric(edge.exitance + edge.beyond);
        for (const SunEdges::Edge::Part& part : edge.parts)
            lux += place.view.factor(part.polygon) * photometric(part.exitance);
        return lux;
    }
};

// Whatever the sun gives a sensor else in an hour: what is there more or less is within a thousandth of it.
TEST(SunEdges, what_middles_do_not_tell_is_told_by_them_where_it_makes_no_thousandth) {
    const Places at(SunEdges::kTogether);
    size_t told = 0, exact = 0;
    for (const auto& [light, beyond] : {std::pair{1.0F, 0.0F}, {1.0F, 0.1F}, {1e-4F, 0.1F}, {1e-4F, -0.1F}}) {
        const auto hours = cornersLit(at.mesh, light, beyond);
        const SunEdges edges(at.mesh, hours);
        for (double else_ = 1e-4; else_ < 100; else_ *= 1.3) {
            std::vector<float> lux(hours.size() * at.places.size(), static_cast<float>(else_));
            edges.addTo(lux.data(), at.places.size(), at.scene, at.places);
            for (size_t s = 0; s < at.places.size(); ++s)
                for (size_t h = 0; h < hours.size(); ++h) {
                    const SunEdges::Edge& edge = hours[h][0];
                    if (at.places[s].even[edge.patch] < kEdgeShare ||
                        !at.isIntricate(at.places[s], edge.patch))
                        continue;
                    const double off = std::abs(double{lux[h * at.places.size() + s]} - else_ -
                                                at.exact(at.places[s], edge)),
                                 rounding = 2e-7 * else_ + 1e-6 * (light + std::abs(beyond));
                    EXPECT_LE(off, 1e-3 * else_ + rounding) << s << ", patch " << edge.patch;
                    (off > 10 * rounding ? told : exact)++;
                }
        }
    }
    EXPECT_GT(told, 500u);
    EXPECT_GT(exact, 500u);
}

// The last sensors are seldom as many as go together.
TEST(SunEdges, sensors_get_the_same_bits_in_any_company) {
    const Places at(SunEdges::kTogether + 5);
    const auto hours = cornersLit(at.mesh, 1, 0.1F);
    const SunEdges edges(at.mesh, hours);
    constexpr float kElse = 0.5F, kUntouched = 7;
    const size_t count = at.places.size(), stride = count + 3;
    std::vector<float> together(hours.size() * stride, kUntouched);
    for (size_t h = 0; h < hours.size(); ++h) std::fill_n(&together[h * stride], count, kElse);
    for (const size_t first : {size_t{0}, SunEdges::kTogether})
        edges.addTo(&together[first], stride, at.scene,
                    std::span(at.places).subspan(first, std::min(SunEdges::kTogether, count - first)));
    size_t changed = 0;
    for (size_t s = 0; s < stride; ++s) {
        std::vector<float> alone(hours.size(), s < count ? kElse : kUntouched);
        if (s < count) edges.addTo(alone.data(), 1, at.scene, std::span(at.places).subspan(s, 1));
        for (size_t h = 0; h < hours.size(); ++h) {
            EXPECT_EQ(together[h * stride + s], alone[h]) << s;
            changed += s >= SunEdges::kTogether && s < count && alone[h] != kElse;
        }
    }
    EXPECT_GT(changed, 100u);
}

TEST(SunEdges, sensors_in_no_room_get_nothing_and_leave_others_what_they_get) {
    Places at(3);
    const SunEdges edges(at.mesh, cornersLit(at.mesh, 1, 0));
    const auto luxOf = [&] {
        std::vector<float> lux(at.mesh.patchCount() * at.places.size(), 0);
        edges.addTo(lux.data(), at.places.size(), at.scene, at.places);
        return lux;
    };
    const std::vector<float> before = luxOf();
    at.places[1].room = geometry::kNoRoom;
    const std::vector<float> lux = luxOf();
    for (size_t k = 0; k < lux.size(); ++k) EXPECT_EQ(lux[k], k % 3 == 1 ? 0 : before[k]);
    EXPECT_NE(lux, before);
}

TEST(SunEdges, bits_do_not_depend_on_how_wide_vectors_are) {
    const Places at(SunEdges::kTogether);
    const auto hours = cornersLit(at.mesh, 1, 0.1F);
    const SunEdges edges(at.mesh, hours);
    NearLight near;
    near.cells.push_back({{0.02, 1, 2}, {1, 0, 0}, glm::vec3(0.5F)});
    const auto luxOf = [&](VectorWidth width) {
        std::vector<float> lux(hours.size() * at.places.size(), 0.3F), byCells(hours.size(), 0);
        edges.addTo(lux.data(), at.places.size(), at.scene, at.places, width);
        edges.addTo(byCells, at.scene, near, 0, width);
        EXPECT_GT(std::ranges::count_if(byCells, [](float l) { return l != 0; }), 50);
        lux.insert(lux.end(), byCells.begin(), byCells.end());
        return lux;
    };
    const std::vector<float> widest = luxOf(widestVectors());
    for (const VectorWidth width : {VectorWidth::baseline, VectorWidth::avx2})
        if (width <= widestVectors()) {
            EXPECT_EQ(luxOf(width), widest);
        }
}

} // namespace
} // namespace heliodon::compute
