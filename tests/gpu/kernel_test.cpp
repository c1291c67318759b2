#include "compute/gpu/kernel.h"

#include <numeric>

#include <gtest/gtest.h>

#include "compute/gpu/buffer.h"
#include "compute/gpu/commands.h"
#include "compute/gpu/error.h"
#include "shaders/io/affine.io.h"
#include "shaders/io/long_loop.io.h"
#include "spirv/affine_comp.h"
#include "spirv/affine_negated_comp.h"
#include "spirv/long_loop_comp.h"
#include "tests/gpu/test_device.h"

namespace heliodon::gpu {
namespace {

std::vector<float> runAffine(const Kernel& kernel, const std::vector<float>& input,
                             Device& device = test::device()) {
    const Buffer x = Buffer::from(device, input, "x");
    const Buffer y(device, input.size() * sizeof(float), "y");
    Commands commands(device);
    const io::AffineParams params{static_cast<uint32_t>(input.size()), 2.0f, 1.0f};
    commands.dispatch(kernel, {texel(x, VK_FORMAT_R32_SFLOAT), y}, params,
                      groupsFor(input.size(), io::kAffineGroup));
    device.submitAndWait(std::move(commands));
    return y.download<float>(input.size());
}

TEST(Kernel, computes_for_one_odd_and_many_elements) {
    const Kernel kernel(test::device(), affine_comp, "affine");
    for (size_t n : {1u, 63u, 64u, 65u, 65536u}) { // the last one as many texels as every device has
        std::vector<float> input(n);
        std::iota(input.begin(), input.end(), 0.0f);
        const std::vector<float> output = runAffine(kernel, input);
        for (size_t i = 0; i < n; ++i) ASSERT_EQ(output[i], 2.0f * input[i] + 1.0f);
    }
}

// lavapipe ends an invocation's loops after 65,535 turns in sum.
TEST(Kernel, loops_that_a_device_cuts_short_do_not_go_unnoticed) {
    const Kernel kernel(test::device(), long_loop_comp, "long loop");
    struct Case {
        uint32_t loops, turns;
    };
    for (const auto& [loops, turns] :
         {Case{1, 1000}, Case{30, 1000}, Case{1, 70000}, Case{2, 40000}, Case{70, 1000}}) {
        const Buffer y(test::device(), io::kLongLoopGroup * 2 * sizeof(uint32_t), "y");
        Commands commands(test::device());
        commands.dispatch(kernel, {y}, io::LongLoopParams{loops, turns}, 1);
        test::device().submitAndWait(std::move(commands));
        const std::vector<uint32_t> found = y.download<uint32_t>(2 * io::kLongLoopGroup);
        for (uint32_t i = 0; i < io::kLongLoopGroup; ++i) {
            uint32_t number = i;
            for (uint32_t k = 0; k < loops * turns; ++k)
                number = (number ^ (number >> 15)) * 747796405u + 2891336453u;
            const bool cut = found[2 * i + 1] != 0;
            EXPECT_TRUE(cut || found[2 * i] == number) << loops << " loops of " << turns;
            EXPECT_FALSE(cut && loops * turns < 50000) << loops << " loops of " << turns;
        }
    }
}

TEST(Kernel, computes_the_same_without_push_descriptors) {
    DeviceOptions options;
    options.validation = true;
    options.onMessage = [](std::string_view message) { ADD_FAILURE() << message; };
    options.pushDescriptors = false;
    Device device(options);
    const Kernel kernel(device, affine_comp, "affine");
    for (float x : {1.0f, 2.0f, 3.0f}) EXPECT_EQ(runAffine(kernel, {x}, device)[0], 2.0f * x + 1.0f);
    // Several sets in one recording, each as it was bound.
    const Buffer a = Buffer::from(device, std::vector<float>{1.0f}, "a"),
                 b = Buffer::from(device, std::vector<float>{5.0f}, "b");
    const Buffer fromA(device, sizeof(float), "from a"), fromB(device, sizeof(float), "from b");
    Commands commands(device);
    const io::AffineParams params{1, 2.0f, 1.0f};
    commands.dispatch(kernel, {texel(a, VK_FORMAT_R32_SFLOAT), fromA}, params, 1);
    commands.dispatch(kernel, {texel(b, VK_FORMAT_R32_SFLOAT), fromB}, params, 1);
    device.submitAndWait(std::move(commands));
    EXPECT_EQ(fromA.download<float>(1)[0], 3.0f);
    EXPECT_EQ(fromB.download<float>(1)[0], 11.0f);
}

TEST(Kernel, empty_input_records_nothing) {
    const Kernel kernel(test::device(), affine_comp, "affine");
    EXPECT_TRUE(runAffine(kernel, {}).empty());
}

TEST(Kernel, specialization_is_set_by_name) {
    const Kernel kernel(test::device(), affine_comp, "affine", {{"kNegate", 1u}});
    EXPECT_EQ(runAffine(kernel, {3.0f})[0], -7.0f);
    EXPECT_THROW(Kernel(test::device(), affine_comp, "affine", {{"kNoSuchName", 1u}}), Error);
}

// Whether spirv-opt was there to set the constant or not.
TEST(Kernel, variants_do_as_their_specialization_says) {
    const Kernel kernel(test::device(), affine_negated_comp, "affine", {{"kNegate", 1u}});
    EXPECT_EQ(runAffine(kernel, {3.0f})[0], -7.0f);
    EXPECT_EQ(reflectSpirv(affine_negated_comp).bindings.size(), reflectSpirv(affine_comp).bindings.size());
}

TEST(Kernel, interface_is_read_from_the_module_and_equals_the_shared_header) {
    const SpirvModule module = reflectSpirv(affine_comp);
    EXPECT_EQ(module.groupSize[0], io::kAffineGroup);
    EXPECT_EQ(module.pushConstantBytes, sizeof(io::AffineParams));
    const std::vector<uint32_t> offsets{offsetof(io::AffineParams, count), offsetof(io::AffineParams, scale),
                                        offsetof(io::AffineParams, offset)};
    EXPECT_EQ(module.pushConstantOffsets, offsets);
    ASSERT_EQ(module.bindings.size(), 2u);
    EXPECT_EQ(module.bindings[0].type, VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER);
    EXPECT_EQ(module.bindings[1].type, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER);
}

TEST(Kernel, wrong_resources_are_refused_by_name) {
    const Kernel kernel(test::device(), affine_comp, "affine");
    const Buffer buffer(test::device(), 64, "b");
    Commands commands(test::device());
    EXPECT_THROW(commands.dispatch(kernel, {buffer}, io::AffineParams{}, 1), Error);
    EXPECT_THROW(commands.dispatch(kernel, {buffer, buffer}, io::AffineParams{}, 1),
                 Error); // texel without a format
    EXPECT_THROW(commands.dispatch(kernel, {texel(buffer, VK_FORMAT_R32_SFLOAT), buffer}, 1.0f, 1), Error);
}

TEST(Kernel, bindings_beyond_their_buffer_are_refused) {
    const Kernel kernel(test::device(), affine_comp, "affine");
    const Buffer in(test::device(), 64, "in"), out(test::device(), 64, "out");
    Commands commands(test::device());
    const io::AffineParams none{};
    EXPECT_NO_THROW(commands.dispatch(kernel, {texel(in, VK_FORMAT_R32_SFLOAT), part(out, 16, 48)}, none, 1));
    EXPECT_THROW(commands.dispatch(kernel, {texel(in, VK_FORMAT_R32_SFLOAT), part(out, 16, 64)}, none, 1),
                 Error);
    EXPECT_THROW(commands.dispatch(kernel, {texel(in, VK_FORMAT_R32_SFLOAT, 128), out}, none, 1), Error);
    if (test::device().limits().minStorageBufferOffsetAlignment > 4) {
        EXPECT_THROW(commands.dispatch(kernel, {texel(in, VK_FORMAT_R32_SFLOAT), part(out, 4, 4)}, none, 1),
                     Error);
    }
}

TEST(Kernel, what_a_device_does_not_allow_is_refused) {
    const SpirvModule module = reflectSpirv(affine_comp);
    VkPhysicalDeviceLimits limits = test::device().limits();
    EXPECT_NO_THROW(checkLimits(module, limits, "affine"));
    for (uint32_t VkPhysicalDeviceLimits::*limit :
         {&VkPhysicalDeviceLimits::maxPerStageDescriptorStorageBuffers,
          &VkPhysicalDeviceLimits::maxPerStageDescriptorSampledImages,
          &VkPhysicalDeviceLimits::maxPerStageResources, &VkPhysicalDeviceLimits::maxPushConstantsSize,
          &VkPhysicalDeviceLimits::maxComputeWorkGroupInvocations}) {
        VkPhysicalDeviceLimits less = limits;
        less.*limit = 0;
        try {
            checkLimits(module, less, "affine");
            ADD_FAILURE();
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("'affine'"), std::string::npos) << error.what();
        }
    }
    limits.maxComputeWorkGroupSize[0] = module.groupSize[0] - 1;
    EXPECT_THROW(checkLimits(module, limits, "affine"), Error);
}

TEST(KernelCache, hands_out_what_was_prepared_as_if_made_on_the_spot) {
    KernelCache cache(test::device());
    for (uint32_t negate : {0u, 1u}) cache.prepare(affine_comp, "affine", {{"kNegate", negate}});
    cache.prepare(affine_comp, "affine", {{"kNegate", 1u}}); // again: nothing happens
    const Kernel& kernel = cache.get(affine_comp, "affine", {{"kNegate", 1u}});
    EXPECT_EQ(runAffine(kernel, {3.0f})[0], -7.0f);
    EXPECT_EQ(&kernel, &cache.get(affine_comp, "affine", {{"kNegate", 1u}}));
    EXPECT_EQ(runAffine(cache.get(affine_comp, "affine"), {3.0f})[0], 7.0f); // not prepared
}

TEST(KernelCache, a_kernel_that_cannot_be_made_throws_where_it_is_asked_for) {
    KernelCache cache(test::device());
    cache.prepare(affine_comp, "affine", {{"kNoSuchName", 1u}});
    EXPECT_THROW(cache.get(affine_comp, "affine", {{"kNoSuchName", 1u}}), Error);
    EXPECT_THROW(cache.get(affine_comp, "affine", {{"kNoSuchName", 1u}}), Error);
}

TEST(KernelCache, may_go_before_what_it_began_is_asked_for) {
    for (int k = 0; k < 20; ++k) {
        KernelCache cache(test::device());
        for (uint32_t negate : {0u, 1u}) cache.prepare(affine_comp, "affine", {{"kNegate", negate}});
    }
}

TEST(Spirv, modules_with_two_entry_points_are_refused) {
    std::vector<uint32_t> twice(std::begin(affine_comp), std::end(affine_comp));
    for (size_t at = 5; at < twice.size(); at += twice[at] >> 16)
        if ((twice[at] & 0xffffu) == 15) { // OpEntryPoint
            const std::vector<uint32_t> entry(twice.begin() + std::ptrdiff_t(at),
                                              twice.begin() + std::ptrdiff_t(at + (twice[at] >> 16)));
            twice.insert(twice.begin() + std::ptrdiff_t(at), entry.begin(), entry.end());
            break;
        }
    EXPECT_NO_THROW(reflectSpirv(affine_comp));
    EXPECT_THROW(reflectSpirv(twice), Error);
}

TEST(Spirv, truncated_modules_never_crash) {
    const std::span<const uint32_t> whole(affine_comp);
    for (size_t length = 0; length < whole.size(); ++length) {
        const std::vector<uint32_t> cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
        try {
            (void)reflectSpirv(cut);
        } catch (const Error&) {
        }
    }
}

} // namespace
} // namespace heliodon::gpu
