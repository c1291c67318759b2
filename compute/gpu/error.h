// Errors of the Vulkan substrate: the failing call, the result by name.
#pragma once

#include <stdexcept>
#include <string>

#include <vulkan/vulkan.h>

namespace heliodon::gpu {

class Error : public std::runtime_error {
public:
    Error(VkResult result, const std::string& what) : std::runtime_error(what), code(result) {}
    explicit Error(const std::string& what) : Error(VK_ERROR_UNKNOWN, what) {}

    bool deviceLost() const { return code == VK_ERROR_DEVICE_LOST; }

    VkResult code;
};

// No device fits what was asked for.
class NoDevice : public Error {
public:
    explicit NoDevice(const std::string& what) : Error(VK_ERROR_INITIALIZATION_FAILED, what) {}
};

const char* resultName(VkResult result);
std::string explained(VkResult result); // the name, and what it means where users may meet it

// Throws Error "vkCreateBuffer: VK_ERROR_OUT_OF_DEVICE_MEMORY: ..." for anything below VK_SUCCESS.
inline void check(VkResult result, const char* call) {
    if (result < VK_SUCCESS) throw Error(result, std::string(call) + ": " + explained(result));
}

} // namespace heliodon::gpu
