#include "compute/gpu/memory.h"

#include <map>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "compute/gpu/buffer.h"
#include "compute/gpu/error.h"
#include "compute/gpu/image.h"
#include "tests/gpu/test_device.h"

namespace heliodon::gpu {
namespace {

VkMemoryRequirements request(VkDeviceSize size, VkDeviceSize alignment) {
    return {size, alignment, ~0u};
}

TEST(Memory, many_small_requests_share_one_block) {
    Memory memory(test::device().physical(), test::device().handle());
    std::vector<Allocation> all;
    for (int i = 0; i < 1000; ++i) all.push_back(memory.allocate(request(1000, 256), Place::device, false));
    EXPECT_EQ(memory.blockCount(), 1u);
    for (const Allocation& a : all) memory.free(a);
    EXPECT_EQ(memory.bytesInUse(), 0u);
}

TEST(Memory, large_requests_get_a_block_of_their_own_and_give_it_back) {
    Memory memory(test::device().physical(), test::device().handle());
    const Allocation big = memory.allocate(request(Memory::kBlockSize, 64), Place::device, false);
    EXPECT_EQ(big.offset, 0u);
    memory.free(big);
    EXPECT_LE(memory.bytesReserved(), Memory::kBlockSize);
}

// New memory of a discrete device costs milliseconds.
TEST(Memory, devices_with_memory_of_their_own_keep_large_blocks_for_requests_of_like_size) {
    Memory memory(test::device().physical(), test::device().handle(), false);
    const VkDeviceSize size = Memory::kBlockSize * 3 / 2;
    const Allocation first = memory.allocate(request(size, 64), Place::device, false);
    EXPECT_EQ(first.mapped, nullptr);
    memory.free(first);
    EXPECT_EQ(memory.bytesReserved(), size);
    const Allocation again = memory.allocate(request(size * 9 / 10, 64), Place::device, false);
    EXPECT_EQ(again.memory, first.memory);
    const Allocation another = memory.allocate(request(size, 64), Place::device, false);
    EXPECT_NE(another.memory, first.memory);
    memory.free(again);
    memory.free(another);
    EXPECT_EQ(memory.bytesInUse(), 0u);
    const Allocation small = memory.allocate(request(size / 2 + 4096, 64), Place::device, false);
    EXPECT_NE(small.memory, first.memory); // would waste half of it
    memory.free(small);
    EXPECT_LE(memory.bytesReserved(), memory.mostKept());
    // Blocks that small requests share, too.
    std::vector<Allocation> shared;
    for (int k = 0; k < 5; ++k)
        shared.push_back(memory.allocate(request(Memory::kBlockSize / 2, 64), Place::device, false));
    const size_t blocks = memory.blockCount();
    for (const Allocation& a : shared) memory.free(a);
    EXPECT_EQ(memory.blockCount(), blocks);
    memory.free(memory.allocate(request(Memory::kBlockSize / 2, 64), Place::device, false));
    EXPECT_EQ(memory.blockCount(), blocks);
}

TEST(Memory, random_traffic_never_overlaps_and_merges_back_to_nothing) {
    Memory memory(test::device().physical(), test::device().handle());
    std::mt19937 random(7);
    std::vector<Allocation> live;
    for (int step = 0; step < 5000; ++step) {
        if (live.empty() || random() % 5 < 3) {
            const VkDeviceSize alignment = VkDeviceSize{1} << (random() % 9);
            const Allocation made =
                memory.allocate(request(1 + random() % 200000, alignment), Place::device, random() % 4 == 0);
            ASSERT_EQ(made.offset % alignment, 0u);
            for (const Allocation& other : live)
                ASSERT_TRUE(other.memory != made.memory || other.offset + other.size <= made.offset ||
                            made.offset + made.size <= other.offset);
            live.push_back(made);
        } else {
            std::swap(live[random() % live.size()], live.back());
            memory.free(live.back());
            live.pop_back();
        }
    }
    for (const Allocation& a : live) memory.free(a);
    EXPECT_EQ(memory.bytesInUse(), 0u);
    if (test::device().info().type != "discrete") { // which keep what they have
        EXPECT_LE(memory.blockCount(), 2u);         // one for buffers and one for images stay ready
    }
}

TEST(Buffer, larger_than_the_device_takes_is_refused_by_name) {
    Device& device = test::device();
    const VkDeviceSize most = device.memory().largestBuffer();
    if (most > SIZE_MAX / 2) return; // nothing is
    try {
        const Buffer buffer(device, most + 1, "ledger");
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.code, VK_ERROR_OUT_OF_DEVICE_MEMORY);
        EXPECT_NE(std::string(error.what()).find("ledger"), std::string::npos) << error.what();
    }
}

TEST(Image, larger_than_the_device_takes_is_refused_by_name) {
    Device& device = test::device();
    const uint32_t most = device.limits().maxImageDimension2D;
    for (const auto& [width, height] : {std::pair{most + 1, 1u}, {1u, most + 1}}) try {
            const Image image(device, {.width = width, .height = height, .usage = VK_IMAGE_USAGE_SAMPLED_BIT},
                              "poster");
            ADD_FAILURE() << width << " x " << height;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("poster"), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find(std::to_string(most)), std::string::npos);
        }
}

} // namespace
} // namespace heliodon::gpu
