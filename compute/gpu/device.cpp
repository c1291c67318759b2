#include "compute/gpu/device.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "compute/gpu/candidates.h"
#include "compute/gpu/commands.h"
#include "compute/gpu/error.h"
#include "compute/gpu/kernel.h"

namespace heliodon::gpu {

namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL forwardMessage(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                              VkDebugUtilsMessageTypeFlagsEXT,
                                              const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    const auto& listener = *static_cast<const std::function<void(std::string_view)>*>(user);
    if (listener) listener(data->pMessage);
    return VK_FALSE;
}

} // namespace

Device::Device(const DeviceOptions& options)
    : onMessage_(options.onMessage), beforeSubmit_(options.beforeSubmit) {
    try {
        createInstance(options);
        choosePhysical(options);
        createDevice(options);
        createOwnObjects(options);
    } catch (...) {
        destroy();
        throw;
    }
}

void Device::createOwnObjects(const DeviceOptions& options) {
    memory_ = std::make_unique<Memory>(physical_, device_, options.mapsOwnMemory);
    kernels_ = std::make_unique<KernelCache>(*this);
    const VkPipelineCacheCreateInfo cache{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
    check(vkCreatePipelineCache(device_, &cache, nullptr, &pipelineCache_), "vkCreatePipelineCache");
    VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
    pool.queueFamilyIndex = queueFamily_;
    check(vkCreateCommandPool(device_, &pool, nullptr, &pool_), "vkCreateCommandPool");
    VkSemaphoreTypeCreateInfo type{VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO};
    type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
    VkSemaphoreCreateInfo semaphore{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    semaphore.pNext = &type;
    check(vkCreateSemaphore(device_, &semaphore, nullptr, &timeline_), "vkCreateSemaphore");
}

void Device::createInstance(const DeviceOptions& options) {
    std::vector<const char*> layers, extensions;
    for (const std::string& name : options.instanceExtensions) extensions.push_back(name.c_str());
    const VkValidationFeatureEnableEXT enable = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
    features.enabledValidationFeatureCount = 1;
    features.pEnabledValidationFeatures = &enable;
    VkDebugUtilsMessengerCreateInfoEXT messenger{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
    messenger.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    messenger.messageType =
        VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
    messenger.pfnUserCallback = forwardMessage;
    messenger.pUserData = &onMessage_;
    if (options.validation) {
        layers.push_back(kValidationLayer);
        extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
        extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME); // the layer's own
        features.pNext = &messenger;
    }
    instance_ = makeInstance(layers, extensions, options.validation ? &features : nullptr);
    if (!options.validation) return;
    const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
    check(create(instance_, &messenger, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT");
    functions_.setDebugUtilsObjectName = reinterpret_cast<PFN_vkSetDebugUtilsObjectNameEXT>(
        vkGetInstanceProcAddr(instance_, "vkSetDebugUtilsObjectNameEXT"));
}

void Device::choosePhysical(const DeviceOptions& options) {
    Candidate chosen = chooseDevice(instance_, options.select, options.swapchains);
    physical_ = chosen.physical;
    info_ = std::move(chosen.info);
}

void Device::createDevice(const DeviceOptions& options) {
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(physical_, &properties);
    limits_ = properties.limits;
    const SubgroupSize subgroup = *chooseSubgroupSize(physical_);
    subgroupSize_ = subgroup.size;
    fixesSubgroupSize_ = subgroup.isAsked;
    queueFamily_ = *findQueueFamily(physical_);

    Features available, wanted;
    vkGetPhysicalDeviceFeatures2(physical_, &available.base);
    wanted.require();
    wanted.base.features.fragmentStoresAndAtomics = available.base.features.fragmentStoresAndAtomics;
    wanted.v13.subgroupSizeControl = available.v13.subgroupSizeControl;
    wanted.v13.computeFullSubgroups = available.v13.computeFullSubgroups;
    fillsSubgroups_ = available.v13.computeFullSubgroups;

    std::vector<const char*> extensions;
    const bool pushes =
        hasExtension(physical_, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME) && options.pushDescriptors;
    if (pushes) extensions.push_back(VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME);
    if (options.swapchains) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
    const float priority = 1;
    VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    queue.queueFamilyIndex = queueFamily_;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
    info.pNext = &wanted.base;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    check(vkCreateDevice(physical_, &info, nullptr, &device_), "vkCreateDevice");
    vkGetDeviceQueue(device_, queueFamily_, 0, &queue_);
    if (pushes)
        functions_.cmdPushDescriptorSet = reinterpret_cast<PFN_vkCmdPushDescriptorSetKHR>(
            vkGetDeviceProcAddr(device_, "vkCmdPushDescriptorSetKHR"));
}

Device::~Device() {
    destroy();
}

// Of all that was made, however far that went.
void Device::destroy() {
    if (device_) {
        vkDeviceWaitIdle(device_); // a lost device returns at once; what is left is freed all the same
        kernels_.reset();
        for (Retired& retired : retired_) retired.release();
        retired_.clear();
        vkDestroyQueryPool(device_, timing_, nullptr);
        vkDestroySemaphore(device_, timeline_, nullptr);
        vkDestroyCommandPool(device_, pool_, nullptr);
        vkDestroyPipelineCache(device_, pipelineCache_, nullptr);
        memory_.reset();
        vkDestroyDevice(device_, nullptr);
    }
    if (messenger_) {
        const auto destroy = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
        destroy(instance_, messenger_, nullptr);
    }
    if (instance_) vkDestroyInstance(instance_, nullptr);
}

VkCommandBuffer Device::beginCommandBuffer() {
    collectRetired();
    VkCommandBuffer buffer = VK_NULL_HANDLE;
    if (!freeCommandBuffers_.empty()) {
        buffer = freeCommandBuffers_.back();
        freeCommandBuffers_.pop_back();
    } else {
        VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
        info.commandPool = pool_;
        info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
        info.commandBufferCount = 1;
        check(vkAllocateCommandBuffers(device_, &info, &buffer), "vkAllocateCommandBuffers");
    }
    VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    check(vkBeginCommandBuffer(buffer, &begin), "vkBeginCommandBuffer");
    ++openRecordings_;
    if (timing_) beginTimed(buffer);
    return buffer;
}

void Device::abandonCommandBuffer(VkCommandBuffer buffer) {
    closeRecording();
    for (Timed& slot : timed_)
        if (slot.buffer == buffer) slot = {};
    vkResetCommandBuffer(buffer, 0);
    freeCommandBuffers_.push_back(buffer);
}

void Device::startTiming() {
    timedSeconds_ = 0;
    if (timing_) return;
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical_, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical_, &count, families.data());
    const uint32_t bits = families[queueFamily_].timestampValidBits;
    if (bits == 0) return;
    tickMask_ = bits < 64 ? (uint64_t{1} << bits) - 1 : UINT64_MAX;
    VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    info.queryType = VK_QUERY_TYPE_TIMESTAMP;
    info.queryCount = 2 * kTimedSlots;
    check(vkCreateQueryPool(device_, &info, nullptr, &timing_), "vkCreateQueryPool");
    timed_.resize(kTimedSlots);
}

double Device::timedSeconds() {
    waitIdle();
    return timedSeconds_;
}

void Device::beginTimed(VkCommandBuffer buffer) {
    const auto slot = std::find_if(timed_.begin(), timed_.end(), [](const Timed& t) { return !t.busy; });
    if (slot == timed_.end()) return;
    *slot = {buffer, true};
    const auto query = static_cast<uint32_t>(2 * (slot - timed_.begin()));
    vkCmdResetQueryPool(buffer, timing_, query, 2);
    vkCmdWriteTimestamp2(buffer, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, timing_, query);
}

void Device::endTimed(VkCommandBuffer buffer) {
    const auto slot =
        std::find_if(timed_.begin(), timed_.end(), [buffer](const Timed& t) { return t.buffer == buffer; });
    if (slot == timed_.end()) return;
    slot->buffer = VK_NULL_HANDLE;
    const auto index = static_cast<uint32_t>(slot - timed_.begin());
    vkCmdWriteTimestamp2(buffer, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, timing_, 2 * index + 1);
    retire([this, index] { readTimed(index); });
}

void Device::readTimed(uint32_t slot) {
    std::array<uint64_t, 2> ticks{};
    if (vkGetQueryPoolResults(device_, timing_, 2 * slot, 2, sizeof ticks, ticks.data(), sizeof(uint64_t),
                              VK_QUERY_RESULT_64_BIT) == VK_SUCCESS)
        timedSeconds_ +=
            1e-9 * limits_.timestampPeriod * static_cast<double>((ticks[1] - ticks[0]) & tickMask_);
    timed_[slot].busy = false;
}

uint64_t Device::submit(Commands&& commands, VkSemaphore written) {
    if (beforeSubmit_) beforeSubmit_();
    const VkCommandBuffer buffer = commands.buffer_;
    if (timing_) endTimed(buffer);
    commands.close();
    VkCommandBufferSubmitInfo command{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
    command.commandBuffer = buffer;
    std::array<VkSemaphoreSubmitInfo, 2> signals{};
    for (auto& s : signals) s = {VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO};
    signals[0].semaphore = timeline_;
    signals[0].value = lastTicket_ + 1;
    signals[0].stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    signals[1].semaphore = written;
    signals[1].stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    VkSubmitInfo2 info{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
    info.commandBufferInfoCount = 1;
    info.pCommandBufferInfos = &command;
    info.signalSemaphoreInfoCount = written ? 2 : 1;
    info.pSignalSemaphoreInfos = signals.data();
    check(vkQueueSubmit2(queue_, 1, &info, VK_NULL_HANDLE), "vkQueueSubmit2");
    commands.buffer_ = VK_NULL_HANDLE;
    ++lastTicket_;
    closeRecording();
    retired_.push_back({lastTicket_, [this, buffer] {
                            vkResetCommandBuffer(buffer, 0);
                            freeCommandBuffers_.push_back(buffer);
                        }});
    return lastTicket_;
}

void Device::wait(uint64_t ticket) {
    VkSemaphoreWaitInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO};
    info.semaphoreCount = 1;
    info.pSemaphores = &timeline_;
    info.pValues = &ticket;
    check(vkWaitSemaphores(device_, &info, UINT64_MAX), "vkWaitSemaphores");
    collectRetired();
}

bool Device::finished(uint64_t ticket) {
    uint64_t value = 0;
    check(vkGetSemaphoreCounterValue(device_, timeline_, &value), "vkGetSemaphoreCounterValue");
    return value >= ticket;
}

void Device::submitAndWait(Commands&& commands) {
    wait(submit(std::move(commands)));
}

void Device::waitIdle() {
    wait(lastTicket_);
}

void Device::retire(std::function<void()> release) {
    // A recording that is still open may name the object: its ticket is known when the last of them has
    // closed.
    retired_.push_back({openRecordings_ > 0 ? kPending : lastTicket_, std::move(release)});
}

void Device::closeRecording() {
    if (--openRecordings_ > 0) return;
    for (Retired& retired : retired_)
        if (retired.ticket == kPending) retired.ticket = lastTicket_;
}

void Device::collectRetired() {
    uint64_t value = 0;
    if (vkGetSemaphoreCounterValue(device_, timeline_, &value) != VK_SUCCESS) return;
    std::vector<Retired> keep, all;
    all.swap(retired_); // a release may retire something itself
    for (Retired& retired : all) {
        if (retired.ticket <= value)
            retired.release();
        else
            keep.push_back(std::move(retired));
    }
    keep.insert(keep.end(), std::make_move_iterator(retired_.begin()),
                std::make_move_iterator(retired_.end()));
    retired_ = std::move(keep);
}

void Device::setName(VkObjectType type, uint64_t object, const std::string& name) const {
    if (!functions_.setDebugUtilsObjectName) return;
    VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
    info.objectType = type;
    info.objectHandle = object;
    info.pObjectName = name.c_str();
    functions_.setDebugUtilsObjectName(device_, &info);
}

} // namespace heliodon::gpu
