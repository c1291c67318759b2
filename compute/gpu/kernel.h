// A compute pipeline whose interface is read from its SPIR-V: descriptors in set 0, pushed where the device
// can, one push-constant block.
#pragma once

#include <cstdint>
#include <deque>
#include <future>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include <vulkan/vulkan.h>

#include "compute/gpu/spirv.h"

namespace heliodon::gpu {

class Buffer;
class Device;
class Image;

// One resource for one binding. Buffers and images convert implicitly; `texel`, `part` and `sampled` say
// more. Refers to what it is made of.
struct Binding {
    Binding(const Buffer& b) : buffer(&b) {}
    Binding(const Image& i) : image(&i) {}

    const Buffer* buffer = nullptr;
    const Image* image = nullptr;
    VkSampler sampler = VK_NULL_HANDLE;             // for combined image samplers
    VkImageLayout layout = VK_IMAGE_LAYOUT_GENERAL; // of `image` when it is used
    VkFormat format = VK_FORMAT_UNDEFINED;          // of texel buffers
    size_t offset = 0, bytes = VK_WHOLE_SIZE;       // of `buffer`
};
// From byte `offset`, `bytes` on; both kinds of buffer begin at multiples of what the device's limits say.
Binding texel(const Buffer& buffer, VkFormat format, size_t offset = 0, size_t bytes = VK_WHOLE_SIZE);
Binding part(const Buffer& buffer, size_t offset, size_t bytes);
Binding sampled(const Image& image, VkSampler sampler,
                VkImageLayout layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);

// Throws Error, which names the shader, where a module needs more than the limits allow: Vulkan promises 4
// storage buffers a stage and 128 invocations a group, and several kernels need more.
void checkLimits(const SpirvModule& module, const VkPhysicalDeviceLimits& limits, const std::string& name);

// Layout of set 0 + push constants of one or several stages. Shared by kernels and graphics pipelines.
class PipelineLayout {
public:
    PipelineLayout() = default;
    PipelineLayout(Device& device, std::span<const SpirvModule> stages, const std::string& name);
    PipelineLayout(PipelineLayout&& other) noexcept { *this = std::move(other); }
    PipelineLayout& operator=(PipelineLayout&& other) noexcept;
    ~PipelineLayout();

    VkPipelineLayout handle() const { return layout_; }
    const std::vector<SpirvBinding>& bindings() const { return bindings_; } // of all stages, by number
    uint32_t pushConstantBytes() const { return pushConstantBytes_; }
    VkShaderStageFlags stages() const { return stages_; }

    // Records the push of descriptors and constants. `resources` follow the order of bindings(); their count
    // and ranges are checked against the shader and the device's limits (throws Error).
    void push(VkCommandBuffer commands, VkPipelineBindPoint point, std::span<const Binding> resources,
              const void* constants, size_t constantBytes) const;

private:
    void bindSet(VkCommandBuffer commands, VkPipelineBindPoint point,
                 std::span<VkWriteDescriptorSet> writes) const;

    Device* device_ = nullptr;
    VkDescriptorSetLayout set_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    std::vector<SpirvBinding> bindings_;
    uint32_t pushConstantBytes_ = 0;
    VkShaderStageFlags stages_ = 0;
};

// Specialization constants by the name that the shader gives them; booleans are 0 or 1, floats by bit
// pattern.
using Specialization = std::vector<std::pair<std::string, uint32_t>>;

// Vulkan's form of `values`; throws Error on a name that the shader does not have. Empty for a shader whose
// constants were all set when it was built (shaders/CMakeLists.txt: add_variants).
struct SpecializationData {
    SpecializationData(const SpirvModule& module, const Specialization& values);
    std::vector<VkSpecializationMapEntry> entries;
    std::vector<uint32_t> data;
    VkSpecializationInfo info{};
};

// Move-only; goes to the device's retire queue when dropped, so it may be dropped while it is in use.
class Kernel {
public:
    Kernel() = default; // none: only to be assigned to
    // Compiles, which is slow (see KernelCache); `spirv` is not needed afterwards. Throws Error where the
    // device lacks what the shader needs, and for a constant that it does not have.
    Kernel(Device& device, std::span<const uint32_t> spirv, const std::string& name,
           const Specialization& values = {});
    Kernel(Kernel&& other) noexcept { *this = std::move(other); }
    Kernel& operator=(Kernel&& other) noexcept;
    ~Kernel();

    VkPipeline handle() const { return pipeline_; }
    const PipelineLayout& layout() const { return layout_; }
    const SpirvModule& module() const { return module_; }
    const std::string& name() const { return name_; }

private:
    friend class KernelCache;
    struct WithoutPipeline {};
    Kernel(WithoutPipeline, Device& device, std::span<const uint32_t> spirv, const std::string& name);
    VkPipeline makePipeline(std::span<const uint32_t> spirv,
                            const Specialization& values) const; // on any thread

    Device* device_ = nullptr;
    SpirvModule module_;
    PipelineLayout layout_;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
    std::string name_;
};

// Kernels made once for each device and kept: creating a pipeline and its first dispatch cost 10 to 100 ms.
// Owned by the Device. `spirv` must be static: its address is the key, together with the specialization.
class KernelCache {
public:
    explicit KernelCache(Device& device) : device_(&device) {}
    KernelCache(const KernelCache&) = delete;
    KernelCache& operator=(const KernelCache&) = delete;
    ~KernelCache(); // waits for what is being made

    const Kernel& get(std::span<const uint32_t> spirv, const std::string& name,
                      const Specialization& values = {});

    // Begins to make a kernel on another core, in the order of the calls, while the caller goes on. get()
    // hands it out, and throws what its making threw.
    void prepare(std::span<const uint32_t> spirv, const std::string& name, const Specialization& values = {});

private:
    using Key = std::tuple<const uint32_t*, Specialization>;
    struct Entry {
        Kernel kernel;
        std::future<VkPipeline> coming; // valid: the pipeline is still to be taken from here
    };
    struct Waiting {
        const Entry* entry;
        std::packaged_task<VkPipeline()> make;
    };

    void finish(Entry& entry);
    void makeWaiting();

    Device* device_;
    std::map<Key, Entry> entries_;
    std::mutex mutex_; // of waiting_ and busy_
    std::deque<Waiting> waiting_;
    size_t busy_ = 0; // makers at work
    std::vector<std::jthread> makers_;
};

} // namespace heliodon::gpu
