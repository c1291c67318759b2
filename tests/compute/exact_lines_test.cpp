// shaders/exact_lines.comp against the same sums in double precision, and those against exact polygons.
#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "compute/convex_regions.h"
#include "compute/exact_scene.h"
#include "compute/gpu/commands.h"
#include "compute/gpu/counters.h"
#include "compute/gpu/kernel.h"
#include "compute/reference/exact_lines.h"
#include "shaders/io/exact_form_factors.io.h"
#include "spirv/exact_lines_comp.h"
#include "tests/compute/rooms.h"
#include "tests/gpu/test_device.h"

namespace heliodon::compute {
namespace {

using glm::dvec3;
using reference::LinesPair;
using reference::Polygon;

constexpr uint32_t kLevels = 3;

// Two walls of 3 x 2.5 m, 4 m apart, in triangles, and three screens between them.
struct Scene {
    geometry::PatchMesh mesh;
    ExactScene onDevice;
    std::vector<Polygon> blockers;
    std::vector<io::ExactRecord> records; // all pairs across, either piece first, behind `listed` screens
    std::vector<uint32_t> lists;

    Scene(uint32_t seed, uint32_t listed) {
        std::vector<Polygon> faces;
        for (double z : {0.0, 4.0})
            for (int i = 0; i < 5; ++i)
                for (int j = 0; j < 4; ++j) {
                    const dvec3 a(0.6 * i, 0.625 * j, z), u(0.6, 0, 0), v(0, 0.625, 0);
                    Polygon lower{a, a + u, a + u + v}, upper{a, a + u + v, a + v};
                    if (z > 0) std::swap(lower[1], lower[2]), std::swap(upper[1], upper[2]);
                    faces.push_back(lower), faces.push_back(upper);
                }
        const size_t walls = faces.size();
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> unit(0, 1);
        for (int k = 0; k < 3; ++k) {
            const dvec3 middle(3 * unit(random), 2.5 * unit(random), 1 + k + 0.4 * unit(random));
            const dvec3 u = glm::normalize(dvec3(1, unit(random) - 0.5, 0.3 * unit(random)));
            const dvec3 v = glm::normalize(glm::cross(dvec3(0.3 * unit(random), 0, 1), u));
            const double w = 0.2 + unit(random), h = 0.05 + 0.6 * unit(random);
            faces.push_back({middle - w * u - h * v, middle + w * u - h * v, middle + w * u + h * v,
                             middle - w * u + h * v});
        }
        mesh = test::polygons(faces);
        onDevice = exactScene(test::device(), mesh, 2304);
        for (const ConvexRegion& region : blockingRegions(mesh, io::kExactBlockerCorners))
            blockers.push_back(region.corners);
        for (uint32_t k = 0; k < listed; ++k) lists.push_back(onDevice.pieceCount + k);
        for (uint32_t i = 0; i < onDevice.pieceCount; ++i)
            for (uint32_t j = 0; j < onDevice.pieceCount; ++j)
                if (patchOf(i) < walls / 2 && patchOf(j) >= walls / 2 && patchOf(j) < walls)
                    records.push_back((i + j) % 2 ? io::ExactRecord{i, j, 0, listed}
                                                  : io::ExactRecord{j, i, 0, listed});
    }

    uint32_t patchOf(uint32_t piece) const { return onDevice.pieces[piece].patch; }

    LinesPair pair(const io::ExactRecord& record) const {
        const auto triangle = [&](uint32_t piece) {
            const Polygon p = geometry::patchCorners(mesh, patchOf(piece));
            return reference::Triangle{p[0], p[1], p[2]};
        };
        return {triangle(record.outer), triangle(record.inner), record.outer, record.inner,
                std::span(blockers).first(record.listed)};
    }
};

Polygon polygonOf(const reference::Triangle& t) {
    return {t.begin(), t.end()};
}

double areaOf(const reference::Triangle& t) {
    return reference::polygonArea(polygonOf(t));
}

double exchangeOf(const LinesPair& pair) {
    return reference::exchangeOccluded(polygonOf(pair.outer), polygonOf(pair.inner), pair.blockers, 1e-8, 400)
        .value;
}

// Per record, of the piece that carried the points at first.
std::vector<reference::Estimate> byKernel(const Scene& scene, double tolerance) {
    gpu::Device& device = test::device();
    const gpu::Kernel& kernel = device.kernels().get(exact_lines_comp, "exact_lines");
    const size_t count = scene.records.size();
    const gpu::Buffer records = gpu::Buffer::from(device, scene.records, "records"),
                      lists = gpu::Buffer::from(device, scene.lists, "lists"),
                      results(device, count * 16, "results");
    const gpu::Buffer again[2]{{device, count * 4, "again"}, {device, count * 4, "next"}};
    gpu::Counters counters(device, io::kExactCounters, "counters");
    constexpr VkFormat kFloats = VK_FORMAT_R32G32B32A32_SFLOAT;
    auto left = static_cast<uint32_t>(count);
    for (uint32_t level = 0; level <= kLevels && left > 0; ++level) {
        gpu::Commands commands(device);
        counters.clear(commands);
        const io::ExactLinesParams params{0, left, level, level == kLevels, static_cast<float>(tolerance)};
        commands.dispatch(
            kernel,
            {gpu::texel(scene.onDevice.cornerHigh, kFloats), gpu::texel(scene.onDevice.cornerLow, kFloats),
             gpu::texel(scene.onDevice.faceNormal, kFloats), gpu::texel(scene.onDevice.faceCentre, kFloats),
             gpu::texel(scene.onDevice.faceRange, VK_FORMAT_R32G32B32A32_UINT), records, lists, results,
             again[level % 2], again[(level + 1) % 2], counters.buffer()},
            params, gpu::groupsFor(left, io::kExactGroup));
        counters.submitAndRead(std::move(commands));
        left = counters[io::kExactCellCount];
    }
    const auto sums = results.download<uint32_t>(4 * count);
    const auto ends = records.download<io::ExactRecord>(count);
    std::vector<reference::Estimate> values;
    for (size_t k = 0; k < count; ++k) {
        const double one = double{io::kExactOne}, fraction = sums[4 * k + 1] / double{io::kExactFraction};
        const double errorFraction = sums[4 * k + 3] / double{io::kExactFraction};
        const bool turned = ends[k].outer != scene.records[k].outer;
        EXPECT_EQ(ends[k].outer + ends[k].inner, scene.records[k].outer + scene.records[k].inner);
        const auto area = [&](uint32_t piece) { return double{scene.onDevice.area[piece]}; };
        const double back = turned ? area(ends[k].outer) / area(ends[k].inner) : 1;
        values.push_back(
            {back * (sums[4 * k] + fraction) / one, back * (sums[4 * k + 2] + errorFraction) / one});
    }
    return values;
}

// Behind one screen and behind three; at a tolerance above what half of the pairs exchange in the open, which
// one point meets, at one that four meet, and at one that takes all rounds. Ends of stretches that fall on a
// bit to within float32 may go to the next, and a pair on the limit to another round: of one pair in a
// hundred.
TEST(ExactLines, agrees_with_the_reference) {
    for (const uint32_t listed : {1u, 3u})
        for (const double tolerance : {8e-3, 1e-3, 1e-5}) {
            const Scene scene(7 * listed, listed);
            ASSERT_EQ(scene.blockers.size(), 3u);
            const std::vector<reference::Estimate> values = byKernel(scene, tolerance);
            size_t looked = 0, off = 0, partial = 0;
            double squares = 0;
            for (size_t k = 0; k < values.size(); k += tolerance < 1e-4 ? 3 : 1) {
                const reference::Estimate truth =
                    reference::formFactorAlongLines(scene.pair(scene.records[k]), tolerance, kLevels);
                ++looked;
                partial += truth.value > 0 && truth.error > 0;
                off += std::abs(values[k].value - truth.value) > 1e-5 * truth.value + 1e-8 ||
                       std::abs(values[k].error - truth.error) > 1e-3 * truth.error + 1e-7;
                squares += std::pow(values[k].value - truth.value, 2);
            }
            EXPECT_LE(off, looked / 100) << listed << " listed, " << tolerance;
            EXPECT_GT(partial, looked / 10);
            EXPECT_LT(std::sqrt(squares / static_cast<double>(looked)), 0.02 * tolerance);
        }
}

// What is claimed of an entry, the tolerance and the estimated error, holds against exact visible polygons
// from either piece in 97 pairs of a hundred behind three screens (in rooms, where most pairs are open or
// hidden, in more: entry_claims_test.cpp); the RMS of all pairs is within the tolerance alone.
TEST(ExactLines, keeps_its_error_against_visible_polygons) {
    const Scene scene(21, 3);
    constexpr double kTolerance = 2e-5;
    size_t pairs = 0, within = 0;
    double squares = 0;
    for (size_t k = 0; k < scene.records.size(); k += 7, ++pairs) {
        LinesPair pair = scene.pair(scene.records[k]);
        const double area = areaOf(pair.outer), back = area / areaOf(pair.inner);
        const double truth = exchangeOf(pair) / area;
        const reference::Estimate there = reference::formFactorAlongLines(pair, kTolerance, kLevels);
        std::swap(pair.outer, pair.inner);
        const reference::Estimate other = reference::formFactorAlongLines(pair, kTolerance, kLevels);
        within += std::abs(there.value - truth) <= there.error + kTolerance;
        within += std::abs(other.value / back - truth) <= other.error / back + kTolerance;
        squares += std::pow(there.value - truth, 2);
    }
    EXPECT_GE(within, 2 * pairs * 97 / 100);
    EXPECT_LT(std::sqrt(squares / static_cast<double>(pairs)), kTolerance);
}

// Where a pair may err by all that it exchanges in the open one point looks: what all pairs claim together is
// one to three times what they err by.
TEST(ExactLines, claims_what_one_point_misses) {
    const Scene scene(21, 3);
    double errors = 0, claims = 0, exchanges = 0;
    for (size_t k = 0; k < scene.records.size(); k += 7) {
        const LinesPair pair = scene.pair(scene.records[k]);
        const double truth = exchangeOf(pair) / areaOf(pair.outer);
        const reference::Estimate seen = reference::formFactorAlongLines(pair, 1, kLevels);
        errors += std::pow(seen.value - truth, 2);
        claims += std::pow(seen.error, 2);
        exchanges += truth * truth;
    }
    EXPECT_GT(claims, errors);
    EXPECT_LT(claims, 9 * errors);
    EXPECT_LT(errors, 0.25 * 0.25 * exchanges);
}

} // namespace
} // namespace heliodon::compute
