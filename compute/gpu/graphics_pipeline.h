// A graphics pipeline for dynamic rendering whose resources and constants are read from its shaders: push
// descriptors in set 0, one push-constant block shared by the stages. Viewport and scissor are set when
// drawing.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

#include "compute/gpu/kernel.h"

namespace heliodon::gpu {

struct VertexStream { // one binding; attributes by location
    uint32_t stride = 0;
    std::vector<VkVertexInputAttributeDescription> attributes; // `binding` is filled in from the order
};

enum class Blend { none, add, alpha };

struct GraphicsPipelineInfo {
    std::vector<std::span<const uint32_t>> stages; // SPIR-V; vertex first, a fragment stage may be absent
    std::vector<VertexStream> streams;             // empty: the vertex shader works from gl_VertexIndex
    std::vector<VkFormat> colourFormats;
    VkFormat depthFormat = VK_FORMAT_UNDEFINED; // with stencil, it is the stencil's format too
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
    VkCullModeFlags cull = VK_CULL_MODE_NONE;
    VkFrontFace front = VK_FRONT_FACE_COUNTER_CLOCKWISE;
    bool depthTest = false, depthWrite = false, depthClamp = false;
    VkCompareOp depthCompare = VK_COMPARE_OP_GREATER; // depth is reversed
    float depthBiasConstant = 0, depthBiasSlope = 0;  // both zero: off
    std::optional<VkStencilOpState> stencilFront, stencilBack;
    VkColorComponentFlags writeMask = 0xF;
    Blend blend = Blend::none;
    Specialization specialization; // given to every stage that has the name; a name that none has is refused
};

// Move-only; goes to the device's retire queue when dropped, so it may be dropped while it is in use.
class GraphicsPipeline {
public:
    GraphicsPipeline() = default; // none: only to be assigned to
    // `name` is for debuggers. The driver may go on compiling at the first draw. Throws Error where Vulkan
    // refuses, and for a constant that no stage has.
    GraphicsPipeline(Device& device, const GraphicsPipelineInfo& info, const std::string& name);
    GraphicsPipeline(GraphicsPipeline&& other) noexcept { *this = std::move(other); }
    GraphicsPipeline& operator=(GraphicsPipeline&& other) noexcept;
    ~GraphicsPipeline();

    VkPipeline handle() const { return pipeline_; }
    const PipelineLayout& layout() const { return layout_; }

    // Binds the pipeline, its resources (in the order of the binding numbers) and its constants.
    template<class Params>
    void bind(VkCommandBuffer commands, std::initializer_list<Binding> resources,
              const Params& params) const {
        static_assert(std::is_trivially_copyable_v<Params> && sizeof(Params) <= 128);
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_);
        layout_.push(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, {resources.begin(), resources.size()},
                     &params, sizeof(Params));
    }

private:
    Device* device_ = nullptr;
    PipelineLayout layout_;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
};

} // namespace heliodon::gpu
