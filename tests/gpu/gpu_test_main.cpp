#include <memory>

#include <gtest/gtest.h>

#include "tests/gpu/drivers.h"
#include "tests/gpu/test_device.h"

namespace heliodon::test {

namespace {

std::unique_ptr<gpu::Device> theDevice;

} // namespace

gpu::Device& device() {
    if (!theDevice) {
        gpu::DeviceOptions options;
        options.validation = true;
        options.onMessage = [](std::string_view message) { ADD_FAILURE() << message; };
        theDevice = std::make_unique<gpu::Device>(options);
    }
    return *theDevice;
}

} // namespace heliodon::test

int main(int argc, char** argv) {
    heliodon::test::keepDriversLoaded();
    testing::InitGoogleTest(&argc, argv);
    const int result = RUN_ALL_TESTS();
    heliodon::test::theDevice.reset();
    return result;
}
