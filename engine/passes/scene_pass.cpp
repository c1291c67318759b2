#include "engine/passes/scene_pass.h"

#include "compute/gpu/device.h"
#include "engine/passes/draw_mesh.h"
#include "shaders/io/scene.io.h"
#include "spirv/scene_frag.h"
#include "spirv/scene_vert.h"
#include "spirv/shadow_volume_vert.h"
#include "spirv/solid_frag.h"
#include "spirv/solid_vert.h"
#include "spirv/sun_frag.h"

namespace heliodon::passes {

namespace {

// Adding to half floats takes a software device longer than to whole ones.
constexpr VkFormat kColour = VK_FORMAT_R32G32B32A32_SFLOAT; // SceneTarget tells their sizes
constexpr VkFormat kDepth = VK_FORMAT_D32_SFLOAT_S8_UINT;

const gpu::VertexStream kCornerStream{
    sizeof(DrawCorner),
    {{0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(DrawCorner, position)},
     {1, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(DrawCorner, normal)},
     {2, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(DrawCorner, reflectance)},
     {5, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(DrawCorner, smoothNormal)}}};
const gpu::VertexStream kLightStream{12, {{3, 0, VK_FORMAT_R32G32B32_SFLOAT, 0}}};
const gpu::VertexStream kShareStream{4, {{4, 0, VK_FORMAT_R32_SFLOAT, 0}}};

gpu::GraphicsPipelineInfo surfaceInfo() {
    gpu::GraphicsPipelineInfo info;
    info.stages = {scene_vert, scene_frag};
    info.streams = {kCornerStream, kLightStream, kShareStream};
    info.colourFormats = {kColour};
    info.depthFormat = kDepth;
    info.cull = VK_CULL_MODE_BACK_BIT;
    info.depthTest = info.depthWrite = true;
    return info;
}

gpu::GraphicsPipeline ambientPipeline(gpu::Device& device, bool projector) {
    gpu::GraphicsPipelineInfo info = surfaceInfo();
    info.specialization = {{"kProjector", projector}};
    return {device, info, projector ? "surfaces for a projector" : "surfaces"};
}

gpu::GraphicsPipeline volumePipeline(gpu::Device& device, bool caps) {
    gpu::GraphicsPipelineInfo info;
    info.stages = {shadow_volume_vert};
    info.streams = {{16, {{0, 0, VK_FORMAT_R32G32B32A32_SFLOAT, 0}}}};
    info.colourFormats = {kColour};
    info.depthFormat = kDepth;
    info.depthTest = info.depthClamp = true;
    info.writeMask = 0;
    // A cap lies on the very surface that casts it: pushed behind it, the cap and the volume's far side
    // cancel and the surface stays lit by its own front.
    if (caps) {
        info.depthBiasConstant = -4;
        info.depthBiasSlope = -1;
    }
    VkStencilOpState front{VK_STENCIL_OP_KEEP,
                           VK_STENCIL_OP_KEEP,
                           VK_STENCIL_OP_DECREMENT_AND_WRAP,
                           VK_COMPARE_OP_ALWAYS,
                           0xFF,
                           0xFF,
                           0};
    VkStencilOpState back = front;
    back.depthFailOp = VK_STENCIL_OP_INCREMENT_AND_WRAP;
    info.stencilFront = front;
    info.stencilBack = back;
    return {device, info, caps ? "caps of shadow volumes" : "sides of shadow volumes"};
}

gpu::GraphicsPipeline sunPipeline(gpu::Device& device) {
    gpu::GraphicsPipelineInfo info = surfaceInfo();
    info.stages = {scene_vert, sun_frag};
    info.depthWrite = false;
    info.depthCompare = VK_COMPARE_OP_EQUAL;
    info.blend = gpu::Blend::add;
    info.writeMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT;
    info.stencilFront = {
        VK_STENCIL_OP_KEEP, VK_STENCIL_OP_KEEP, VK_STENCIL_OP_KEEP, VK_COMPARE_OP_EQUAL, 0xFF, 0, 0};
    info.specialization = {{"kSun", 1u}};
    return {device, info, "sun"};
}

gpu::GraphicsPipelineInfo solidInfo() {
    gpu::GraphicsPipelineInfo info = surfaceInfo();
    info.stages = {solid_vert, solid_frag};
    info.streams = {kCornerStream};
    info.streams[0].attributes.resize(2); // position and normal
    return info;
}

constexpr uint32_t kMark = 0xFF; // in the stencil: to be blended over

// Depth, and a mark where a see-through solid is nearest. What shadow volumes left in the stencil is of no
// use any more.
gpu::GraphicsPipeline frontPipeline(gpu::Device& device) {
    gpu::GraphicsPipelineInfo info = solidInfo();
    info.stages = {solid_vert};
    info.writeMask = 0;
    info.stencilFront = {VK_STENCIL_OP_KEEP,
                         VK_STENCIL_OP_REPLACE,
                         VK_STENCIL_OP_KEEP,
                         VK_COMPARE_OP_ALWAYS,
                         0xFF,
                         0xFF,
                         kMark};
    return {device, info, "fronts of see-through solids"};
}

// There, once: where two solids overlap neither they nor what is inside them shines through twice.
gpu::GraphicsPipeline seeThroughPipeline(gpu::Device& device) {
    gpu::GraphicsPipelineInfo info = solidInfo();
    info.depthWrite = false;
    info.depthCompare = VK_COMPARE_OP_EQUAL;
    info.blend = gpu::Blend::alpha;
    info.writeMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT;
    info.stencilFront = {
        VK_STENCIL_OP_KEEP, VK_STENCIL_OP_ZERO, VK_STENCIL_OP_KEEP, VK_COMPARE_OP_EQUAL, 0xFF, 0xFF, kMark};
    return {device, info, "see-through solids"};
}

void bindStreams(VkCommandBuffer commands, std::initializer_list<const gpu::Buffer*> buffers) {
    std::vector<VkBuffer> handles;
    for (const gpu::Buffer* buffer : buffers) handles.push_back(buffer->handle());
    const std::vector<VkDeviceSize> offsets(handles.size(), 0);
    vkCmdBindVertexBuffers(commands, 0, static_cast<uint32_t>(handles.size()), handles.data(),
                           offsets.data());
}

void begin(VkCommandBuffer commands, const SceneTarget& target, const PixelRect& drawn,
           glm::vec4 background) {
    VkRenderingAttachmentInfo colour{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    colour.imageView = target.colour.view();
    colour.imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    colour.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    colour.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    colour.clearValue.color = {{background.r, background.g, background.b, background.a}};
    VkRenderingAttachmentInfo depth{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    depth.imageView = target.depth.view();
    depth.imageLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    depth.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR; // depth 0: infinitely far; stencil 0: in no volume
    depth.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
    const auto& size = target.colour.info();
    info.renderArea = {{drawn.x, drawn.y},
                       {static_cast<uint32_t>(drawn.width), static_cast<uint32_t>(drawn.height)}};
    info.layerCount = 1;
    info.colorAttachmentCount = 1;
    info.pColorAttachments = &colour;
    info.pDepthAttachment = info.pStencilAttachment = &depth;
    vkCmdBeginRendering(commands, &info);
    const VkViewport viewport{0, 0, static_cast<float>(size.width), static_cast<float>(size.height), 0, 1};
    vkCmdSetViewport(commands, 0, 1, &viewport);
    vkCmdSetScissor(commands, 0, 1, &info.renderArea);
}

} // namespace

SceneTarget::SceneTarget(gpu::Device& device, int width, int height, const std::string& name)
    : colour(device,
             {static_cast<uint32_t>(width), static_cast<uint32_t>(height), 1, kColour,
              VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT},
             name + " scene"),
      depth(device,
            {static_cast<uint32_t>(width), static_cast<uint32_t>(height), 1, kDepth,
             VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT},
            name + " depth") {}

ScenePass::ScenePass(gpu::Device& device)
    : ambient_(ambientPipeline(device, false)), ambientProjector_(ambientPipeline(device, true)),
      volumeCaps_(volumePipeline(device, true)), volumeSides_(volumePipeline(device, false)),
      sun_(sunPipeline(device)), solid_(device, solidInfo(), "solids"), front_(frontPipeline(device)),
      seeThrough_(seeThroughPipeline(device)) {}

void ScenePass::record(gpu::Commands& commands, const SceneTarget& target, const SceneInputs& inputs) const {
    using gpu::Stage;
    const VkCommandBuffer buffer = commands.handle();
    // The display pass of the frame before has read the colours; its depth was written and tested.
    commands.transition(target.colour, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                        Stage::fragment, Stage::colour);
    commands.transition(target.depth, VK_IMAGE_LAYOUT_UNDEFINED,
                        VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, Stage::depth, Stage::depth);
    begin(buffer, target, inputs.view->drawn, inputs.background);
    io::SceneParams params{};
    params.clipFromWorld = inputs.view->clipFromWorld;
    params.eye = inputs.view->eye;
    params.shownReflectance = inputs.shownReflectance;
    if (inputs.sun) {
        params.towardsSun = inputs.sun->towardsSun;
        params.sunIlluminance = inputs.sun->kilolux;
    }
    const SurfaceStreams& surfaces = inputs.surfaces;
    (inputs.projector ? ambientProjector_ : ambient_).bind(buffer, {}, params);
    bindStreams(buffer, {surfaces.corners, surfaces.light, surfaces.share});
    vkCmdDraw(buffer, surfaces.count, 1, 0, 0);
    const auto draw = [&](const gpu::GraphicsPipeline& pipeline, const SolidDraw& solid) {
        const io::SolidParams solidParams{glm::mat4(inputs.view->clipFromWorld), solid.colour,
                                          glm::normalize(glm::vec3(0.35f, 1.0f, 0.6f)), solid.shading,
                                          solid.pushBack};
        pipeline.bind(buffer, {}, solidParams);
        bindStreams(buffer, {solid.corners});
        vkCmdDraw(buffer, solid.count, 1, 0, 0);
    };
    for (const SolidDraw& solid : inputs.solids)
        if (!solid.seeThrough && solid.count > 0) draw(solid_, solid);
    if (inputs.sun) {
        volumeCaps_.bind(buffer, {}, params);
        bindStreams(buffer, {inputs.sun->volumes});
        vkCmdDraw(buffer, inputs.sun->capCount, 1, 0, 0);
        volumeSides_.bind(buffer, {}, params);
        vkCmdDraw(buffer, inputs.sun->volumeCount - inputs.sun->capCount, 1, inputs.sun->capCount, 0);
        sun_.bind(buffer,
                  {*inputs.sun->panes, gpu::texel(*inputs.sun->paneEdges, VK_FORMAT_R32G32B32A32_SFLOAT)},
                  params);
        bindStreams(buffer, {surfaces.corners, surfaces.light, surfaces.share});
        vkCmdDraw(buffer, surfaces.count, 1, 0, 0);
    }
    for (const SolidDraw& solid : inputs.solids) {
        if (!solid.seeThrough || solid.count == 0) continue;
        draw(front_, solid);
        draw(seeThrough_, solid);
    }
    vkCmdEndRendering(buffer);
    commands.transition(target.colour, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                        VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, Stage::colour, Stage::fragment);
}

} // namespace heliodon::passes
