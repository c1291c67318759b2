#include "compute/roofline.h"

#include <algorithm>
#include <cmath>

#include "compute/gpu/buffer.h"
#include "compute/gpu/commands.h"
#include "compute/gpu/error.h"
#include "compute/gpu/kernel.h"
#include "compute/stopwatch.h"
#include "shaders/io/roofline.io.h"
#include "spirv/roofline_comp.h"

namespace heliodon::compute {

namespace {

constexpr uint32_t kInvocations = 1u << 16;

class Probe {
public:
    Probe(gpu::Device& device, bool reads, uint32_t rounds)
        : device_(&device),
          kernel_(device, roofline_comp, "roofline", gpu::Specialization{{"kReads", reads ? 1u : 0u}}),
          params_{rounds, kInvocations, 1, 1}, texels_(reads ? size_t{rounds} * kInvocations : 1),
          source_(device, texels_ * 16, "roofline source"),
          sums_(device, kInvocations * sizeof(float), "roofline sums", gpu::Place::host) {
        gpu::Commands commands(device);
        commands.fill(source_, kOneBits);
        device.submitAndWait(std::move(commands));
    }

    // The best of several runs. Throws when the device did not do the work.
    double bestSeconds() {
        double best = INFINITY;
        for (int k = 0; k < 5; ++k) {
            gpu::Commands commands(*device_);
            commands.dispatch(kernel_, {gpu::texel(source_, VK_FORMAT_R32G32B32A32_SFLOAT), sums_}, params_,
                              kInvocations / io::kRooflineGroup);
            const Stopwatch watch;
            device_->submitAndWait(std::move(commands));
            best = std::min(best, watch.seconds());
        }
        // Every sum of four is counted up by ones, here and in the source.
        const float expected = 4.0f * static_cast<float>(params_.rounds) *
                               static_cast<float>(texels_ > 1 ? 1 : io::kRooflineSums);
        const float* sums = sums_.mapped<float>();
        if (!std::all_of(sums, sums + kInvocations, [&](float s) { return s == expected; }))
            throw gpu::Error("roofline: the device counted wrongly");
        return best;
    }

private:
    static constexpr uint32_t kOneBits = 0x3f800000u; // 1.0f

    gpu::Device* device_;
    gpu::Kernel kernel_;
    io::RooflineParams params_;
    size_t texels_;
    gpu::Buffer source_, sums_;
};

} // namespace

double Roofline::seconds(double flops, double bytes) const {
    return std::max(flops / flopsPerSecond, bytes / bytesPerSecond);
}

Roofline measureRoofline(gpu::Device& device) {
    Roofline result;
    constexpr uint32_t kRounds = 1024;
    result.flopsPerSecond =
        2.0 * 4 * io::kRooflineSums * kRounds * kInvocations / Probe(device, false, kRounds).bestSeconds();
    constexpr uint32_t kMostReads = (256u << 20) / 16 / kInvocations;
    const uint32_t reads = std::min(kMostReads, device.limits().maxTexelBufferElements / kInvocations);
    if (reads == 0) throw gpu::Error("roofline: the device takes no texel buffer of 1 MiB");
    result.bytesPerSecond = 16.0 * reads * kInvocations / Probe(device, true, reads).bestSeconds();
    return result;
}

} // namespace heliodon::compute
