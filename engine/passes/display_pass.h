// Scene picture -> display picture: lens, average of subpixels, tone, the projector's drive. 8-bit pictures
// are written through an sRGB attachment unless the display has a gamma of its own.
#pragma once

#include <map>
#include <string>
#include <tuple>

#include "compute/gpu/buffer.h"
#include "compute/gpu/commands.h"
#include "compute/gpu/graphics_pipeline.h"
#include "compute/gpu/image.h"
#include "engine/passes/view.h"
#include "shaders/io/display.io.h"

namespace heliodon::passes {

struct DisplayTarget {
    enum class Kind { srgb8, unorm8, float32 };
    DisplayTarget(gpu::Device& device, int width, int height, Kind kind, const std::string& name);
    Kind kind;
    gpu::Image picture; // TRANSFER_SRC_OPTIMAL between frames, black where nothing is shown
    gpu::Buffer pixels; // host; four channels a pixel, bytes blue first; valid within View::shown
};

class DisplayPass {
public:
    explicit DisplayPass(gpu::Device& device);
    DisplayPass(const DisplayPass&) = delete;
    DisplayPass& operator=(const DisplayPass&) = delete;
    ~DisplayPass();

    // `scene` is readable by fragment shaders; `warp` holds a vec4 per pixel of a projector's picture:
    // View::warp, and the drive that is taken off for what leaks there (any buffer when View::warp is empty:
    // a preview). Leaves the picture in TRANSFER_SRC_OPTIMAL and, with `readBack`, a copy in target.pixels
    // for the host. `tone` is one of the constants of display.io.h.
    void record(gpu::Commands& commands, const gpu::Image& scene, const gpu::Buffer& warp, const View& view,
                const DisplayTarget& target, uint32_t tone, const io::DisplayParams& params,
                bool readBack = true);

private:
    using Key =
        std::tuple<VkFormat, uint32_t, bool, int, bool>; // format, tone, projector, supersample, gamma
    const gpu::GraphicsPipeline& pipeline(const Key& key);

    gpu::Device* device_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    std::map<Key, gpu::GraphicsPipeline> pipelines_;
};

} // namespace heliodon::passes
