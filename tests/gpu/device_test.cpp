#include "compute/gpu/device.h"

#include <algorithm>
#include <chrono>

#include <gtest/gtest.h>

#include "compute/gpu/buffer.h"
#include "compute/gpu/commands.h"
#include "compute/gpu/error.h"
#include "tests/gpu/test_device.h"

namespace heliodon::gpu {
namespace {

TEST(Device, at_least_one_device_fits_and_is_listed) {
    const std::vector<DeviceInfo> list = listDevices();
    EXPECT_TRUE(std::any_of(list.begin(), list.end(), [](const DeviceInfo& d) { return d.refused.empty(); }));
}

TEST(Device, an_unknown_name_is_refused_with_every_device_and_reason) {
    try {
        Device device(DeviceOptions{
            .select = "no such device", .validation = false, .onMessage = {}, .instanceExtensions = {}});
        FAIL() << "a device was made";
    } catch (const Error& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find("no such device"), std::string::npos);
        for (const DeviceInfo& info : listDevices()) EXPECT_NE(text.find(info.name), std::string::npos);
    }
}

TEST(Device, buffers_dropped_while_in_use_live_until_the_work_is_done) {
    Device& device = test::device();
    device.waitIdle();
    const VkDeviceSize before = device.memory().bytesInUse();
    Buffer target(device, 1 << 20, "target");
    Commands commands(device);
    {
        Buffer source(device, 1 << 20, "source");
        commands.fill(source, 42);
        commands.barrier(Stage::transfer, Stage::transfer);
        commands.copy(source, 0, target, 0, 1 << 20);
    } // dropped while being recorded
    const uint64_t ticket = device.submit(std::move(commands));
    device.wait(ticket);
    EXPECT_EQ(target.download<uint32_t>(1)[0], 42u);
    target = Buffer();
    device.waitIdle();
    EXPECT_EQ(device.memory().bytesInUse(), before);
}

TEST(Device, recordings_that_are_dropped_leak_nothing) {
    Device& device = test::device();
    for (int i = 0; i < 100; ++i) {
        Buffer buffer(device, 1 << 16, "dropped");
        Commands commands(device);
        commands.fill(buffer, 1);
    }
    device.waitIdle();
    EXPECT_LT(device.memory().bytesInUse(), VkDeviceSize{2} << 20);
}

TEST(Device, tickets_grow_and_finish_in_order) {
    Device& device = test::device();
    const uint64_t first = device.submit(Commands(device)), second = device.submit(Commands(device));
    EXPECT_LT(first, second);
    device.wait(second);
    EXPECT_TRUE(device.finished(first));
}

TEST(Device, its_clock_counts_submitted_work_and_nothing_else) {
    Device& device = test::device();
    device.startTiming();
    EXPECT_EQ(device.timedSeconds(), 0.0);
    Buffer target(device, 64 << 20, "target");
    const auto start = std::chrono::steady_clock::now();
    for (uint32_t k = 0; k < 3; ++k) {
        Commands commands(device);
        commands.fill(target, k);
        const Commands dropped(device); // its slot is free again
        device.submitAndWait(std::move(commands));
    }
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double seconds = device.timedSeconds();
    EXPECT_GT(seconds, 0.0);
    EXPECT_LE(seconds, 1.01 * wall); // two clocks
    device.startTiming();
    EXPECT_EQ(device.timedSeconds(), 0.0);
}

} // namespace
} // namespace heliodon::gpu
