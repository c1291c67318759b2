// What `exact` claims of single pairs with nothing between them, where one's border passes near the other:
// each pair in a room of its own, drawn at random, against contour integrals in double precision.
#include <algorithm>
#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "compute/contour_exchange.h"
#include "compute/exact_form_factors.h"
#include "compute/parallel.h"
#include "compute/reference/exact_form_factors.h"
#include "tests/compute/form_factor_cases.h"
#include "tests/gpu/test_device.h"

namespace heliodon::compute {
namespace {

using reference::Polygon;
constexpr size_t kPairs = 250;

struct Random {
    std::mt19937 bits;

    explicit Random(uint32_t seed) : bits(seed) {}
    double between(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(bits);
    }
    double scale(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
    bool coin() { return between(0, 1) < 0.5; }
};

// A rectangle, or a triangle with the same edge, around the point.
Polygon plate(Random& random, const glm::dvec3& about, const glm::dvec3& u, const glm::dvec3& v) {
    const glm::dvec3 corner = about - random.between(0.1, 0.9) * u - random.between(0.1, 0.9) * v;
    if (random.coin()) return {corner, corner + u, corner + u + v, corner + v};
    return {corner, corner + u, corner + random.between(0, 1) * u + v};
}

// Which faces the floor.
Polygon turnedDown(Polygon polygon) {
    if (glm::cross(polygon[1] - polygon[0], polygon[2] - polygon[0]).z > 0)
        std::reverse(polygon.begin(), polygon.end());
    return polygon;
}

// Pairs that are farther off than they claim, of those that are off by a fifth of what was asked and more.
size_t beyondTheirClaim(const std::vector<Polygon>& polygons, double asked) {
    geometry::PatchMesh mesh = test::meshOf(polygons);
    const size_t n = mesh.patchCount();
    for (size_t i = 0; i < n; ++i) mesh.room[i] = static_cast<uint32_t>(i / 2);
    std::vector<double> exchange(n / 2);
    inParallel(n / 2, [&](size_t k) { exchange[k] = contourExchange(polygons[2 * k], polygons[2 * k + 1]); });
    const ExactFormFactors result = exactFormFactors(test::device(), mesh, {asked});
    const std::vector<float> F = result.factors.values.download<float>(n * n);
    size_t beyond = 0;
    for (size_t i = 0; i < n; i += 2) {
        const auto error = [&](size_t from, size_t to) {
            return F[from * n + to] - exchange[i / 2] / reference::polygonArea(polygons[from]);
        };
        const double off = std::hypot(error(i, i + 1), error(i + 1, i)),
                     claim = std::hypot(result.rowError[i], result.rowError[i + 1]);
        beyond += off > claim && off > 0.2 * asked;
    }
    return beyond;
}

// Of needles that cross another plate only what lies about the crossing sees it, and all points of a row of
// cells along the needle may miss that.
TEST(OpenPairs, needles_that_cross_another_plate_keep_their_claims) {
    Random random(1);
    std::vector<Polygon> polygons;
    while (polygons.size() < 2 * kPairs) {
        const double angle = random.between(0.2, 2.9), tilt = random.coin() ? 0 : random.between(-0.01, 0.01);
        const glm::dvec3 along(std::cos(angle), std::sin(angle), tilt), across(-along.y, along.x, 0);
        polygons.push_back(plate(random, {0, 0, 0}, {1, 0, 0}, {0, 1 / random.scale(20, 500), 0}));
        polygons.push_back(turnedDown(
            plate(random, {0, 0, random.scale(1e-3, 2e-2)}, along, across / random.scale(2, 200))));
    }
    for (const double asked : {1e-2, 1e-3, 1e-4})
        EXPECT_LE(beyondTheirClaim(polygons, asked), kPairs / 100) << asked;
}

// A border along a row of cells, nearer to their edge than their outermost points, was missed by all of them.
TEST(OpenPairs, plates_that_share_an_edge_or_stand_over_one_another_keep_their_claims) {
    Random random(2);
    std::vector<Polygon> polygons;
    while (polygons.size() < 2 * kPairs) {
        const bool wedge = random.coin();
        const double angle = wedge ? 0 : random.between(0, 6.28), rise = random.scale(3e-2, 3),
                     height = wedge ? 0 : random.scale(1e-3, 5e-3);
        const glm::dvec3 along(std::cos(angle), std::sin(angle), 0), across(-along.y, along.x, 0),
            up = std::cos(rise) * across + std::sin(rise) * glm::dvec3(0, 0, 1);
        polygons.push_back(plate(random, {0, 0, 0}, {1, 0, 0}, {0, 1 / random.scale(1, 20), 0}));
        const Polygon& floor = polygons.back();
        Polygon over = plate(random, {0, 0, 0}, along, up / random.scale(0.5, 20));
        const glm::dvec3 move =
            (wedge ? floor[0] : glm::dvec3(random.between(-0.5, 0.5), 0, height)) - over[0];
        for (glm::dvec3& p : over) p += move;
        polygons.push_back(turnedDown(std::move(over)));
    }
    for (const double asked : {1e-2, 1e-3})
        EXPECT_LE(beyondTheirClaim(polygons, asked), kPairs / 100) << asked;
}

} // namespace
} // namespace heliodon::compute
