#include "engine/passes/scene_pass.h"

#include <map>

#include "compute/gpu/device.h"
#include "engine/passes/draw_mesh.h"
#include "engine/passes/scissor.h"
#include "shaders/io/scene.io.h"
#include "spirv/background_frag.h"
#include "spirv/display_vert.h"
#include "spirv/gain_frag.h"
#include "spirv/gain_vert.h"
#include "spirv/glow_frag.h"
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

constexpr VkColorComponentFlags kRgb =
    VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT;

// Of a DrawCorner, what the shaders read.
gpu::VertexStream cornerStream(std::initializer_list<uint32_t> locations) {
    const std::map<uint32_t, size_t> members{{0, offsetof(DrawCorner, position)},
                                             {1, offsetof(DrawCorner, normal)},
                                             {2, offsetof(DrawCorner, reflectance)},
                                             {5, offsetof(DrawCorner, smoothNormal)}};
    gpu::VertexStream stream{sizeof(DrawCorner), {}};
    for (const uint32_t location : locations)
        stream.attributes.push_back(
            {location, 0, VK_FORMAT_R32G32B32_SFLOAT, static_cast<uint32_t>(members.at(location))});
    return stream;
}
const gpu::VertexStream kLightStream{12, {{3, 0, VK_FORMAT_R32G32B32_SFLOAT, 0}}};

gpu::GraphicsPipelineInfo surfaceInfo() {
    gpu::GraphicsPipelineInfo info;
    info.stages = {scene_vert, scene_frag};
    info.streams = {cornerStream({0, 1, 2}), kLightStream};
    info.colourFormats = {kColour};
    info.depthFormat = kDepth;
    info.cull = VK_CULL_MODE_BACK_BIT;
    info.depthTest = info.depthWrite = true;
    return info;
}

gpu::GraphicsPipeline ambientPipeline(gpu::Device& device, bool keepGain) {
    gpu::GraphicsPipelineInfo info = surfaceInfo();
    if (keepGain) info.writeMask = kRgb;
    return {device, info, keepGain ? "surfaces for a projector" : "surfaces"};
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

// More light on surfaces that are drawn.
gpu::GraphicsPipelineInfo addingInfo() {
    gpu::GraphicsPipelineInfo info = surfaceInfo();
    info.depthWrite = false;
    info.depthCompare = VK_COMPARE_OP_EQUAL;
    info.blend = gpu::Blend::add;
    info.writeMask = kRgb;
    return info;
}

gpu::GraphicsPipeline glowPipeline(gpu::Device& device) {
    gpu::GraphicsPipelineInfo info = addingInfo();
    info.stages = {scene_vert, glow_frag};
    return {device, info, "glow"};
}

gpu::GraphicsPipeline sunPipeline(gpu::Device& device) {
    gpu::GraphicsPipelineInfo info = addingInfo();
    info.stages = {scene_vert, sun_frag};
    info.stencilFront = {
        VK_STENCIL_OP_KEEP, VK_STENCIL_OP_KEEP, VK_STENCIL_OP_KEEP, VK_COMPARE_OP_EQUAL, 0xFF, 0, 0};
    info.specialization = {{"kSun", 1u}};
    return {device, info, "sun"};
}

gpu::GraphicsPipelineInfo solidInfo() {
    gpu::GraphicsPipelineInfo info = surfaceInfo();
    info.stages = {solid_vert, solid_frag};
    info.streams = {cornerStream({0, 1})};
    return info;
}

gpu::GraphicsPipeline gainPipeline(gpu::Device& device) {
    gpu::GraphicsPipelineInfo info = surfaceInfo();
    info.stages = {gain_vert, gain_frag};
    info.streams = {cornerStream({0, 5})};
    return {device, info, "gain"};
}

// At depth 0, where nothing is. Software devices clear floats pixel by pixel, which takes longer than to draw
// what is left of the picture.
gpu::GraphicsPipeline backgroundPipeline(gpu::Device& device) {
    gpu::GraphicsPipelineInfo info;
    info.stages = {display_vert, background_frag};
    info.colourFormats = {kColour};
    info.depthFormat = kDepth;
    info.depthTest = true;
    info.depthCompare = VK_COMPARE_OP_EQUAL;
    return {device, info, "background"};
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
    info.writeMask = kRgb;
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

// What colours the picture begins with; `drawn`: none, each pixel is drawn.
enum class Before { kept, cleared, drawn };

void begin(gpu::Commands& recorded, const SceneTarget& target, Before before) {
    // The display pass of the frame before has read the colours; its depth was written and tested.
    recorded.transition(target.colour,
                        before == Before::kept ? VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL
                                               : VK_IMAGE_LAYOUT_UNDEFINED,
                        VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, gpu::Stage::fragment, gpu::Stage::colour);
    recorded.transition(target.depth, VK_IMAGE_LAYOUT_UNDEFINED,
                        VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, gpu::Stage::depth,
                        gpu::Stage::depth);
    const VkCommandBuffer commands = recorded.handle();
    VkRenderingAttachmentInfo colour{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    colour.imageView = target.colour.view();
    colour.imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    colour.loadOp = before == Before::kept      ? VK_ATTACHMENT_LOAD_OP_LOAD
                    : before == Before::cleared ? VK_ATTACHMENT_LOAD_OP_CLEAR // to zeros
                                                : VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    colour.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    VkRenderingAttachmentInfo depth{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    depth.imageView = target.depth.view();
    depth.imageLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    depth.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR; // depth 0: infinitely far; stencil 0: in no volume
    depth.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
    const auto& size = target.colour.info();
    info.renderArea.extent = {size.width, size.height};
    info.layerCount = 1;
    info.colorAttachmentCount = 1;
    info.pColorAttachments = &colour;
    info.pDepthAttachment = info.pStencilAttachment = &depth;
    vkCmdBeginRendering(commands, &info);
    const VkViewport viewport{0, 0, static_cast<float>(size.width), static_cast<float>(size.height), 0, 1};
    vkCmdSetViewport(commands, 0, 1, &viewport);
    vkCmdSetScissor(commands, 0, 1, &info.renderArea);
}

void drawTriangles(VkCommandBuffer commands, const SurfaceStreams& surfaces, const Triangles& triangles) {
    bindStreams(commands, {surfaces.corners, surfaces.light});
    vkCmdBindIndexBuffer(commands, triangles.corners->handle(), 0, VK_INDEX_TYPE_UINT32);
    vkCmdDrawIndexed(commands, triangles.count, 1, 0, 0, 0);
}

void end(gpu::Commands& recorded, const SceneTarget& target) {
    vkCmdEndRendering(recorded.handle());
    recorded.transition(target.colour, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                        VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, gpu::Stage::colour, gpu::Stage::fragment);
}

void draw(VkCommandBuffer commands, const gpu::GraphicsPipeline& pipeline, const SolidDraw& solid,
          const View& view) {
    if (solid.count == 0) return;
    pipeline.bind(commands, {},
                  io::SolidParams{glm::mat4(view.clipFromWorld), solid.colour,
                                  glm::normalize(glm::vec3(0.35f, 1.0f, 0.6f)), solid.shading,
                                  solid.pushBack});
    bindStreams(commands, {solid.corners});
    vkCmdDraw(commands, solid.count, 1, 0, 0);
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
    : ambient_(ambientPipeline(device, false)), ambientKeepingGain_(ambientPipeline(device, true)),
      volumeCaps_(volumePipeline(device, true)), volumeSides_(volumePipeline(device, false)),
      sun_(sunPipeline(device)), glow_(glowPipeline(device)), solid_(device, solidInfo(), "solids"),
      background_(backgroundPipeline(device)), front_(frontPipeline(device)),
      seeThrough_(seeThroughPipeline(device)), gain_(gainPipeline(device)) {}

void ScenePass::record(gpu::Commands& commands, const SceneTarget& target, const SceneInputs& inputs) const {
    const VkCommandBuffer buffer = commands.handle();
    begin(commands, target, inputs.keepGain ? Before::kept : Before::drawn);
    io::SceneParams params{};
    params.clipFromWorld = inputs.view->clipFromWorld;
    if (inputs.sun) {
        params.towardsSun = inputs.sun->towardsSun;
        params.sunIlluminance = inputs.sun->kilolux;
    }
    const SurfaceStreams& surfaces = inputs.surfaces;
    (inputs.keepGain ? ambientKeepingGain_ : ambient_).bind(buffer, {}, params);
    drawTriangles(buffer, surfaces, inputs.triangles);
    for (const SolidDraw& solid : inputs.solids)
        if (!solid.seeThrough) draw(buffer, solid_, solid, *inputs.view);
    if (!inputs.keepGain) {
        io::SolidParams behind{};
        behind.colour = inputs.background;
        background_.bind(buffer, {}, behind);
        vkCmdDraw(buffer, 3, 1, 0, 0);
    }
    if (inputs.glow) {
        glow_.bind(buffer, {*inputs.glow->grids}, params);
        bindStreams(buffer, {inputs.glow->surfaces.corners, inputs.glow->surfaces.light});
        vkCmdDraw(buffer, inputs.glow->count, 1, 0, 0);
    }
    if (inputs.sun) {
        volumeCaps_.bind(buffer, {}, params);
        bindStreams(buffer, {inputs.sun->volumes});
        for (const PixelRect& part : inputs.sunlit) {
            setScissor(buffer, part);
            vkCmdDraw(buffer, inputs.sun->capCount, 1, 0, 0);
        }
        volumeSides_.bind(buffer, {}, params);
        for (const PixelRect& part : inputs.sunlit) {
            setScissor(buffer, part);
            vkCmdDraw(buffer, inputs.sun->volumeCount - inputs.sun->capCount, 1, inputs.sun->capCount, 0);
        }
        setScissor(buffer, {0, 0, inputs.view->width, inputs.view->height});
        sun_.bind(buffer,
                  {*inputs.sun->panes, gpu::texel(*inputs.sun->paneEdges, VK_FORMAT_R32G32B32A32_SFLOAT)},
                  params);
        drawTriangles(buffer, surfaces, inputs.sun->triangles);
    }
    for (const SolidDraw& solid : inputs.solids) {
        if (!solid.seeThrough) continue;
        draw(buffer, front_, solid, *inputs.view);
        draw(buffer, seeThrough_, solid, *inputs.view);
    }
    end(commands, target);
}

void ScenePass::recordGain(gpu::Commands& commands, const SceneTarget& target,
                           const GainInputs& inputs) const {
    const VkCommandBuffer buffer = commands.handle();
    begin(commands, target, Before::cleared);
    io::GainParams params = inputs.params;
    params.clipFromWorld = inputs.view->clipFromWorld;
    gain_.bind(buffer, {inputs.blend->projectors, inputs.blend->triangles, inputs.blend->borders}, params);
    bindStreams(buffer, {inputs.corners});
    vkCmdDraw(buffer, inputs.count, 1, 0, 0);
    draw(buffer, solid_, inputs.solids, *inputs.view);
    end(commands, target);
}

} // namespace heliodon::passes
