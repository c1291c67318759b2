#include "engine/present/operator_window.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <imgui.h>

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>

#include "compute/gpu/commands.h"
#include "compute/gpu/error.h"
#include "compute/gpu/image.h"
#include "engine/present/display_server.h"
#include "engine/present/operator_layout.h"
#include "engine/present/presenter_state.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace heliodon::present {

namespace {

// ImGui's colours are coded already: they are written as they are, into an image that counts as sRGB.
constexpr VkFormat kImageFormat = VK_FORMAT_B8G8R8A8_SRGB, kDrawnFormat = VK_FORMAT_B8G8R8A8_UNORM;

VkRenderPass makeRenderPass(gpu::Device& device) {
    VkAttachmentDescription attachment{};
    attachment.format = kDrawnFormat;
    attachment.samples = VK_SAMPLE_COUNT_1_BIT;
    attachment.loadOp = VK_ATTACHMENT_LOAD_OP_LOAD; // the pictures beneath
    attachment.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    attachment.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    attachment.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    attachment.initialLayout = attachment.finalLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    const VkAttachmentReference reference{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    VkSubpassDescription subpass{};
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.colorAttachmentCount = 1;
    subpass.pColorAttachments = &reference;
    VkRenderPassCreateInfo info{VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO};
    info.attachmentCount = 1;
    info.pAttachments = &attachment;
    info.subpassCount = 1;
    info.pSubpasses = &subpass;
    VkRenderPass pass = VK_NULL_HANDLE;
    gpu::check(vkCreateRenderPass(device.handle(), &info, nullptr, &pass), "vkCreateRenderPass");
    return pass;
}

VkDescriptorPool makePool(gpu::Device& device) {
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 8};
    VkDescriptorPoolCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    info.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
    info.maxSets = 8;
    info.poolSizeCount = 1;
    info.pPoolSizes = &size;
    VkDescriptorPool pool = VK_NULL_HANDLE;
    gpu::check(vkCreateDescriptorPool(device.handle(), &info, nullptr, &pool), "vkCreateDescriptorPool");
    return pool;
}

} // namespace

struct OperatorWindow::State {
    State(gpu::Device& d, Window& w);
    ~State() { release(); }
    void open();
    void release(); // of all that was made, however far that went
    void fit(uint32_t width, uint32_t height);
    void dropTarget();
    void place(gpu::Commands& commands, const PlacedPicture& placed) const;

    gpu::Device* device;
    Window* window;
    ImGuiContext* context;
    VkRenderPass pass = VK_NULL_HANDLE;
    VkDescriptorPool pool = VK_NULL_HANDLE;
    gpu::Image image;
    VkImageView drawn = VK_NULL_HANDLE;
    VkFramebuffer framebuffer = VK_NULL_HANDLE;
    uint64_t ticket = 0;
    LabelsKept labels;
    double cursorX = 0, cursorY = 0; // when it was drawn
    // A call failed within ImGui: it may still name a buffer that it has freed, and would free it again. What
    // it had goes with the device.
    bool torn = false;
};

OperatorWindow::State::State(gpu::Device& d, Window& w)
    : device(&d), window(&w), context(ImGui::CreateContext()) {
    try {
        open();
    } catch (...) {
        release();
        throw;
    }
}

void OperatorWindow::State::open() {
    gpu::Device& d = *device;
    pass = makeRenderPass(d);
    pool = makePool(d);
    ImGui::GetIO().IniFilename = nullptr; // nothing is written where the program is started
    styleOperatorWindow();
    ImGui_ImplGlfw_InitForVulkan(window->handle, true); // goes on to call the presenter's callbacks
    window->beforeClose = [] {
        if (!displayServerLost()) ImGui_ImplGlfw_Shutdown(); // frees pointers of the server
    };
    ImGui_ImplVulkan_InitInfo info{};
    info.Instance = d.instance();
    info.PhysicalDevice = d.physical();
    info.Device = d.handle();
    info.QueueFamily = d.queueFamily();
    info.Queue = d.queue();
    info.DescriptorPool = pool;
    info.MinImageCount = info.ImageCount = 2;
    info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
    // Through ImGui, which would go on with objects that are none. What it has made is on its own list.
    info.CheckVkResultFn = [](VkResult result) { gpu::check(result, "a call of ImGui"); };
    ImGui_ImplVulkan_Init(&info, pass);
#if IMGUI_VERSION_NUM < 19000 // Debian 12's; later ones bring their fonts themselves
    gpu::Commands commands(d);
    ImGui_ImplVulkan_CreateFontsTexture(commands.handle());
    d.submitAndWait(std::move(commands));
    ImGui_ImplVulkan_DestroyFontUploadObjects();
#endif
}

void OperatorWindow::State::release() {
    vkDeviceWaitIdle(device->handle());
    dropTarget();
    if (ImGui::GetIO().BackendRendererUserData && !torn) ImGui_ImplVulkan_Shutdown();
    if (window->beforeClose) std::exchange(window->beforeClose, {})();
    ImGuiIO& io = ImGui::GetIO(); // what could not be shut down is forgotten: Debian 13's insists on it
    io.BackendPlatformUserData = io.BackendRendererUserData = nullptr;
    ImGui::DestroyContext(context);
    vkDestroyDescriptorPool(device->handle(), pool, nullptr);
    vkDestroyRenderPass(device->handle(), pass, nullptr);
}

void OperatorWindow::State::dropTarget() {
    vkDestroyFramebuffer(device->handle(), framebuffer, nullptr);
    vkDestroyImageView(device->handle(), drawn, nullptr);
    framebuffer = VK_NULL_HANDLE, drawn = VK_NULL_HANDLE;
}

void OperatorWindow::State::fit(uint32_t width, uint32_t height) {
    if (image.valid() && image.info().width == width && image.info().height == height) return;
    device->waitIdle();
    dropTarget();
    image = gpu::Image(*device,
                       {width, height, 1, kImageFormat,
                        VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                            VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                        VK_SAMPLE_COUNT_1_BIT, VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT},
                       "operator's window");
    VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    view.image = image.handle();
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = kDrawnFormat;
    view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    gpu::check(vkCreateImageView(device->handle(), &view, nullptr, &drawn), "vkCreateImageView");
    VkFramebufferCreateInfo frame{VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO};
    frame.renderPass = pass;
    frame.attachmentCount = 1;
    frame.pAttachments = &drawn;
    frame.width = width, frame.height = height, frame.layers = 1;
    gpu::check(vkCreateFramebuffer(device->handle(), &frame, nullptr, &framebuffer), "vkCreateFramebuffer");
}

void OperatorWindow::State::place(gpu::Commands& commands, const PlacedPicture& placed) const {
    const auto across = [&](float x) {
        return std::clamp(static_cast<int>(std::lround(x)), 0, static_cast<int>(image.info().width));
    };
    const auto down = [&](float y) {
        return std::clamp(static_cast<int>(std::lround(y)), 0, static_cast<int>(image.info().height));
    };
    const auto& size = placed.picture->info();
    VkImageBlit region{};
    region.srcSubresource = region.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.srcOffsets[1] = {static_cast<int32_t>(size.width), static_cast<int32_t>(size.height), 1};
    region.dstOffsets[0] = {across(placed.left), down(placed.top), 0};
    region.dstOffsets[1] = {across(placed.right), down(placed.bottom), 1};
    if (region.dstOffsets[0].x >= region.dstOffsets[1].x || region.dstOffsets[0].y >= region.dstOffsets[1].y)
        return;
    vkCmdBlitImage(commands.handle(), placed.picture->handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                   image.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region, VK_FILTER_LINEAR);
}

OperatorWindow::OperatorWindow(gpu::Device& device, Presenter& presenter, size_t window)
    : state_(std::make_unique<State>(device, presenter.internals().windows[window])) {}
OperatorWindow::~OperatorWindow() = default;

bool OperatorWindow::takesKeys() const {
    return ImGui::GetIO().WantTextInput;
}

bool OperatorWindow::takesWheel() const {
    return ImGui::IsPopupOpen(static_cast<const char*>(nullptr), ImGuiPopupFlags_AnyPopup);
}

bool OperatorWindow::isBusy() const {
    if (!state_->window->handle) return false;
    double x = 0, y = 0;
    glfwGetCursorPos(state_->window->handle, &x, &y);
    checkDisplayServer();
    // Of a mouse elsewhere ImGui knows no place.
    const bool moved = glfwGetWindowAttrib(state_->window->handle, GLFW_HOVERED) &&
                       (std::abs(x - state_->cursorX) >= 1 || std::abs(y - state_->cursorY) >= 1);
    return moved || ImGui::IsAnyItemActive() || ImGui::GetIO().WantTextInput ||
           glfwGetMouseButton(state_->window->handle, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS;
}

const gpu::Image* OperatorWindow::draw(OperatorControls& controls, const OperatorStatus& status,
                                       OperatorActions& actions) {
    State& s = *state_;
    if (!s.window->handle || s.window->hidden()) return nullptr;
    const VkExtent2D size = s.window->pixels();
    if (size.width == 0 || size.height == 0) return nullptr;
    s.fit(size.width, size.height);
    glfwGetCursorPos(s.window->handle, &s.cursorX, &s.cursorY);
    ImGui_ImplVulkan_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    const std::vector<PlacedPicture> pictures = layOutOperatorWindow(controls, status, actions, s.labels);
    ImGui::Render();

    using gpu::Stage;
    s.device->wait(s.ticket); // its vertices are written anew
    gpu::Commands commands(*s.device);
    commands.transition(s.image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                        Stage::transfer, Stage::transfer);
    const auto linear = [](float c) { return std::pow((c + 0.055f) / 1.055f, 2.4f); };
    const VkClearColorValue ground{
        {linear(kOperatorGround[0]), linear(kOperatorGround[1]), linear(kOperatorGround[2]), 1}};
    const VkImageSubresourceRange whole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(commands.handle(), s.image.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &ground,
                         1, &whole);
    commands.barrier(Stage::transfer, Stage::transfer);
    for (const PlacedPicture& placed : pictures) s.place(commands, placed);
    commands.transition(s.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                        VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, Stage::transfer, Stage::colour);
    VkRenderPassBeginInfo begin{VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO};
    begin.renderPass = s.pass;
    begin.framebuffer = s.framebuffer;
    begin.renderArea.extent = {s.image.info().width, s.image.info().height};
    vkCmdBeginRenderPass(commands.handle(), &begin, VK_SUBPASS_CONTENTS_INLINE);
    s.torn = true;
    ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands.handle());
    s.torn = false;
    vkCmdEndRenderPass(commands.handle());
    commands.transition(s.image, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                        VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, Stage::colour, Stage::transfer);
    s.ticket = s.device->submit(std::move(commands));
    return &s.image;
}

} // namespace heliodon::present
