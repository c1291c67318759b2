// Device memory from few large blocks, sub-allocated first-fit. The only file pair that calls
// vkAllocateMemory.
#pragma once

#include <algorithm>
#include <cstdint>
#include <list>
#include <map>
#include <vector>

#include <vulkan/vulkan.h>

namespace heliodon::gpu {

// Where the bytes live. `device`: fastest for kernels; mapped too where the device shares the host's memory
// (software, integrated). `host`: always mapped, cached for reading back.
enum class Place { device, host };

struct Allocation {
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkDeviceSize offset = 0, size = 0;
    void* mapped = nullptr; // start of this allocation, null when the host cannot see it
    uint32_t pool = 0;      // of Memory, to be given back to
};

class Memory {
public:
    static constexpr VkDeviceSize kBlockSize = 64ull << 20, kLeastKept = 1ull << 30;

    // `mapsOwn`: the host sees Place::device, too, where the device's memory is the host's.
    Memory(VkPhysicalDevice physical, VkDevice device, bool mapsOwn = true);
    ~Memory(); // every allocation must have been freed
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;

    // Requests above half a block get a block of their own; on devices with memory of their own, where new
    // ones cost milliseconds, empty blocks wait for the next request of their size, up to mostKept() bytes of
    // them in all.
    // Buffers and optimally tiled images never share a block, so bufferImageGranularity does not matter.
    // Throws Error when the device has no room.
    Allocation allocate(const VkMemoryRequirements& need, Place place, bool image);
    void free(const Allocation& allocation);

    // Most that Place::device can hold, of which others may have taken some, and most of it in one piece.
    VkDeviceSize largestHeap() const;
    VkDeviceSize largestPiece() const { return std::min(largestPiece_, largestHeap()); }
    VkDeviceSize largestBuffer() const {
        return largestBuffer_;
    } // that may be created, whether there is room or not

    VkDeviceSize bytesInUse() const { return inUse_; }
    VkDeviceSize bytesReserved() const { return reserved_; }
    VkDeviceSize peakBytesInUse() const { return peak_; }
    size_t blockCount() const;
    VkDeviceSize mostKept() const;

private:
    struct Block {
        VkDeviceMemory memory = VK_NULL_HANDLE;
        VkDeviceSize size = 0;
        char* mapped = nullptr;
        bool kept = false;                         // empty, and waits for the next request
        std::map<VkDeviceSize, VkDeviceSize> free; // offset -> size, neighbours merged
    };
    using Pool = std::list<Block>;

    uint32_t memoryType(uint32_t allowed, Place place) const;
    Block& addBlock(Pool& pool, uint32_t type, VkDeviceSize size);
    void drop(Pool& pool, Pool::iterator block);
    void dropKept();

    VkDevice device_;
    bool mapsOwn_, keeps_;
    VkPhysicalDeviceMemoryProperties properties_{};
    VkDeviceSize largestPiece_ = 0, largestBuffer_ = 0;
    std::map<uint32_t, Pool> pools_; // key: memory type, + VK_MAX_MEMORY_TYPES for images
    VkDeviceSize inUse_ = 0, reserved_ = 0, peak_ = 0, kept_ = 0;
};

} // namespace heliodon::gpu
