// Devices with memory of their own, which the host does not see: the same results, in bits, by copies.
#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "compute/daylight_transport.h"
#include "compute/form_factors.h"
#include "compute/gpu/device.h"
#include "compute/hierarchical.h"
#include "compute/matrix_sums.h"
#include "tests/compute/rooms.h"
#include "tests/compute/skies.h"
#include "tests/gpu/test_device.h"
#include "tests/sanitized.h"

namespace heliodon::compute {
namespace {

std::unique_ptr<gpu::Device> theDiscrete;

// While the layers are there: of programs that end they go before what is static.
class Release : public testing::Environment {
    void TearDown() override { theDiscrete.reset(); }
};
const testing::Environment* const kRelease = testing::AddGlobalTestEnvironment(new Release);

gpu::Device& discrete() {
    if (!theDiscrete) {
        gpu::DeviceOptions options;
        options.validation = true;
        options.onMessage = [](std::string_view message) { ADD_FAILURE() << message; };
        options.mapsOwnMemory = false;
        theDiscrete = std::make_unique<gpu::Device>(options);
    }
    return *theDiscrete;
}

TEST(DiscreteMemory, is_not_seen_by_the_host) {
    EXPECT_EQ(gpu::Buffer(discrete(), 64, "own").mapped(), nullptr);
    EXPECT_NE(gpu::Buffer(discrete(), 64, "shared", gpu::Place::host).mapped(), nullptr);
}

TEST(DiscreteMemory, every_kernel_gives_the_same_bits) {
    const geometry::PatchMesh mesh =
        geometry::readPatches(HELIODON_TEST_DATA "/compute/formfactor/room3_672.obj");
    const size_t n = mesh.patchCount();
    for (std::string_view kernel : formFactorKernels()) {
        FormFactorOptions options;
        options.kernel = kernel;
        const FormFactors here = computeFormFactors(test::device(), mesh, options),
                          there = computeFormFactors(discrete(), mesh, options);
        EXPECT_EQ(here.values.download<float>(n * n), there.values.download<float>(n * n)) << kernel;
        EXPECT_EQ(here.report.closureMax, there.report.closureMax) << kernel;
        // Summed in the order in which the device finished.
        EXPECT_NEAR(here.report.claimedRowError, there.report.claimedRowError,
                    1e-6 * here.report.claimedRowError)
            << kernel;
        const auto streamed = [&](gpu::Device& device) {
            std::vector<float> values(n * n);
            streamFormFactors(device, mesh, options, [&](const FormFactorTile& tile) {
                for (size_t i = 0; i < tile.rows; ++i)
                    std::copy_n(&tile.values[i * tile.columns], tile.columns,
                                &values[(tile.firstRow + i) * n + tile.firstColumn]);
            });
            return values;
        };
        EXPECT_EQ(streamed(test::device()), streamed(discrete())) << kernel;
    }
}

// Of a matrix in several tiles, whose patches are triangles, or one of nine corners, which is cut in two.
TEST(DiscreteMemory, tiles_are_put_together_with_the_same_bits) {
    test::BoxRoom box;
    box.cells = {16, 16, 16};
    geometry::PatchMesh whole = test::boxRoom(box), cut = whole;
    ASSERT_GT(whole.patchCount(), 2304u);
    std::vector<uint32_t> corners;
    for (int k = 0; k < 9; ++k) {
        corners.push_back(static_cast<uint32_t>(cut.vertices.size()));
        cut.vertices.push_back({12 + std::cos(0.698 * k), 0, std::sin(0.698 * k)});
    }
    cut.addPatch(corners, 0, cut.role[0], 0, 1);
    for (const geometry::PatchMesh* mesh : {&whole, &cut}) {
        if (test::kSanitized && mesh == &whole) continue;
        FormFactorOptions options;
        options.kernel = "exact";
        const size_t n = mesh->patchCount();
        EXPECT_EQ(computeFormFactors(test::device(), *mesh, options).values.download<float>(n * n),
                  computeFormFactors(discrete(), *mesh, options).values.download<float>(n * n));
    }
}

// Of more rows than a group takes columns at once, none of them a multiple of it.
TEST(DiscreteMemory, sums_of_a_matrix_are_those_of_the_host) {
    constexpr size_t kPatches = 777;
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<float> F(kPatches * kPatches);
    for (float& f : F) f = std::pow(unit(random), 20.0f);
    std::vector<double> area(kPatches);
    for (double& a : area) a = double{unit(random)};
    const auto sums = [&](gpu::Device& device) {
        return sumsOfMatrix(device, gpu::Buffer::from(device, F, "F"), area);
    };
    const MatrixSums here = sums(test::device()), there = sums(discrete());
    for (size_t i = 0; i < kPatches; ++i) EXPECT_NEAR(there.rows[i], here.rows[i], 1e-10 * here.rows[i]) << i;
    EXPECT_GT(here.reciprocitySquares, 1);
    EXPECT_NEAR(there.reciprocitySquares, here.reciprocitySquares, 1e-5 * here.reciprocitySquares);
}

TEST(DiscreteMemory, light_of_a_room_is_the_same) {
    test::BoxRoom box;
    box.cells = {6, 5, 7};
    box.isGlass = [](glm::dvec3 p) { return p.z < 1e-9 && p.y > 1; };
    const geometry::PatchMesh mesh = test::boxRoom(box);
    const std::vector<Sensor> sensors{{{2, 1, 3}, {0, 1, 0}}, {{1, 1, 1}, {0, 0, 1}}};
    for (const char* kernel : {"exact", "hierarchical"}) {
        TransportOptions options;
        options.formFactors.kernel = kernel;
        const auto light = [&](gpu::Device& device) {
            DaylightTransport transport(device, mesh, options);
            transport.setSensors(sensors);
            return transport.light(test::sunny());
        };
        const Moment here = light(test::device()), there = light(discrete());
        for (size_t s = 0; s < sensors.size(); ++s) {
            EXPECT_GT(photometric(here.sensors[s].total()), 10);
            EXPECT_EQ(photometric(here.sensors[s].total()), photometric(there.sensors[s].total())) << kernel;
        }
    }
}

} // namespace
} // namespace heliodon::compute
