#include "compute/gpu/memory.h"

#include <map>
#include <random>
#include <vector>

#include <gtest/gtest.h>

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
    EXPECT_LE(memory.blockCount(), 2u); // one for buffers and one for images stay ready
}

} // namespace
} // namespace heliodon::gpu
