#include "engine/passes/display_pass.h"

#include "compute/gpu/device.h"
#include "compute/gpu/error.h"
#include "engine/passes/scissor.h"
#include "spirv/display_frag.h"
#include "spirv/display_vert.h"

namespace heliodon::passes {

namespace {

// Blue first, as windows want it: showing is copying then.
VkFormat formatOf(DisplayTarget::Kind kind) {
    switch (kind) {
    case DisplayTarget::Kind::srgb8:
        return VK_FORMAT_B8G8R8A8_SRGB;
    case DisplayTarget::Kind::unorm8:
        return VK_FORMAT_B8G8R8A8_UNORM;
    default:
        return VK_FORMAT_R32G32B32A32_SFLOAT;
    }
}

} // namespace

DisplayTarget::DisplayTarget(gpu::Device& device, int width, int height, Kind kind_, const std::string& name)
    : kind(kind_), picture(device,
                           {static_cast<uint32_t>(width), static_cast<uint32_t>(height), 1, formatOf(kind),
                            VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                VK_IMAGE_USAGE_TRANSFER_DST_BIT},
                           name + " picture"),
      pixels(device,
             static_cast<size_t>(width) * static_cast<size_t>(height) * (kind == Kind::float32 ? 16 : 4),
             name + " pixels", gpu::Place::host) {
    gpu::Commands commands(device);
    commands.transition(picture, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                        gpu::Stage::transfer, gpu::Stage::transfer);
    const VkClearColorValue black{{0, 0, 0, 1}};
    const VkImageSubresourceRange whole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(commands.handle(), picture.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &black, 1,
                         &whole);
    commands.transition(picture, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                        gpu::Stage::transfer, gpu::Stage::transfer);
    device.submitAndWait(std::move(commands));
}

DisplayPass::DisplayPass(gpu::Device& device) : device_(&device) {
    VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    info.addressModeU = info.addressModeV = info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    gpu::check(vkCreateSampler(device.handle(), &info, nullptr, &sampler_), "vkCreateSampler");
}

DisplayPass::~DisplayPass() {
    device_->retire(
        [device = device_->handle(), sampler = sampler_] { vkDestroySampler(device, sampler, nullptr); });
}

const gpu::GraphicsPipeline& DisplayPass::pipeline(const Key& key) {
    const auto found = pipelines_.find(key);
    if (found != pipelines_.end()) return found->second;
    const auto& [format, tone, projector, supersample, gamma] = key;
    gpu::GraphicsPipelineInfo info;
    info.stages = {display_vert, display_frag};
    info.colourFormats = {format};
    info.specialization = {{"kTone", tone},
                           {"kProjector", projector},
                           {"kSupersample", static_cast<uint32_t>(supersample)},
                           {"kGamma", gamma}};
    return pipelines_.emplace(key, gpu::GraphicsPipeline(*device_, info, "display")).first->second;
}

void DisplayPass::record(gpu::Commands& commands, const gpu::Image& scene, const gpu::Buffer& warp,
                         const View& view, const DisplayTarget& target, uint32_t tone,
                         const io::DisplayParams& params, bool readBack) {
    using gpu::Stage;
    const gpu::GraphicsPipeline& draw = pipeline(
        {target.picture.info().format, tone, !view.warp.empty(), view.supersample, params.gamma > 0});
    const VkCommandBuffer buffer = commands.handle();
    if (view.parts.empty()) return;
    commands.transition(target.picture, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                        VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, Stage::transfer, Stage::colour);
    VkRenderingAttachmentInfo colour{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    colour.imageView = target.picture.view();
    colour.imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    colour.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD; // black beside the parts
    colour.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    const auto& size = target.picture.info();
    VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
    const VkExtent3D extent{static_cast<uint32_t>(view.shown.width), static_cast<uint32_t>(view.shown.height),
                            1};
    info.renderArea = {{view.shown.x, view.shown.y}, {extent.width, extent.height}};
    info.layerCount = 1;
    info.colorAttachmentCount = 1;
    info.pColorAttachments = &colour;
    vkCmdBeginRendering(buffer, &info);
    const VkViewport viewport{0, 0, static_cast<float>(size.width), static_cast<float>(size.height), 0, 1};
    vkCmdSetViewport(buffer, 0, 1, &viewport);
    draw.bind(buffer, {gpu::sampled(scene, sampler_), gpu::texel(warp, VK_FORMAT_R32G32B32A32_SFLOAT)},
              params);
    for (const PixelRect& part : view.parts) {
        setScissor(buffer, part);
        vkCmdDraw(buffer, 3, 1, 0, 0);
    }
    vkCmdEndRendering(buffer);
    commands.transition(target.picture, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                        VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, Stage::colour, Stage::transfer);
    if (!readBack) return;
    const size_t texelBytes = target.kind == DisplayTarget::Kind::float32 ? 16 : 4;
    VkBufferImageCopy copy{};
    copy.bufferOffset =
        texelBytes * (static_cast<size_t>(view.shown.y) * size.width + static_cast<size_t>(view.shown.x));
    copy.bufferRowLength = size.width;
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.imageOffset = {view.shown.x, view.shown.y, 0};
    copy.imageExtent = extent;
    vkCmdCopyImageToBuffer(buffer, target.picture.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                           target.pixels.handle(), 1, &copy);
}

} // namespace heliodon::passes
