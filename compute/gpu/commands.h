// One command buffer being recorded. Barriers within it are written by whoever sequences kernels, each naming
// producer and consumer. None is needed at its end: later submissions see all that it wrote, and so does the
// host once it has waited for it.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <type_traits>

#include <vulkan/vulkan.h>

namespace heliodon::gpu {

struct Binding;
class Buffer;
class Device;
class Image;
class Kernel;

// Who writes or reads on either side of a barrier.
enum class Stage { compute, transfer, fragment, colour, depth, any };

class Commands {
public:
    explicit Commands(Device& device);
    Commands(Commands&& other) noexcept;
    Commands& operator=(Commands&&) = delete;
    ~Commands(); // recording that was never submitted is dropped

    VkCommandBuffer handle() const { return buffer_; }
    Device& device() const { return *device_; }

    // Resources follow the order of the shader's binding numbers; `params` is its push-constant block. No
    // groups along an axis: nothing is recorded. Throws Error, with the shader's name or the binding's, where
    // the device allows no such dispatch or a resource does not fit.
    template<class Params>
    void dispatch(const Kernel& kernel, std::initializer_list<Binding> resources, const Params& params,
                  uint32_t groupsX, uint32_t groupsY = 1, uint32_t groupsZ = 1) {
        static_assert(std::is_trivially_copyable_v<Params> && sizeof(Params) <= 128);
        dispatchBytes(kernel, {resources.begin(), resources.size()}, &params, sizeof(Params),
                      {groupsX, groupsY, groupsZ});
    }
    void dispatchBytes(const Kernel& kernel, std::span<const Binding> resources, const void* params,
                       size_t paramBytes, std::array<uint32_t, 3> groups);

    // Everything that `from` wrote is visible to `to`, for all buffers.
    void barrier(Stage from, Stage to);
    // Moves all layers of an image to `layout`; `from` UNDEFINED discards the content.
    void transition(const Image& image, VkImageLayout from, VkImageLayout to, Stage before, Stage after);

    // Ranges lie within their buffers and do not overlap; zero bytes are allowed.
    void copy(const Buffer& from, size_t fromOffset, const Buffer& to, size_t toOffset, size_t bytes);
    // Rows of `rowBytes`, `fromStride` and `toStride` bytes apart.
    void copyRows(const Buffer& from, size_t fromStride, const Buffer& to, size_t toOffset, size_t toStride,
                  size_t rowBytes, size_t rows);
    // `offset` and `bytes` in whole words; from `offset` to the end where no count is given.
    void fill(const Buffer& buffer, uint32_t word, size_t offset = 0, size_t bytes = VK_WHOLE_SIZE);

private:
    friend class Device;
    struct Scope;

    static Scope scopeOf(Stage stage);
    void barrier(const Scope& source, const Scope& target);
    void close(); // ends the recording

    Device* device_;
    VkCommandBuffer buffer_ = VK_NULL_HANDLE;
};

// ceil(count / groupSize)
constexpr uint32_t groupsFor(size_t count, uint32_t groupSize) {
    return static_cast<uint32_t>((count + groupSize - 1) / groupSize);
}

} // namespace heliodon::gpu
