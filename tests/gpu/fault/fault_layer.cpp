// A Vulkan layer for tests alone: makes a chosen call fail, and says what was never given back.
//
//   HELIODON_FAULT=CALL:N:RESULT[:TIMES]   the Nth such call of the process fails, and the TIMES - 1 after it
//       CALL    submit, wait, acquire, present, or an object's type: Memory, Buffer, Image, Device, Swapchain
//       ... RESULT  lost, memory, hostmemory, date, suboptimal, surface, failed
//   HELIODON_FAULT_LOG=FILE                a line for each call that failed, for how many objects of each
//   type
//                                          were made, and for each left over
//
// After `lost` the same device fails every further submission, wait, acquisition and presentation, as the
// specification has it. Work that was submitted is done all the same, so objects may be destroyed.
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <set>
#include <string>

#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

namespace {

// ---- What is to fail ----

struct Fault {
    std::string call;
    long first = 0, times = 1;
    VkResult result = VK_SUCCESS;
};

VkResult resultOf(const std::string& name) {
    const std::map<std::string, VkResult> results{{"lost", VK_ERROR_DEVICE_LOST},
                                                  {"memory", VK_ERROR_OUT_OF_DEVICE_MEMORY},
                                                  {"hostmemory", VK_ERROR_OUT_OF_HOST_MEMORY},
                                                  {"date", VK_ERROR_OUT_OF_DATE_KHR},
                                                  {"suboptimal", VK_SUBOPTIMAL_KHR},
                                                  {"surface", VK_ERROR_SURFACE_LOST_KHR},
                                                  {"failed", VK_ERROR_INITIALIZATION_FAILED}};
    return results.at(name);
}

Fault readFault() {
    const char* text = std::getenv("HELIODON_FAULT");
    if (!text) return {};
    char call[64] = "", result[64] = "";
    Fault fault;
    if (std::sscanf(text, "%63[^:]:%ld:%63[^:]:%ld", call, &fault.first, result, &fault.times) < 3)
        std::abort();
    fault.call = call;
    fault.result = resultOf(result);
    return fault;
}

std::mutex mutex; // of all that follows

const Fault& fault() {
    static const Fault read = readFault();
    return read;
}

void log(const std::string& line) {
    const char* file = std::getenv("HELIODON_FAULT_LOG");
    std::FILE* out = file ? std::fopen(file, "a") : nullptr;
    if (!out) return;
    std::fprintf(out, "%s\n", line.c_str());
    std::fclose(out);
}

// VK_SUCCESS, or what this call is to return.
VkResult failure(const char* call) {
    static long count = 0;
    if (fault().call != call) return VK_SUCCESS;
    const std::lock_guard lock(mutex);
    ++count;
    if (count < fault().first || count >= fault().first + fault().times) return VK_SUCCESS;
    log("failed " + std::string(call) + " " + std::to_string(count));
    return fault().result;
}

// ---- The chain of layers ----

template<class Handle> void* keyOf(Handle handle) {
    return *reinterpret_cast<void**>(handle); // the loader's table: the same for a device and its queues
}

// Of the next layer, the same for all instances of a process. Asked for while an instance is being made:
// later the loader answers with the head of the chain.
PFN_vkGetInstanceProcAddr nextLayer = nullptr;
PFN_vkDestroyInstance nextDestroyInstance = nullptr;
std::map<void*, PFN_vkGetDeviceProcAddr> devices;
std::map<void*, VkDevice> handles;
std::set<void*> lostDevices;
std::map<std::string, long> alive, made; // objects by type

template<class Function, class Handle> Function nextOf(Handle handle, const char* name) {
    PFN_vkGetDeviceProcAddr get = nullptr;
    VkDevice device = VK_NULL_HANDLE;
    {
        const std::lock_guard lock(mutex);
        get = devices.at(keyOf(handle));
        device = handles.at(keyOf(handle));
    }
    return reinterpret_cast<Function>(get(device, name));
}

template<class Handle> bool isLost(Handle handle) {
    const std::lock_guard lock(mutex);
    return lostDevices.contains(keyOf(handle));
}

template<class Handle> VkResult failureOn(Handle handle, const char* call) {
    if (isLost(handle)) return VK_ERROR_DEVICE_LOST;
    const VkResult result = failure(call);
    if (result == VK_ERROR_DEVICE_LOST) {
        const std::lock_guard lock(mutex);
        lostDevices.insert(keyOf(handle));
    }
    return result;
}

void count(const char* type, long change) {
    const std::lock_guard lock(mutex);
    alive[type] += change;
    if (change > 0) made[type] += change;
}

// What is alive when the program ends.
void logLeftOver() {
    const std::lock_guard lock(mutex);
    for (const auto& [type, number] : made) log("made: " + std::to_string(number) + " " + type);
    for (auto& [type, number] : alive)
        if (number != 0) log("left over: " + std::to_string(number) + " " + type);
}

struct AtExit {
    ~AtExit() { logLeftOver(); }
} atExit;

template<class Info, class Link> Link* linkOf(const Info* info, VkStructureType type) {
    auto* at = static_cast<Link*>(const_cast<void*>(info->pNext));
    while (at && !(at->sType == type && at->function == VK_LAYER_LINK_INFO))
        at = static_cast<Link*>(const_cast<void*>(at->pNext));
    return at;
}

VKAPI_ATTR VkResult VKAPI_CALL createInstance(const VkInstanceCreateInfo* info,
                                              const VkAllocationCallbacks* callbacks, VkInstance* instance) {
    auto* link = linkOf<VkInstanceCreateInfo, VkLayerInstanceCreateInfo>(
        info, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
    const PFN_vkGetInstanceProcAddr get = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    if (const VkResult result = failure("Instance")) return result;
    const auto create = reinterpret_cast<PFN_vkCreateInstance>(get(VK_NULL_HANDLE, "vkCreateInstance"));
    const VkResult result = create(info, callbacks, instance);
    if (result != VK_SUCCESS) return result;
    count("Instance", 1);
    const std::lock_guard lock(mutex);
    nextLayer = get;
    nextDestroyInstance = reinterpret_cast<PFN_vkDestroyInstance>(get(*instance, "vkDestroyInstance"));
    return result;
}

VKAPI_ATTR void VKAPI_CALL destroyInstance(VkInstance instance, const VkAllocationCallbacks* callbacks) {
    if (instance) count("Instance", -1);
    nextDestroyInstance(instance, callbacks);
}

VKAPI_ATTR VkResult VKAPI_CALL createDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                            const VkAllocationCallbacks* callbacks, VkDevice* device) {
    auto* link = linkOf<VkDeviceCreateInfo, VkLayerDeviceCreateInfo>(
        info, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
    const PFN_vkGetInstanceProcAddr getOfInstance = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
    const PFN_vkGetDeviceProcAddr get = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
    link->u.pLayerInfo = link->u.pLayerInfo->pNext;
    if (const VkResult result = failure("Device")) return result;
    const auto create = reinterpret_cast<PFN_vkCreateDevice>(getOfInstance(VK_NULL_HANDLE, "vkCreateDevice"));
    const VkResult result = create(physical, info, callbacks, device);
    if (result != VK_SUCCESS) return result;
    count("Device", 1);
    const std::lock_guard lock(mutex);
    devices[keyOf(*device)] = get;
    handles[keyOf(*device)] = *device;
    return result;
}

VKAPI_ATTR void VKAPI_CALL destroyDevice(VkDevice device, const VkAllocationCallbacks* callbacks) {
    if (!device) return;
    const auto destroy = nextOf<PFN_vkDestroyDevice>(device, "vkDestroyDevice");
    count("Device", -1);
    {
        const std::lock_guard lock(mutex);
        lostDevices.erase(keyOf(device));
        devices.erase(keyOf(device));
        handles.erase(keyOf(device));
    }
    destroy(device, callbacks);
}

// ---- Objects: each can fail to be made, and is counted ----

// X(type, suffix)
#define OBJECTS(X)                                                                                           \
    X(Buffer, )                                                                                              \
    X(BufferView, )                                                                                          \
    X(Image, )                                                                                               \
    X(ImageView, )                                                                                           \
    X(Sampler, )                                                                                             \
    X(ShaderModule, )                                                                                        \
    X(DescriptorSetLayout, )                                                                                 \
    X(PipelineLayout, ) X(Semaphore, ) X(Fence, ) X(QueryPool, ) X(CommandPool, ) X(Swapchain, KHR)

#define DEFINE(type, suffix)                                                                                 \
    VKAPI_ATTR VkResult VKAPI_CALL Create##type(VkDevice device, const Vk##type##CreateInfo##suffix* info,   \
                                                const VkAllocationCallbacks* callbacks,                      \
                                                Vk##type##suffix* object) {                                  \
        *object = VK_NULL_HANDLE;                                                                            \
        if (const VkResult result = failureOn(device, #type)) return result;                                 \
        const auto create = nextOf<PFN_vkCreate##type##suffix>(device, "vkCreate" #type #suffix);            \
        const VkResult result = create(device, info, callbacks, object);                                     \
        if (result == VK_SUCCESS) count(#type, 1);                                                           \
        return result;                                                                                       \
    }                                                                                                        \
    VKAPI_ATTR void VKAPI_CALL Destroy##type(VkDevice device, Vk##type##suffix object,                       \
                                             const VkAllocationCallbacks* callbacks) {                       \
        if (object) count(#type, -1);                                                                        \
        nextOf<PFN_vkDestroy##type##suffix>(device, "vkDestroy" #type #suffix)(device, object, callbacks);   \
    }
OBJECTS(DEFINE)

VKAPI_ATTR VkResult VKAPI_CALL AllocateMemory(VkDevice device, const VkMemoryAllocateInfo* info,
                                              const VkAllocationCallbacks* callbacks,
                                              VkDeviceMemory* memory) {
    if (const VkResult result = failureOn(device, "Memory")) return result;
    const VkResult result =
        nextOf<PFN_vkAllocateMemory>(device, "vkAllocateMemory")(device, info, callbacks, memory);
    if (result == VK_SUCCESS) count("Memory", 1);
    return result;
}
VKAPI_ATTR void VKAPI_CALL FreeMemory(VkDevice device, VkDeviceMemory memory,
                                      const VkAllocationCallbacks* callbacks) {
    if (memory) count("Memory", -1);
    nextOf<PFN_vkFreeMemory>(device, "vkFreeMemory")(device, memory, callbacks);
}

#define DEFINE_PIPELINES(kind)                                                                               \
    VKAPI_ATTR VkResult VKAPI_CALL Create##kind##Pipelines(                                                  \
        VkDevice device, VkPipelineCache cache, uint32_t number, const Vk##kind##PipelineCreateInfo* infos,  \
        const VkAllocationCallbacks* callbacks, VkPipeline* pipelines) {                                     \
        std::memset(pipelines, 0, number * sizeof *pipelines);                                               \
        if (const VkResult result = failureOn(device, "Pipeline")) return result;                            \
        const auto create = nextOf<PFN_vkCreate##kind##Pipelines>(device, "vkCreate" #kind "Pipelines");     \
        const VkResult result = create(device, cache, number, infos, callbacks, pipelines);                  \
        if (result == VK_SUCCESS) count("Pipeline", number);                                                 \
        return result;                                                                                       \
    }
DEFINE_PIPELINES(Compute)
DEFINE_PIPELINES(Graphics)

VKAPI_ATTR void VKAPI_CALL DestroyPipeline(VkDevice device, VkPipeline pipeline,
                                           const VkAllocationCallbacks* callbacks) {
    if (pipeline) count("Pipeline", -1);
    nextOf<PFN_vkDestroyPipeline>(device, "vkDestroyPipeline")(device, pipeline, callbacks);
}

// ---- Work ----

VKAPI_ATTR VkResult VKAPI_CALL BindBufferMemory(VkDevice device, VkBuffer buffer, VkDeviceMemory memory,
                                                VkDeviceSize offset) {
    if (const VkResult result = failureOn(device, "bind")) return result;
    return nextOf<PFN_vkBindBufferMemory>(device, "vkBindBufferMemory")(device, buffer, memory, offset);
}
VKAPI_ATTR VkResult VKAPI_CALL BindImageMemory(VkDevice device, VkImage image, VkDeviceMemory memory,
                                               VkDeviceSize offset) {
    if (const VkResult result = failureOn(device, "bind")) return result;
    return nextOf<PFN_vkBindImageMemory>(device, "vkBindImageMemory")(device, image, memory, offset);
}
VKAPI_ATTR VkResult VKAPI_CALL EndCommandBuffer(VkCommandBuffer buffer) {
    if (const VkResult result = failure("record")) return result;
    return nextOf<PFN_vkEndCommandBuffer>(buffer, "vkEndCommandBuffer")(buffer);
}
VKAPI_ATTR VkResult VKAPI_CALL QueueSubmit2(VkQueue queue, uint32_t number, const VkSubmitInfo2* infos,
                                            VkFence fence) {
    if (const VkResult result = failureOn(queue, "submit")) return result;
    return nextOf<PFN_vkQueueSubmit2>(queue, "vkQueueSubmit2")(queue, number, infos, fence);
}
VKAPI_ATTR VkResult VKAPI_CALL WaitSemaphores(VkDevice device, const VkSemaphoreWaitInfo* info,
                                              uint64_t timeout) {
    if (const VkResult result = failureOn(device, "wait")) return result;
    return nextOf<PFN_vkWaitSemaphores>(device, "vkWaitSemaphores")(device, info, timeout);
}
VKAPI_ATTR VkResult VKAPI_CALL GetSemaphoreCounterValue(VkDevice device, VkSemaphore semaphore,
                                                        uint64_t* value) {
    if (isLost(device)) return VK_ERROR_DEVICE_LOST;
    return nextOf<PFN_vkGetSemaphoreCounterValue>(device, "vkGetSemaphoreCounterValue")(device, semaphore,
                                                                                        value);
}
VKAPI_ATTR VkResult VKAPI_CALL DeviceWaitIdle(VkDevice device) {
    const VkResult result = nextOf<PFN_vkDeviceWaitIdle>(device, "vkDeviceWaitIdle")(device);
    return isLost(device) ? VK_ERROR_DEVICE_LOST : result;
}
VKAPI_ATTR VkResult VKAPI_CALL QueueWaitIdle(VkQueue queue) {
    const VkResult result = nextOf<PFN_vkQueueWaitIdle>(queue, "vkQueueWaitIdle")(queue);
    return isLost(queue) ? VK_ERROR_DEVICE_LOST : result;
}
VKAPI_ATTR VkResult VKAPI_CALL AcquireNextImageKHR(VkDevice device, VkSwapchainKHR swapchain,
                                                   uint64_t timeout, VkSemaphore semaphore, VkFence fence,
                                                   uint32_t* index) {
    const VkResult result = failureOn(device, "acquire");
    if (result < VK_SUCCESS) return result;
    const VkResult real = nextOf<PFN_vkAcquireNextImageKHR>(device, "vkAcquireNextImageKHR")(
        device, swapchain, timeout, semaphore, fence, index);
    return real == VK_SUCCESS ? result : real;
}
// One of several swapchains fails, the last; a lost device and lack of memory concern all of them.
VKAPI_ATTR VkResult VKAPI_CALL QueuePresentKHR(VkQueue queue, const VkPresentInfoKHR* info) {
    const VkResult result = failureOn(queue, "present");
    if (result == VK_ERROR_DEVICE_LOST || result == VK_ERROR_OUT_OF_DEVICE_MEMORY) return result;
    const VkResult real = nextOf<PFN_vkQueuePresentKHR>(queue, "vkQueuePresentKHR")(queue, info);
    if (result == VK_SUCCESS) return real;
    if (info->pResults) info->pResults[info->swapchainCount - 1] = result;
    return result;
}

// ---- The loader's entry ----

#define NAMED(type, suffix)                                                                                  \
    {"vkCreate" #type #suffix, reinterpret_cast<PFN_vkVoidFunction>(Create##type)},                          \
        {"vkDestroy" #type #suffix, reinterpret_cast<PFN_vkVoidFunction>(Destroy##type)},
#define ALONE(function) {"vk" #function, reinterpret_cast<PFN_vkVoidFunction>(function)},

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL getDeviceProcAddr(VkDevice device, const char* name);
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL getInstanceProcAddr(VkInstance instance, const char* name);

PFN_vkVoidFunction ours(const char* name, bool ofInstance) {
    static const std::map<std::string, PFN_vkVoidFunction> ofDevices{
        OBJECTS(NAMED) ALONE(AllocateMemory) ALONE(FreeMemory) ALONE(CreateComputePipelines)
            ALONE(CreateGraphicsPipelines) ALONE(DestroyPipeline) ALONE(BindBufferMemory)
                ALONE(BindImageMemory) ALONE(EndCommandBuffer) ALONE(QueueSubmit2) ALONE(WaitSemaphores)
                    ALONE(GetSemaphoreCounterValue) ALONE(DeviceWaitIdle) ALONE(QueueWaitIdle)
                        ALONE(AcquireNextImageKHR) ALONE(QueuePresentKHR){
                            "vkDestroyDevice", reinterpret_cast<PFN_vkVoidFunction>(destroyDevice)},
        {"vkGetDeviceProcAddr", reinterpret_cast<PFN_vkVoidFunction>(getDeviceProcAddr)}};
    static const std::map<std::string, PFN_vkVoidFunction> ofInstances{
        {"vkCreateInstance", reinterpret_cast<PFN_vkVoidFunction>(createInstance)},
        {"vkDestroyInstance", reinterpret_cast<PFN_vkVoidFunction>(destroyInstance)},
        {"vkCreateDevice", reinterpret_cast<PFN_vkVoidFunction>(createDevice)},
        {"vkGetInstanceProcAddr", reinterpret_cast<PFN_vkVoidFunction>(getInstanceProcAddr)}};
    if (ofInstance)
        if (const auto found = ofInstances.find(name); found != ofInstances.end()) return found->second;
    const auto found = ofDevices.find(name);
    return found == ofDevices.end() ? nullptr : found->second;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL getDeviceProcAddr(VkDevice device, const char* name) {
    const auto next = nextOf<PFN_vkGetDeviceProcAddr>(device, "vkGetDeviceProcAddr");
    const PFN_vkVoidFunction real = next(device, name);
    const PFN_vkVoidFunction mine = ours(name, false);
    return real && mine ? mine : real;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL getInstanceProcAddr(VkInstance instance, const char* name) {
    if (const PFN_vkVoidFunction mine = ours(name, true)) return mine;
    if (!instance) return nullptr;
    return nextLayer(instance, name);
}

} // namespace

extern "C" __attribute__((visibility("default"))) VKAPI_ATTR VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* version) {
    version->loaderLayerInterfaceVersion = 2;
    version->pfnGetInstanceProcAddr = getInstanceProcAddr;
    version->pfnGetDeviceProcAddr = getDeviceProcAddr;
    version->pfnGetPhysicalDeviceProcAddr = nullptr;
    return VK_SUCCESS;
}
