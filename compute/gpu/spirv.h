// The little of a SPIR-V module that a host needs: bindings, push constants, specialization constants, group
// size. Read from the module, so that nothing is typed twice.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

namespace heliodon::gpu {

struct SpirvBinding {
    uint32_t binding = 0;
    VkDescriptorType type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    uint32_t count = 1;
    std::string name; // of the variable, or of its block where the variable has none
};

struct SpirvModule {
    VkShaderStageFlagBits stage = VK_SHADER_STAGE_COMPUTE_BIT;
    std::vector<SpirvBinding> bindings; // of set 0, ordered by number; other sets are refused
    uint32_t pushConstantBytes = 0;
    std::vector<uint32_t>
        pushConstantOffsets; // byte offset of each member of the push-constant block's first struct
    std::map<std::string, uint32_t> specializationIds; // constant_id by name
    std::array<uint32_t, 3> groupSize{1, 1, 1};
};

// Throws Error on what is not a SPIR-V module with one entry point.
SpirvModule reflectSpirv(std::span<const uint32_t> words);

} // namespace heliodon::gpu
