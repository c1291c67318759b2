#include "compute/gpu/kernel.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "compute/gpu/buffer.h"
#include "compute/gpu/device.h"
#include "compute/gpu/error.h"
#include "compute/gpu/image.h"

namespace heliodon::gpu {

namespace {

constexpr size_t kMostBindings = 32; // every device that pushes descriptors takes as many at once

} // namespace

Binding texel(const Buffer& buffer, VkFormat format, size_t offset, size_t bytes) {
    Binding binding(buffer);
    binding.format = format;
    binding.offset = offset;
    binding.bytes = bytes;
    return binding;
}

Binding part(const Buffer& buffer, size_t offset, size_t bytes) {
    return texel(buffer, VK_FORMAT_UNDEFINED, offset, bytes);
}

Binding sampled(const Image& image, VkSampler sampler, VkImageLayout layout) {
    Binding binding(image);
    binding.sampler = sampler;
    binding.layout = layout;
    return binding;
}

namespace {

size_t texelBytes(VkFormat format) {
    switch (format) {
    case VK_FORMAT_R32_SFLOAT:
    case VK_FORMAT_R32_UINT:
        return 4;
    case VK_FORMAT_R32G32_SFLOAT:
    case VK_FORMAT_R32G32_UINT:
        return 8;
    case VK_FORMAT_R32G32B32A32_SFLOAT:
    case VK_FORMAT_R32G32B32A32_UINT:
        return 16;
    default:
        throw Error(fmt::format("texel format {} is not used here", static_cast<int>(format)));
    }
}

} // namespace

void checkLimits(const SpirvModule& module, const VkPhysicalDeviceLimits& limits, const std::string& name) {
    const auto need = [&](const char* what, size_t needed, uint32_t most) {
        if (needed > most)
            throw Error(
                fmt::format("shader '{}' needs {} {}, the device allows {}", name, needed, what, most));
    };
    size_t storage = 0, sampled = 0;
    for (const SpirvBinding& b : module.bindings)
        (b.type == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER ? storage : sampled) += b.count;
    need("storage buffers", storage, limits.maxPerStageDescriptorStorageBuffers);
    need("sampled images and texel buffers", sampled, limits.maxPerStageDescriptorSampledImages);
    need("resources", module.bindings.size(), limits.maxPerStageResources);
    need("bytes of push constants", module.pushConstantBytes, limits.maxPushConstantsSize);
    if (module.stage != VK_SHADER_STAGE_COMPUTE_BIT) return;
    const auto& group = module.groupSize;
    for (size_t axis = 0; axis < 3; ++axis)
        need("invocations along one axis of a group", group[axis], limits.maxComputeWorkGroupSize[axis]);
    need("invocations a group", size_t{group[0]} * group[1] * group[2],
         limits.maxComputeWorkGroupInvocations);
}

PipelineLayout::PipelineLayout(Device& device, std::span<const SpirvModule> modules, const std::string& name)
    : device_(&device) {
    for (const SpirvModule& module : modules) {
        checkLimits(module, device.limits(), name);
        stages_ |= module.stage;
        pushConstantBytes_ = std::max(pushConstantBytes_, module.pushConstantBytes);
        for (const SpirvBinding& binding : module.bindings)
            if (std::none_of(bindings_.begin(), bindings_.end(),
                             [&](const auto& b) { return b.binding == binding.binding; }))
                bindings_.push_back(binding);
    }
    if (bindings_.size() > kMostBindings)
        throw Error(
            fmt::format("shader '{}' has {} bindings, over {}", name, bindings_.size(), kMostBindings));
    std::sort(bindings_.begin(), bindings_.end(),
              [](const auto& a, const auto& b) { return a.binding < b.binding; });
    std::vector<VkDescriptorSetLayoutBinding> slots;
    for (const SpirvBinding& b : bindings_) slots.push_back({b.binding, b.type, b.count, stages_, nullptr});
    VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    if (device.functions().cmdPushDescriptorSet)
        set.flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR;
    set.bindingCount = static_cast<uint32_t>(slots.size());
    set.pBindings = slots.data();
    check(vkCreateDescriptorSetLayout(device.handle(), &set, nullptr, &set_), "vkCreateDescriptorSetLayout");
    const VkPushConstantRange range{stages_, 0, pushConstantBytes_};
    VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    info.setLayoutCount = 1;
    info.pSetLayouts = &set_;
    info.pushConstantRangeCount = pushConstantBytes_ > 0 ? 1 : 0;
    info.pPushConstantRanges = &range;
    const VkResult result = vkCreatePipelineLayout(device.handle(), &info, nullptr, &layout_);
    if (result != VK_SUCCESS) vkDestroyDescriptorSetLayout(device.handle(), set_, nullptr);
    check(result, "vkCreatePipelineLayout");
}

PipelineLayout& PipelineLayout::operator=(PipelineLayout&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(set_, other.set_);
    std::swap(layout_, other.layout_);
    std::swap(bindings_, other.bindings_);
    std::swap(pushConstantBytes_, other.pushConstantBytes_);
    std::swap(stages_, other.stages_);
    return *this;
}

PipelineLayout::~PipelineLayout() {
    if (!device_) return;
    device_->retire([device = device_->handle(), layout = layout_, set = set_] {
        vkDestroyPipelineLayout(device, layout, nullptr);
        vkDestroyDescriptorSetLayout(device, set, nullptr);
    });
}

namespace {

// What a VkWriteDescriptorSet points to: one of them.
struct Description {
    VkDescriptorBufferInfo buffer;
    VkDescriptorImageInfo image;
    VkBufferView texels;
};

// Throws Error where the bytes bound are not all there, are more than the device allows, or begin where it
// does not.
void checkRange(const SpirvBinding& slot, const Binding& resource, const VkPhysicalDeviceLimits& limits) {
    const bool isTexel = slot.type == VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
    const Buffer& buffer = *resource.buffer;
    const size_t bytes = resource.bytes != VK_WHOLE_SIZE ? resource.bytes : buffer.bytes() - resource.offset;
    if (resource.offset > buffer.bytes() || bytes > buffer.roundedBytes() - resource.offset)
        throw Error(fmt::format("binding '{}' reaches beyond its buffer", slot.name));
    const VkDeviceSize alignment =
        isTexel ? limits.minTexelBufferOffsetAlignment : limits.minStorageBufferOffsetAlignment;
    if (resource.offset % alignment != 0)
        throw Error(fmt::format("binding '{}' begins at byte {}, no multiple of the device's {}", slot.name,
                                resource.offset, alignment));
    if (isTexel && resource.format == VK_FORMAT_UNDEFINED)
        throw Error(fmt::format("texel buffer '{}' was bound without a format", slot.name));
    const size_t count = isTexel ? bytes / texelBytes(resource.format) : bytes;
    const uint32_t most = isTexel ? limits.maxTexelBufferElements : limits.maxStorageBufferRange;
    if (count > most)
        throw Error(fmt::format("buffer '{}' of {} {} is over the device's {}", slot.name, count,
                                isTexel ? "texels" : "bytes", most));
}

VkWriteDescriptorSet describe(const SpirvBinding& slot, const Binding& resource,
                              const VkPhysicalDeviceLimits& limits, Description& into) {
    VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    write.dstBinding = slot.binding;
    write.descriptorCount = 1;
    write.descriptorType = slot.type;
    const bool wantsImage = slot.type == VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    if (wantsImage ? !resource.image : !resource.buffer)
        throw Error(
            fmt::format("binding {} ('{}') was given the wrong kind of resource", slot.binding, slot.name));
    if (wantsImage) {
        into.image = {resource.sampler, resource.image->view(), resource.layout};
        write.pImageInfo = &into.image;
        return write;
    }
    checkRange(slot, resource, limits);
    if (slot.type == VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER) {
        into.texels = resource.buffer->texelView(resource.format, resource.offset, resource.bytes);
        write.pTexelBufferView = &into.texels;
    } else {
        into.buffer = {resource.buffer->handle(), resource.offset, resource.bytes};
        write.pBufferInfo = &into.buffer;
    }
    return write;
}

} // namespace

void PipelineLayout::push(VkCommandBuffer commands, VkPipelineBindPoint point,
                          std::span<const Binding> resources, const void* constants,
                          size_t constantBytes) const {
    const size_t count = resources.size();
    if (count != bindings_.size())
        throw Error(fmt::format("a shader with {} bindings was given {} resources", bindings_.size(), count));
    if (constantBytes != pushConstantBytes_)
        throw Error(fmt::format("a shader with {} bytes of push constants was given {}", pushConstantBytes_,
                                constantBytes));
    std::array<Description, kMostBindings> descriptions;
    std::array<VkWriteDescriptorSet, kMostBindings> writes;
    for (size_t i = 0; i < count; ++i)
        writes[i] = describe(bindings_[i], resources[i], device_->limits(), descriptions[i]);
    if (count > 0) {
        if (const auto pushSet = device_->functions().cmdPushDescriptorSet)
            pushSet(commands, point, layout_, 0, static_cast<uint32_t>(count), writes.data());
        else
            bindSet(commands, point, std::span(writes).first(count));
    }
    if (constantBytes > 0)
        vkCmdPushConstants(commands, layout_, stages_, 0, static_cast<uint32_t>(constantBytes), constants);
}

// A set, and a pool, for one recording: the only way on devices without push descriptors.
void PipelineLayout::bindSet(VkCommandBuffer commands, VkPipelineBindPoint point,
                             std::span<VkWriteDescriptorSet> writes) const {
    std::vector<VkDescriptorPoolSize> sizes;
    for (const VkWriteDescriptorSet& write : writes) sizes.push_back({write.descriptorType, 1});
    VkDescriptorPoolCreateInfo poolInfo{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    poolInfo.maxSets = 1;
    poolInfo.poolSizeCount = static_cast<uint32_t>(sizes.size());
    poolInfo.pPoolSizes = sizes.data();
    VkDescriptorPool pool = VK_NULL_HANDLE;
    check(vkCreateDescriptorPool(device_->handle(), &poolInfo, nullptr, &pool), "vkCreateDescriptorPool");
    device_->retire([device = device_->handle(), pool] { vkDestroyDescriptorPool(device, pool, nullptr); });
    VkDescriptorSetAllocateInfo setInfo{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
    setInfo.descriptorPool = pool;
    setInfo.descriptorSetCount = 1;
    setInfo.pSetLayouts = &set_;
    VkDescriptorSet set = VK_NULL_HANDLE;
    check(vkAllocateDescriptorSets(device_->handle(), &setInfo, &set), "vkAllocateDescriptorSets");
    for (VkWriteDescriptorSet& write : writes) write.dstSet = set;
    vkUpdateDescriptorSets(device_->handle(), static_cast<uint32_t>(writes.size()), writes.data(), 0,
                           nullptr);
    vkCmdBindDescriptorSets(commands, point, layout_, 0, 1, &set, 0, nullptr);
}

SpecializationData::SpecializationData(const SpirvModule& module, const Specialization& values) {
    if (module.specializationIds.empty()) return; // they were set when the shader was built
    for (const auto& [name, value] : values) {
        const auto found = module.specializationIds.find(name);
        if (found == module.specializationIds.end())
            throw Error("the shader has no specialization constant '" + name + "'");
        entries.push_back({found->second, static_cast<uint32_t>(data.size() * 4), 4});
        data.push_back(value);
    }
    info = {static_cast<uint32_t>(entries.size()), entries.data(), data.size() * 4, data.data()};
}

Kernel::Kernel(WithoutPipeline, Device& device, std::span<const uint32_t> spirv, const std::string& name)
    : device_(&device), module_(reflectSpirv(spirv)), layout_(device, std::span(&module_, 1), name),
      name_(name) {}

Kernel::Kernel(Device& device, std::span<const uint32_t> spirv, const std::string& name,
               const Specialization& values)
    : Kernel(WithoutPipeline(), device, spirv, name) {
    pipeline_ = makePipeline(spirv, values);
}

VkPipeline Kernel::makePipeline(std::span<const uint32_t> spirv, const Specialization& values) const {
    VkShaderModuleCreateInfo shader{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    shader.codeSize = spirv.size_bytes();
    shader.pCode = spirv.data();
    VkShaderModule handle = VK_NULL_HANDLE;
    const SpecializationData specialization(module_, values);
    check(vkCreateShaderModule(device_->handle(), &shader, nullptr, &handle), "vkCreateShaderModule");
    VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    info.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
    info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    info.stage.module = handle;
    info.stage.pName = "main";
    info.stage.pSpecializationInfo = &specialization.info;
    // SPIR-V 1.6 lets the driver choose a size per kernel; dispatches are counted, and sums ordered, by one
    // size for all, and by subgroups without a lane missing.
    VkPipelineShaderStageRequiredSubgroupSizeCreateInfo size{
        VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_REQUIRED_SUBGROUP_SIZE_CREATE_INFO};
    size.requiredSubgroupSize = device_->subgroupSize();
    if (device_->fixesSubgroupSize()) info.stage.pNext = &size;
    if (device_->fillsSubgroups() && module_.groupSize[0] % device_->subgroupSize() == 0)
        info.stage.flags = VK_PIPELINE_SHADER_STAGE_CREATE_REQUIRE_FULL_SUBGROUPS_BIT;
    info.layout = layout_.handle();
    VkPipeline pipeline = VK_NULL_HANDLE;
    const VkResult result =
        vkCreateComputePipelines(device_->handle(), device_->pipelineCache(), 1, &info, nullptr, &pipeline);
    vkDestroyShaderModule(device_->handle(), handle, nullptr);
    check(result, ("vkCreateComputePipelines for " + name_).c_str());
    device_->setName(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<uint64_t>(pipeline), name_);
    return pipeline;
}

const Kernel& KernelCache::get(std::span<const uint32_t> spirv, const std::string& name,
                               const Specialization& values) {
    const Key key(spirv.data(), values);
    const auto found = entries_.find(key);
    if (found == entries_.end())
        return entries_.emplace(key, Entry{Kernel(*device_, spirv, name, values), {}}).first->second.kernel;
    try {
        if (found->second.coming.valid()) finish(found->second);
    } catch (...) {
        entries_.erase(found);
        throw;
    }
    return found->second.kernel;
}

void KernelCache::prepare(std::span<const uint32_t> spirv, const std::string& name,
                          const Specialization& values) {
    const Key key(spirv.data(), values);
    if (entries_.contains(key)) return;
    Entry& entry = entries_.emplace(key, Entry{Kernel(Kernel::WithoutPipeline(), *device_, spirv, name), {}})
                       .first->second;
    std::packaged_task<VkPipeline()> make(
        [&kernel = entry.kernel, spirv, values] { return kernel.makePipeline(spirv, values); });
    entry.coming = make.get_future();
    const std::scoped_lock lock(mutex_);
    waiting_.push_back({&entry, std::move(make)});
    if (busy_ == std::max(1u, std::thread::hardware_concurrency())) return;
    if (busy_ == 0) makers_.clear(); // all have ended
    ++busy_;
    makers_.emplace_back([this] { makeWaiting(); });
}

// Takes the pipeline; makes it here where nobody has begun to.
void KernelCache::finish(Entry& entry) {
    std::packaged_task<VkPipeline()> make;
    {
        const std::scoped_lock lock(mutex_);
        const auto mine =
            std::ranges::find_if(waiting_, [&](const Waiting& waiting) { return waiting.entry == &entry; });
        if (mine != waiting_.end()) {
            make = std::move(mine->make);
            waiting_.erase(mine);
        }
    }
    if (make.valid()) make();
    entry.kernel.pipeline_ = entry.coming.get();
}

void KernelCache::makeWaiting() {
    for (;;) {
        std::packaged_task<VkPipeline()> make;
        {
            const std::scoped_lock lock(mutex_);
            if (waiting_.empty()) {
                --busy_;
                return;
            }
            make = std::move(waiting_.front().make);
            waiting_.pop_front();
        }
        make();
    }
}

KernelCache::~KernelCache() {
    {
        const std::scoped_lock lock(mutex_);
        waiting_.clear();
    }
    makers_.clear();
    for (auto& [key, entry] : entries_) try {
            if (entry.coming.valid()) entry.kernel.pipeline_ = entry.coming.get();
        } catch (const std::exception&) { // it was never made
        }
}

Kernel& Kernel::operator=(Kernel&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(module_, other.module_);
    std::swap(layout_, other.layout_);
    std::swap(pipeline_, other.pipeline_);
    std::swap(name_, other.name_);
    return *this;
}

Kernel::~Kernel() {
    if (!pipeline_) return;
    device_->retire(
        [device = device_->handle(), pipeline = pipeline_] { vkDestroyPipeline(device, pipeline, nullptr); });
}

} // namespace heliodon::gpu
