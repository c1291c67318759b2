#include "compute/gpu/graphics_pipeline.h"

#include <algorithm>
#include <array>
#include <utility>

#include "compute/gpu/device.h"
#include "compute/gpu/error.h"

namespace heliodon::gpu {

namespace {

// The shader modules of one pipeline, alive while it is made.
struct ShaderModules {
    ShaderModules(VkDevice d, const std::vector<std::span<const uint32_t>>& stages) : device(d) {
        for (const auto& words : stages) {
            VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
            info.codeSize = words.size_bytes();
            info.pCode = words.data();
            handles.push_back(VK_NULL_HANDLE);
            check(vkCreateShaderModule(device, &info, nullptr, &handles.back()), "vkCreateShaderModule");
        }
    }
    ShaderModules(const ShaderModules&) = delete;
    ShaderModules& operator=(const ShaderModules&) = delete;
    ~ShaderModules() {
        for (VkShaderModule handle : handles) vkDestroyShaderModule(device, handle, nullptr);
    }

    VkDevice device;
    std::vector<VkShaderModule> handles;
};

Specialization namesOf(const SpirvModule& module, const Specialization& all) {
    Specialization mine;
    for (const auto& value : all)
        if (module.specializationIds.contains(value.first)) mine.push_back(value);
    return mine;
}

void refuseUnknownNames(const std::vector<SpirvModule>& modules, const Specialization& values) {
    for (const auto& value : values)
        if (std::none_of(modules.begin(), modules.end(),
                         [&](const SpirvModule& m) { return m.specializationIds.contains(value.first); }))
            throw Error("no stage has a specialization constant '" + value.first + "'");
}

VkPipelineColorBlendAttachmentState blendState(const GraphicsPipelineInfo& info) {
    VkPipelineColorBlendAttachmentState state{};
    state.colorWriteMask = info.writeMask;
    if (info.blend == Blend::none) return state;
    const bool add = info.blend == Blend::add;
    state.blendEnable = VK_TRUE;
    state.srcColorBlendFactor = add ? VK_BLEND_FACTOR_ONE : VK_BLEND_FACTOR_SRC_ALPHA;
    state.dstColorBlendFactor = add ? VK_BLEND_FACTOR_ONE : VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
    state.srcAlphaBlendFactor = add ? VK_BLEND_FACTOR_ONE : VK_BLEND_FACTOR_ZERO;
    state.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
    return state;
}

// Streams in the order of their bindings; `info` points into it.
struct VertexInput {
    explicit VertexInput(const std::vector<VertexStream>& streams) {
        for (uint32_t i = 0; i < streams.size(); ++i) {
            bindings.push_back({i, streams[i].stride, VK_VERTEX_INPUT_RATE_VERTEX});
            for (VkVertexInputAttributeDescription attribute : streams[i].attributes) {
                attribute.binding = i;
                attributes.push_back(attribute);
            }
        }
        info.vertexBindingDescriptionCount = static_cast<uint32_t>(bindings.size());
        info.pVertexBindingDescriptions = bindings.data();
        info.vertexAttributeDescriptionCount = static_cast<uint32_t>(attributes.size());
        info.pVertexAttributeDescriptions = attributes.data();
    }
    VertexInput(const VertexInput&) = delete;
    VertexInput& operator=(const VertexInput&) = delete;

    std::vector<VkVertexInputBindingDescription> bindings;
    std::vector<VkVertexInputAttributeDescription> attributes;
    VkPipelineVertexInputStateCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
};

VkPipelineRasterizationStateCreateInfo rasterState(const GraphicsPipelineInfo& info) {
    VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
    raster.depthClampEnable = info.depthClamp;
    raster.cullMode = info.cull;
    raster.frontFace = info.front;
    raster.depthBiasEnable = info.depthBiasConstant != 0 || info.depthBiasSlope != 0;
    raster.depthBiasConstantFactor = info.depthBiasConstant;
    raster.depthBiasSlopeFactor = info.depthBiasSlope;
    raster.lineWidth = 1;
    return raster;
}

VkPipelineDepthStencilStateCreateInfo depthStencilState(const GraphicsPipelineInfo& info) {
    VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
    depth.depthTestEnable = info.depthTest;
    depth.depthWriteEnable = info.depthWrite;
    depth.depthCompareOp = info.depthCompare;
    depth.stencilTestEnable = info.stencilFront.has_value();
    depth.front = info.stencilFront.value_or(VkStencilOpState{});
    depth.back = info.stencilBack.value_or(depth.front);
    return depth;
}

// Points into `info`.
VkPipelineRenderingCreateInfo targetFormats(const GraphicsPipelineInfo& info) {
    VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
    rendering.colorAttachmentCount = static_cast<uint32_t>(info.colourFormats.size());
    rendering.pColorAttachmentFormats = info.colourFormats.data();
    rendering.depthAttachmentFormat = info.depthFormat;
    const bool hasStencil =
        info.depthFormat == VK_FORMAT_D32_SFLOAT_S8_UINT || info.depthFormat == VK_FORMAT_D24_UNORM_S8_UINT;
    rendering.stencilAttachmentFormat = hasStencil ? info.depthFormat : VK_FORMAT_UNDEFINED;
    return rendering;
}

} // namespace

GraphicsPipeline::GraphicsPipeline(Device& device, const GraphicsPipelineInfo& info, const std::string& name)
    : device_(&device) {
    std::vector<SpirvModule> modules;
    for (const auto& words : info.stages) modules.push_back(reflectSpirv(words));
    refuseUnknownNames(modules, info.specialization);
    layout_ = PipelineLayout(device, modules, name);
    const ShaderModules shaders(device.handle(), info.stages);
    std::vector<SpecializationData> constants;
    constants.reserve(modules.size()); // stages point into them
    std::vector<VkPipelineShaderStageCreateInfo> stages;
    for (size_t i = 0; i < modules.size(); ++i) {
        constants.emplace_back(modules[i], namesOf(modules[i], info.specialization));
        VkPipelineShaderStageCreateInfo stage{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
        stage.stage = modules[i].stage;
        stage.module = shaders.handles[i];
        stage.pName = "main";
        stage.pSpecializationInfo = &constants[i].info;
        stages.push_back(stage);
    }

    const VertexInput input(info.streams);
    VkPipelineInputAssemblyStateCreateInfo assembly{
        VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
    viewport.viewportCount = viewport.scissorCount = 1;
    const VkPipelineRasterizationStateCreateInfo raster = rasterState(info);
    VkPipelineMultisampleStateCreateInfo multisample{
        VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    multisample.rasterizationSamples = info.samples;
    const VkPipelineDepthStencilStateCreateInfo depth = depthStencilState(info);
    const std::vector<VkPipelineColorBlendAttachmentState> attachments(info.colourFormats.size(),
                                                                       blendState(info));
    VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
    blend.attachmentCount = static_cast<uint32_t>(attachments.size());
    blend.pAttachments = attachments.data();
    const std::array dynamicStates{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
    dynamic.dynamicStateCount = static_cast<uint32_t>(dynamicStates.size());
    dynamic.pDynamicStates = dynamicStates.data();
    const VkPipelineRenderingCreateInfo targets = targetFormats(info);

    VkGraphicsPipelineCreateInfo create{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
    create.pNext = &targets;
    create.stageCount = static_cast<uint32_t>(stages.size());
    create.pStages = stages.data();
    create.pVertexInputState = &input.info;
    create.pInputAssemblyState = &assembly;
    create.pViewportState = &viewport;
    create.pRasterizationState = &raster;
    create.pMultisampleState = &multisample;
    create.pDepthStencilState = &depth;
    create.pColorBlendState = &blend;
    create.pDynamicState = &dynamic;
    create.layout = layout_.handle();
    check(vkCreateGraphicsPipelines(device.handle(), device.pipelineCache(), 1, &create, nullptr, &pipeline_),
          ("vkCreateGraphicsPipelines for " + name).c_str());
    device.setName(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<uint64_t>(pipeline_), name);
}

GraphicsPipeline& GraphicsPipeline::operator=(GraphicsPipeline&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(layout_, other.layout_);
    std::swap(pipeline_, other.pipeline_);
    return *this;
}

GraphicsPipeline::~GraphicsPipeline() {
    if (!pipeline_) return;
    device_->retire(
        [device = device_->handle(), pipeline = pipeline_] { vkDestroyPipeline(device, pipeline, nullptr); });
}

} // namespace heliodon::gpu
