#include "compute/gpu/memory.h"

#include <algorithm>
#include <cassert>
#include <optional>

#include "compute/gpu/error.h"

namespace heliodon::gpu {

namespace {

VkDeviceSize alignUp(VkDeviceSize value, VkDeviceSize alignment) {
    return (value + alignment - 1) / alignment * alignment;
}

} // namespace

Memory::Memory(VkPhysicalDevice physical, VkDevice device, bool mapsOwn)
    : device_(device), mapsOwn_(mapsOwn), keeps_(!mapsOwn) {
    vkGetPhysicalDeviceMemoryProperties(physical, &properties_);
    VkPhysicalDeviceMaintenance4Properties buffers{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES};
    VkPhysicalDeviceMaintenance3Properties sizes{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES,
                                                 &buffers, 0, 0};
    VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &sizes, {}};
    vkGetPhysicalDeviceProperties2(physical, &all);
    largestPiece_ = sizes.maxMemoryAllocationSize;
    largestBuffer_ = buffers.maxBufferSize;
    for (uint32_t i = 0; i < properties_.memoryTypeCount; ++i) {
        const VkMemoryPropertyFlags flags = properties_.memoryTypes[i].propertyFlags;
        keeps_ |=
            (flags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) && !(flags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT);
    }
}

Memory::~Memory() {
    assert(inUse_ == 0);
    for (auto& [key, pool] : pools_)
        for (Block& block : pool) vkFreeMemory(device_, block.memory, nullptr);
}

VkDeviceSize Memory::largestHeap() const {
    VkDeviceSize most = 0;
    for (uint32_t i = 0; i < properties_.memoryTypeCount; ++i)
        if (properties_.memoryTypes[i].propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)
            most = std::max(most, properties_.memoryHeaps[properties_.memoryTypes[i].heapIndex].size);
    return most;
}

uint32_t Memory::memoryType(uint32_t allowed, Place place) const {
    constexpr VkMemoryPropertyFlags kMapped =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    const VkMemoryPropertyFlags wishes[2][2] = {
        {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0},
        {kMapped | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, kMapped},
    };
    for (VkMemoryPropertyFlags wish : wishes[place == Place::host])
        for (uint32_t i = 0; i < properties_.memoryTypeCount; ++i)
            if ((allowed >> i & 1u) && (properties_.memoryTypes[i].propertyFlags & wish) == wish) return i;
    throw Error("no memory type fits a request");
}

Memory::Block& Memory::addBlock(Pool& pool, uint32_t type, VkDeviceSize size) {
    VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    info.allocationSize = size;
    info.memoryTypeIndex = type;
    Block block;
    block.size = size;
    VkResult allocated = vkAllocateMemory(device_, &info, nullptr, &block.memory);
    if (allocated != VK_SUCCESS && kept_ > 0) {
        dropKept();
        allocated = vkAllocateMemory(device_, &info, nullptr, &block.memory);
    }
    check(allocated, "vkAllocateMemory");
    const VkMemoryPropertyFlags flags = properties_.memoryTypes[type].propertyFlags;
    if ((flags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) && (flags & VK_MEMORY_PROPERTY_HOST_COHERENT_BIT)) {
        void* mapped = nullptr;
        const VkResult result = vkMapMemory(device_, block.memory, 0, VK_WHOLE_SIZE, 0, &mapped);
        if (result != VK_SUCCESS) vkFreeMemory(device_, block.memory, nullptr);
        check(result, "vkMapMemory");
        block.mapped = static_cast<char*>(mapped);
    }
    block.free.emplace(0, size);
    reserved_ += size;
    pool.push_back(std::move(block));
    return pool.back();
}

Allocation Memory::allocate(const VkMemoryRequirements& need, Place place, bool image) {
    const uint32_t type = memoryType(need.memoryTypeBits, place),
                   key = type + (image ? VK_MAX_MEMORY_TYPES : 0);
    Pool& pool = pools_[key];
    // Offsets stay aligned for everything when sizes are rounded up to the alignment of this request.
    const VkDeviceSize size = alignUp(need.size, need.alignment);
    auto take = [&](Block& block) -> std::optional<VkDeviceSize> {
        for (auto it = block.free.begin(); it != block.free.end(); ++it) {
            const VkDeviceSize start = alignUp(it->first, need.alignment), end = it->first + it->second;
            if (start + size > end) continue;
            const VkDeviceSize head = it->first;
            block.free.erase(it);
            if (start > head) block.free.emplace(head, start - head);
            if (start + size < end) block.free.emplace(start + size, end - start - size);
            return start;
        }
        return std::nullopt;
    };
    auto made = [&](Block& block, VkDeviceSize offset) {
        inUse_ += size;
        peak_ = std::max(peak_, inUse_);
        const bool seen = block.mapped && (mapsOwn_ || place == Place::host);
        return Allocation{block.memory, offset, size, seen ? block.mapped + offset : nullptr, key};
    };
    const bool common = size <= kBlockSize / 2;
    for (Block& block : pool) {
        if (common ? block.size != kBlockSize
                   : !block.kept || block.size < size || block.size > size + size / 4)
            continue;
        if (const auto offset = take(block)) {
            if (block.kept) kept_ -= block.size;
            block.kept = false;
            return made(block, *offset);
        }
    }
    Block& block = addBlock(pool, type, common ? kBlockSize : size);
    return made(block, *take(block));
}

void Memory::free(const Allocation& allocation) {
    Pool& pool = pools_.at(allocation.pool);
    const auto block =
        std::find_if(pool.begin(), pool.end(), [&](const Block& b) { return b.memory == allocation.memory; });
    assert(block != pool.end());
    inUse_ -= allocation.size;
    VkDeviceSize start = allocation.offset, end = start + allocation.size;
    auto next = block->free.lower_bound(start);
    if (next != block->free.begin()) {
        const auto before = std::prev(next);
        if (before->first + before->second == start) {
            start = before->first;
            block->free.erase(before);
        }
    }
    if (next != block->free.end() && next->first == end) {
        end += next->second;
        block->free.erase(next);
    }
    block->free.emplace(start, end - start);
    if (end - start < block->size) return;
    if (!keeps_ && block->size == kBlockSize) { // of the common ones, the last stays for the next request
        const auto common =
            std::count_if(pool.begin(), pool.end(), [](const Block& b) { return b.size == kBlockSize; });
        if (common > 1) drop(pool, block);
        return;
    }
    if (!keeps_ || block->size > mostKept()) return drop(pool, block);
    if (kept_ + block->size > mostKept()) dropKept();
    block->kept = true;
    kept_ += block->size;
}

void Memory::drop(Pool& pool, Pool::iterator block) {
    vkFreeMemory(device_, block->memory, nullptr);
    reserved_ -= block->size;
    pool.erase(block);
}

void Memory::dropKept() {
    for (auto& [key, pool] : pools_)
        for (auto block = pool.begin(); block != pool.end();) {
            const auto next = std::next(block);
            if (block->kept) drop(pool, block);
            block = next;
        }
    kept_ = 0;
}

VkDeviceSize Memory::mostKept() const {
    return std::max(kLeastKept, largestHeap() / 8); // matrices of large scenes, which one heap holds a few of
}

size_t Memory::blockCount() const {
    size_t count = 0;
    for (const auto& [key, pool] : pools_) count += pool.size();
    return count;
}

} // namespace heliodon::gpu
