// Which Vulkan devices there are, and which of them can be used. Internal to compute/gpu.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

#include "compute/gpu/device.h"

namespace heliodon::gpu {

// Every feature that the program uses, in one chain, so that what is asked of a candidate is what is enabled
// on the chosen one.
struct Features {
    VkPhysicalDeviceVulkan13Features v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceVulkan12Features v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceFeatures2 base{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};

    Features() {
        v12.pNext = &v13;
        base.pNext = &v12;
    }
    void require(); // asks for each

    Features(const Features&) = delete;
    Features& operator=(const Features&) = delete;
};

// `next`: of VkInstanceCreateInfo. Throws Error, where there is no driver with what can be done about it.
VkInstance makeInstance(const std::vector<const char*>& layers, const std::vector<const char*>& extensions,
                        const void* next);

struct SubgroupSize {
    uint32_t size;
    bool isAsked; // of each pipeline; false: the device has but one
};
// The device's own, or 64 where that is more. Kernels count their subgroups by it: none where a kernel might
// get another one.
std::optional<SubgroupSize> chooseSubgroupSize(VkPhysicalDevice physical);

// One for both graphics and compute.
std::optional<uint32_t> findQueueFamily(VkPhysicalDevice physical);
bool hasExtension(VkPhysicalDevice physical, const char* name);

struct Candidate {
    VkPhysicalDevice physical = VK_NULL_HANDLE;
    DeviceInfo info;
};

// Whether `select`, as in DeviceOptions, names this device, usable or not.
bool isNamed(const DeviceInfo& info, const std::string& select);

// `select` is as in DeviceOptions; the best of those that fit: discrete, integrated, virtual, software.
// Throws NoDevice that lists every device with why it was refused.
Candidate chooseDevice(VkInstance instance, const std::string& select, bool swapchains);

} // namespace heliodon::gpu
