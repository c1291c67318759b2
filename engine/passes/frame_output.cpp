#include "engine/passes/frame_output.h"

#include <algorithm>
#include <utility>

#include <glm/vec4.hpp>

namespace heliodon::passes {

namespace {

// Per pixel of a projector's picture, as DisplayPass reads it; `leaks` empty: nothing leaks. One for
// previews.
gpu::Buffer warpBuffer(gpu::Device& device, const std::vector<glm::vec2>& warp, const ImageF& leaks,
                       const std::string& name) {
    std::vector<glm::vec4> pixels(std::max<size_t>(warp.size(), 1));
    for (size_t i = 0; i < warp.size(); ++i)
        pixels[i] = {warp[i].x, warp[i].y, leaks.rgb.empty() ? 0.0f : leaks.rgb[3 * i], 0};
    return gpu::Buffer::from(device, pixels, name + " warp");
}

// Calls `copy(pixel index)` for every pixel that the view shows; the others stay zero.
template<class F> void forShown(const View& view, F copy) {
    for (int y = view.shown.y; y < view.shown.y + view.shown.height; ++y)
        for (int x = view.shown.x; x < view.shown.x + view.shown.width; ++x)
            copy(static_cast<size_t>(y) * static_cast<size_t>(view.outputWidth) + static_cast<size_t>(x));
}

size_t pixelCount(const View& view) {
    return static_cast<size_t>(view.outputWidth) * static_cast<size_t>(view.outputHeight);
}

} // namespace

FrameOutput::FrameOutput(gpu::Device& device, View v, const std::vector<uint32_t>& drawn,
                         const std::string& name_)
    : view(std::move(v)), name(name_), scene(device, view.width, view.height, name),
      warp(warpBuffer(device, view.warp, {}, name)),
      corners(gpu::Buffer::from(device, drawn, name + " triangles")),
      cornerCount(static_cast<uint32_t>(drawn.size())) {}

const DisplayTarget& FrameOutput::target(gpu::Device& device, DisplayTarget::Kind kind) {
    std::optional<DisplayTarget>& there = kind == DisplayTarget::Kind::float32 ? linear : display;
    if (!there || there->kind != kind) there.emplace(device, view.outputWidth, view.outputHeight, kind, name);
    return *there;
}

Image8 FrameOutput::bytes() const {
    Image8 picture{view.outputWidth, view.outputHeight, {}};
    picture.rgb.resize(3 * pixelCount(view));
    const uint8_t* from = display->pixels.mapped<uint8_t>();
    uint8_t* to = picture.rgb.data();
    forShown(view, [&](size_t i) {
        for (size_t c = 0; c < 3; ++c) to[3 * i + c] = from[4 * i + 2 - c];
    });
    return picture;
}

ImageF FrameOutput::floats() const {
    ImageF picture{view.outputWidth, view.outputHeight, {}};
    picture.rgb.resize(3 * pixelCount(view));
    const float* from = linear->pixels.mapped<float>();
    float* to = picture.rgb.data();
    forShown(view, [&](size_t i) {
        for (size_t c = 0; c < 3; ++c) to[3 * i + c] = from[4 * i + c];
    });
    return picture;
}

void FrameOutput::setLeaks(gpu::Device& device, const ImageF& leaks) {
    warp = warpBuffer(device, view.warp, leaks, name);
    linear.reset(); // large, and seldom asked for after this
}

} // namespace heliodon::passes
