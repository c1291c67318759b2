#include "compute/exact_point_factors.h"

#include <algorithm>

#include <glm/geometric.hpp>

#include "compute/exact_scene.h"
#include "compute/gpu/commands.h"
#include "compute/gpu/device.h"
#include "compute/gpu/kernel.h"
#include "shaders/io/exact_points.io.h"
#include "spirv/exact_points_comp.h"

namespace heliodon::compute {

namespace {

constexpr size_t kBatch = 1024; // points of one submission

} // namespace

struct ExactPointFactors::State {
    gpu::Device& device;
    ExactScene scene;
    const gpu::Kernel* kernel;
    uint64_t overflows = 0;

    // Pieces x points of one batch on the device, summed by patch into `rows`.
    void runBatch(std::span<const SurfacePoint> points, float* rows) {
        std::vector<io::ExactPoint> split;
        for (const SurfacePoint& point : points) {
            io::ExactPoint one{{}, {}, glm::vec3(glm::normalize(point.normal)), point.room};
            splitPosition(point.position - scene.centre, one.high, one.low);
            split.push_back(one);
        }
        const size_t pieces = scene.pieceCount;
        const gpu::Buffer input = gpu::Buffer::from(device, split, "exact points");
        const gpu::Buffer lost = gpu::Buffer::from(device, std::vector<uint32_t>{0}, "exact points lost");
        const gpu::Buffer factors(device, points.size() * pieces * sizeof(float), "exact point factors",
                                  gpu::Place::host);
        constexpr VkFormat kVec4 = VK_FORMAT_R32G32B32A32_SFLOAT;
        gpu::Commands commands(device);
        const io::ExactPointsParams params{scene.pieceCount, scene.blockerCount};
        commands.dispatch(*kernel,
                          {gpu::texel(scene.cornerHigh, kVec4), gpu::texel(scene.cornerLow, kVec4),
                           gpu::texel(scene.faceNormal, kVec4), gpu::texel(scene.faceCentre, kVec4),
                           gpu::texel(scene.faceRange, VK_FORMAT_R32G32B32A32_UINT), input, lost, factors},
                          params, gpu::groupsFor(pieces, io::kExactPointGroup),
                          static_cast<uint32_t>(points.size()));
        commands.barrier(gpu::Stage::compute, gpu::Stage::host);
        device.submitAndWait(std::move(commands));
        overflows += lost.download<uint32_t>(1)[0];
        const float* value = factors.mapped<float>();
        for (size_t p = 0; p < points.size(); ++p)
            for (size_t j = 0; j < pieces; ++j)
                rows[p * scene.patchCount + scene.patchOfPiece[j]] += value[p * pieces + j];
    }
};

ExactPointFactors::ExactPointFactors(gpu::Device& device, const geometry::PatchMesh& mesh)
    : state_(new State{device, exactScene(device, mesh, UINT32_MAX),
                       &device.kernels().get(device, exact_points_comp, "exact_points")}) {}

ExactPointFactors::~ExactPointFactors() = default;
ExactPointFactors::ExactPointFactors(ExactPointFactors&&) noexcept = default;

std::vector<float> ExactPointFactors::run(std::span<const SurfacePoint> points) {
    State& s = *state_;
    s.overflows = 0;
    const size_t n = s.scene.patchCount;
    std::vector<float> rows(points.size() * n, 0.0f);
    if (rows.empty()) return rows;
    const size_t most = s.device.limits().maxStorageBufferRange / (sizeof(float) * s.scene.pieceCount);
    const size_t batch = std::clamp<size_t>(most, 1, kBatch);
    for (size_t first = 0; first < points.size(); first += batch)
        s.runBatch(points.subspan(first, std::min(batch, points.size() - first)), rows.data() + first * n);
    return rows;
}

uint64_t ExactPointFactors::overflows() const {
    return state_->overflows;
}

} // namespace heliodon::compute
