// For the main of every test that opens a Vulkan device.
#pragma once

namespace heliodon::test {

// Drivers keep allocations until they are unloaded, where a leak checker can no longer name them: keep them
// loaded.
void keepDriversLoaded();

} // namespace heliodon::test
