// One Vulkan device with one queue: choice, features, submission and retirement. The only Vulkan substrate of
// the program. Everything made from a Device must be destroyed before it. Calls on one Device come from one
// thread at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <vulkan/vulkan.h>

#include "compute/gpu/memory.h"

namespace heliodon::gpu {

struct DeviceOptions {
    std::string select; // part of a device's name (any case) or its index; empty: discrete, else integrated,
                        // else software
    bool validation = false; // core and synchronization validation; the layer must be installed
    std::function<void(std::string_view)> onMessage; // validation messages; may be called from any thread
    std::vector<std::string> instanceExtensions;     // for windows, as the window library asks for
    // Called by submit() before anything is handed over; what it throws, submit throws. For long work that
    // someone may want to end.
    std::function<void()> beforeSubmit;
    bool swapchains = false;     // VK_KHR_swapchain is needed
    bool pushDescriptors = true; // false: descriptor sets, as on devices without the extension; for tests
    bool mapsOwnMemory =
        true; // false: the host does not see Place::device, as on discrete devices; for tests
};

struct DeviceInfo {
    uint32_t index = 0;
    std::string name, driver, type; // type: "discrete", "integrated", "virtual", "software", "other"
    uint32_t apiVersion = 0;
    std::string refused; // why it cannot be used; empty when it can
};

// Every device that the loader knows, usable or not. Throws Error when it finds no driver.
std::vector<DeviceInfo> listDevices();

class Commands;
class KernelCache;

class Device {
public:
    // Throws NoDevice, which lists each device and why it was refused, when none fits `select`; Error when a
    // call fails.
    explicit Device(const DeviceOptions& options = {});
    ~Device(); // waits for the queue
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    VkInstance instance() const { return instance_; }
    VkPhysicalDevice physical() const { return physical_; }
    VkDevice handle() const { return device_; }
    VkQueue queue() const { return queue_; }
    uint32_t queueFamily() const { return queueFamily_; }
    const DeviceInfo& info() const { return info_; }
    const VkPhysicalDeviceLimits& limits() const { return limits_; }
    // Of every Kernel, also where the device knows several; 64 at most.
    uint32_t subgroupSize() const { return subgroupSize_; }
    bool fixesSubgroupSize() const { return fixesSubgroupSize_; } // it must be asked for with each pipeline
    bool fillsSubgroups() const {
        return fillsSubgroups_;
    } // none with a lane missing, where that is asked for
    Memory& memory() { return *memory_; }
    KernelCache& kernels() { return *kernels_; } // for kernels that many objects share
    // Of this run alone: from run to run drivers keep their own on disk.
    VkPipelineCache pipelineCache() const { return pipelineCache_; }

    // Ends `commands` and hands it to the queue. The ticket grows with each submission. `written`, of
    // presentation, is signalled beside the timeline.
    uint64_t submit(Commands&& commands, VkSemaphore written = VK_NULL_HANDLE);
    // Waits for it and all before it. Throws Error, deviceLost() where the device failed.
    void wait(uint64_t ticket);
    bool finished(uint64_t ticket);          // without waiting
    void submitAndWait(Commands&& commands); // submit + wait
    void waitIdle();

    // Calls `release` once everything submitted so far, or being recorded now, has finished on the device.
    void retire(std::function<void()> release);

    // For validation messages and debuggers; nothing without validation.
    void setName(VkObjectType type, uint64_t object, const std::string& name) const;

    // Ticket of the latest submission; 0 when there was none.
    uint64_t lastTicket() const { return lastTicket_; }

    // From now on the device's own clock is read at the begin and the end of every recording; the sum of the
    // finished ones since the last call of startTiming. 0 where the queue has no clock. For benches.
    void startTiming();
    double timedSeconds();

    struct Functions { // extension entry points that the loader does not export
        PFN_vkCmdPushDescriptorSetKHR cmdPushDescriptorSet = nullptr; // null where the device has none
        PFN_vkSetDebugUtilsObjectNameEXT setDebugUtilsObjectName = nullptr;
    };
    const Functions& functions() const { return functions_; }

private:
    friend class Commands;

    void createOwnObjects(const DeviceOptions& options);
    void destroy();
    void createInstance(const DeviceOptions& options);
    void choosePhysical(const DeviceOptions& options);
    void createDevice(const DeviceOptions& options);
    void collectRetired();
    void closeRecording();
    VkCommandBuffer beginCommandBuffer(); // for Commands
    void abandonCommandBuffer(VkCommandBuffer buffer);
    void beginTimed(VkCommandBuffer buffer);
    void endTimed(VkCommandBuffer buffer);
    void readTimed(uint32_t slot);

    static constexpr uint64_t kPending = UINT64_MAX;
    struct Retired {
        uint64_t ticket; // released when the device has reached it; kPending while a recording is open
        std::function<void()> release;
    };

    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    std::function<void(std::string_view)> onMessage_;
    std::function<void()> beforeSubmit_;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    uint32_t queueFamily_ = 0;
    DeviceInfo info_;
    VkPhysicalDeviceLimits limits_{};
    uint32_t subgroupSize_ = 1;
    bool fixesSubgroupSize_ = false, fillsSubgroups_ = false;
    Functions functions_;
    std::unique_ptr<Memory> memory_;
    std::unique_ptr<KernelCache> kernels_;
    VkPipelineCache pipelineCache_ = VK_NULL_HANDLE;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkSemaphore timeline_ = VK_NULL_HANDLE;
    uint64_t lastTicket_ = 0;
    uint64_t openRecordings_ = 0;

    static constexpr uint32_t kTimedSlots = 256; // recordings under way at once that are timed
    struct Timed {
        VkCommandBuffer buffer = VK_NULL_HANDLE; // being recorded
        bool busy = false;
    };
    VkQueryPool timing_ = VK_NULL_HANDLE;
    uint64_t tickMask_ = 0; // the clock's bits
    std::vector<Timed> timed_;
    double timedSeconds_ = 0;
    std::vector<VkCommandBuffer> freeCommandBuffers_;
    std::vector<Retired> retired_;
};

} // namespace heliodon::gpu
