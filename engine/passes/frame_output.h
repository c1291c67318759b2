// A picture that is drawn again and again, a projector's or a preview: its targets on the device and its
// pixels on the host.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "compute/gpu/buffer.h"
#include "engine/passes/display_pass.h"
#include "engine/passes/picture.h"
#include "engine/passes/scene_pass.h"
#include "engine/passes/view.h"

namespace heliodon::passes {

struct FrameOutput {
    // `drawn`: corners of its mesh, three a triangle.
    FrameOutput(gpu::Device& device, View view, const std::vector<uint32_t>& drawn, const std::string& name);

    Triangles triangles() const { return {&corners, cornerCount}; }
    // The target of that kind; one of floats is kept beside the last one of bytes.
    const DisplayTarget& target(gpu::Device& device, DisplayTarget::Kind kind);
    // Of a picture that was read back; black outside View::shown.
    Image8 bytes() const;
    ImageF floats() const;
    // What leaks, a value a pixel in the first channel, as DisplayPass takes it off.
    void setLeaks(gpu::Device& device, const ImageF& leaks);

    View view;
    std::string name;
    SceneTarget scene;
    gpu::Buffer warp, corners;
    uint32_t cornerCount;
    std::optional<DisplayTarget> display, linear; // bytes and floats
};

} // namespace heliodon::passes
