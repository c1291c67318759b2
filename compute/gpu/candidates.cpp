#include "compute/gpu/candidates.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <memory>
#include <string_view>

#include <fmt/format.h>

#include "compute/gpu/enumerate.h"
#include "compute/gpu/error.h"

namespace heliodon::gpu {

namespace {

constexpr uint32_t kLargestSubgroup = 64; // the smallest workgroup whose kernels count subgroups

constexpr const char* kNoDriver =
    "no Vulkan device: the loader finds no driver (mesa-vulkan-drivers has one that needs no hardware; "
    "VK_ICD_FILENAMES and VK_DRIVER_FILES, where they are set, must name files that are there)";

struct Required {
    const char* name;
    VkBool32& (*of)(Features&);
};
constexpr std::array<Required, 6> kRequired{{
    {"synchronization2", [](Features& f) -> VkBool32& { return f.v13.synchronization2; }},
    {"dynamicRendering", [](Features& f) -> VkBool32& { return f.v13.dynamicRendering; }},
    {"maintenance4", [](Features& f) -> VkBool32& { return f.v13.maintenance4; }},
    {"timelineSemaphore", [](Features& f) -> VkBool32& { return f.v12.timelineSemaphore; }},
    {"scalarBlockLayout", [](Features& f) -> VkBool32& { return f.v12.scalarBlockLayout; }},
    {"depthClamp", [](Features& f) -> VkBool32& { return f.base.features.depthClamp; }},
}};

// Targets of the picture passes that Vulkan does not promise: light adds up in floats, shadow volumes count
// in a stencil.
struct RequiredFormat {
    const char* name;
    VkFormat format;
    VkFormatFeatureFlags features; // tiled optimally
};
constexpr std::array<RequiredFormat, 2> kRequiredFormats{{
    {"R32G32B32A32_SFLOAT", VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BLEND_BIT},
    {"D32_SFLOAT_S8_UINT", VK_FORMAT_D32_SFLOAT_S8_UINT, VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT},
}};

const char* typeName(VkPhysicalDeviceType type) {
    switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
        return "discrete";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
        return "integrated";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
        return "virtual";
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
        return "software";
    default:
        return "other";
    }
}

DeviceInfo describe(VkPhysicalDevice physical, uint32_t index, bool swapchains) {
    VkPhysicalDeviceSubgroupProperties subgroup{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES};
    VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    driver.pNext = &subgroup;
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
    properties.pNext = &driver;
    vkGetPhysicalDeviceProperties2(physical, &properties);
    const VkPhysicalDeviceProperties& p = properties.properties;
    DeviceInfo info{index,
                    p.deviceName,
                    fmt::format("{} {}", driver.driverName, driver.driverInfo),
                    typeName(p.deviceType),
                    p.apiVersion,
                    ""};
    auto refuse = [&](const std::string& why) { info.refused += (info.refused.empty() ? "" : "; ") + why; };
    if (p.apiVersion < VK_API_VERSION_1_3) {
        refuse(fmt::format("Vulkan {}.{}, needs 1.3", VK_API_VERSION_MAJOR(p.apiVersion),
                           VK_API_VERSION_MINOR(p.apiVersion)));
        return info;
    }
    Features features;
    vkGetPhysicalDeviceFeatures2(physical, &features.base);
    for (const Required& required : kRequired)
        if (!required.of(features)) refuse(fmt::format("lacks the feature {}", required.name));
    for (const RequiredFormat& required : kRequiredFormats) {
        VkFormatProperties format{};
        vkGetPhysicalDeviceFormatProperties(physical, required.format, &format);
        if ((format.optimalTilingFeatures & required.features) != required.features)
            refuse(fmt::format("cannot draw to pictures of {}", required.name));
    }
    constexpr VkSubgroupFeatureFlags kTogether =
        VK_SUBGROUP_FEATURE_BASIC_BIT | VK_SUBGROUP_FEATURE_VOTE_BIT | VK_SUBGROUP_FEATURE_ARITHMETIC_BIT;
    if ((subgroup.supportedOperations & kTogether) != kTogether ||
        !(subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT))
        refuse("lacks votes and sums within subgroups");
    if (!chooseSubgroupSize(physical)) refuse("has no subgroups of one known size of 64 or less");
    if (swapchains && !hasExtension(physical, VK_KHR_SWAPCHAIN_EXTENSION_NAME))
        refuse("lacks VK_KHR_swapchain");
    if (!findQueueFamily(physical)) refuse("has no queue for both graphics and compute");
    return info;
}

std::vector<VkPhysicalDevice> physicalDevices(VkInstance instance) {
    return enumerate<VkPhysicalDevice>("vkEnumeratePhysicalDevices",
                                       [&](uint32_t* count, VkPhysicalDevice* devices) {
                                           return vkEnumeratePhysicalDevices(instance, count, devices);
                                       });
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

int preference(const DeviceInfo& info) {
    constexpr std::array<std::string_view, 4> kOrder{"discrete", "integrated", "virtual", "software"};
    return static_cast<int>(std::find(kOrder.begin(), kOrder.end(), info.type) - kOrder.begin());
}

} // namespace

void Features::require() {
    for (const Required& required : kRequired) required.of(*this) = VK_TRUE;
}

std::optional<SubgroupSize> chooseSubgroupSize(VkPhysicalDevice physical) {
    VkPhysicalDeviceSubgroupSizeControlProperties sizes{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_PROPERTIES};
    VkPhysicalDeviceSubgroupProperties subgroup{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES};
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
    subgroup.pNext = &sizes;
    properties.pNext = &subgroup;
    vkGetPhysicalDeviceProperties2(physical, &properties);
    // Asked for, a size also bounds the workgroup (VUID-VkPipelineShaderStageCreateInfo-pNext-02756): 128 on a CPU
    // with vectors of four.
    if (sizes.minSubgroupSize == sizes.maxSubgroupSize) {
        if (subgroup.subgroupSize > kLargestSubgroup) return std::nullopt;
        return SubgroupSize{subgroup.subgroupSize, false};
    }
    Features available;
    vkGetPhysicalDeviceFeatures2(physical, &available.base);
    if (!available.v13.subgroupSizeControl ||
        !(sizes.requiredSubgroupSizeStages & VK_SHADER_STAGE_COMPUTE_BIT) ||
        sizes.minSubgroupSize > kLargestSubgroup)
        return std::nullopt;
    return SubgroupSize{std::clamp(kLargestSubgroup, sizes.minSubgroupSize, subgroup.subgroupSize), true};
}

std::optional<uint32_t> findQueueFamily(VkPhysicalDevice physical) {
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
    constexpr VkQueueFlags kBoth = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    for (uint32_t i = 0; i < count; ++i)
        if ((families[i].queueFlags & kBoth) == kBoth) return i;
    return std::nullopt;
}

bool hasExtension(VkPhysicalDevice physical, const char* name) {
    uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, extensions.data());
    return std::any_of(extensions.begin(), extensions.end(),
                       [&](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

VkInstance makeInstance(const std::vector<const char*>& layers, const std::vector<const char*>& extensions,
                        const void* next) {
    VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
    application.pApplicationName = "heliodon";
    application.apiVersion = VK_API_VERSION_1_3;
    VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
    info.pNext = next;
    info.pApplicationInfo = &application;
    info.enabledLayerCount = static_cast<uint32_t>(layers.size());
    info.ppEnabledLayerNames = layers.data();
    info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    VkInstance instance = VK_NULL_HANDLE;
    const VkResult result = vkCreateInstance(&info, nullptr, &instance);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER) throw Error(result, kNoDriver);
    check(result, "vkCreateInstance");
    return instance;
}

std::vector<DeviceInfo> listDevices() {
    const std::unique_ptr<VkInstance_T, void (*)(VkInstance)> instance(
        makeInstance({}, {}, nullptr), [](VkInstance made) { vkDestroyInstance(made, nullptr); });
    std::vector<DeviceInfo> list;
    for (VkPhysicalDevice physical : physicalDevices(instance.get()))
        list.push_back(describe(physical, static_cast<uint32_t>(list.size()), false));
    return list;
}

bool isNamed(const DeviceInfo& info, const std::string& select) {
    if (select.empty()) return true;
    if (std::all_of(select.begin(), select.end(), [](unsigned char c) { return std::isdigit(c); }))
        return std::to_string(info.index) == select;
    return lower(info.name).find(lower(select)) != std::string::npos;
}

Candidate chooseDevice(VkInstance instance, const std::string& select, bool swapchains) {
    Candidate chosen;
    std::string refusals;
    int best = 100;
    const std::vector<VkPhysicalDevice> candidates = physicalDevices(instance);
    for (uint32_t i = 0; i < candidates.size(); ++i) {
        const DeviceInfo info = describe(candidates[i], i, swapchains);
        const bool wanted = isNamed(info, select);
        const std::string why = !wanted ? "not the one asked for" : info.refused;
        if (!why.empty()) {
            refusals += fmt::format("\n  {} {}: {}", info.index, info.name, why);
        } else if (preference(info) < best) {
            best = preference(info);
            chosen = {candidates[i], info};
        }
    }
    if (chosen.physical) return chosen;
    const std::string asked = select.empty() ? "" : fmt::format(" named '{}'", select);
    if (candidates.empty()) throw Error(VK_ERROR_INCOMPATIBLE_DRIVER, kNoDriver);
    throw NoDevice(fmt::format("no Vulkan device{} can be used:{}", asked, refusals));
}

} // namespace heliodon::gpu
