#include <dlfcn.h>

#include <memory>

#include <gtest/gtest.h>

#include "tests/gpu/test_device.h"

namespace heliodon::test {

namespace {

std::unique_ptr<gpu::Device> theDevice;

// Drivers keep allocations until they are unloaded, where a leak checker can no longer name them: keep them
// loaded.
void keepDriversLoaded() {
    for (const char* name :
         {"libvulkan_lvp.so", "libVkLayer_MESA_device_select.so", "libVkLayer_khronos_validation.so"})
        dlopen(name, RTLD_LAZY | RTLD_NODELETE);
}

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

// What the validation layer keeps for the life of the process is its own business. Read by the leak checker, where there is one.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libVkLayer_khronos_validation"; }

int main(int argc, char** argv) {
    heliodon::test::keepDriversLoaded();
    testing::InitGoogleTest(&argc, argv);
    const int result = RUN_ALL_TESTS();
    heliodon::test::theDevice.reset();
    return result;
}
