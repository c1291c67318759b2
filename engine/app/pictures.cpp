#include "engine/app/pictures.h"

#include <algorithm>

#include <fmt/format.h>

#include "engine/app/pixel_size.h"
#include "engine/passes/false_colour.h"
#include "engine/passes/scene_pass.h"
#include "geometry/input_error.h"

namespace heliodon::app {

passes::FrameRenderer makeRenderer(Run& run, const Scene& scene, gpu::Device* other) {
    gpu::Device& device = other ? *other : run.device();
    const StageTimer timer(run, "prepare");
    return passes::FrameRenderer(device, scene.mesh, scene.occluders, scene.rig ? &*scene.rig : nullptr);
}

passes::Tone toned(passes::Tone tone, const PictureArguments& arguments, bool falseColour) {
    if (falseColour) tone.map = passes::ToneMap::falseColour;
    tone.whiteLux = arguments.exposure;
    return tone;
}

passes::PreviewOptions sized(passes::PreviewOptions options, const PictureArguments& arguments) {
    if (arguments.size.empty()) return options;
    constexpr int kMost = 8192; // twice as many are drawn along each edge
    const PixelSize size = parseSize("--size", arguments.size, kMost);
    options.width = size.width, options.height = size.height;
    return options;
}

void checkSize(Run& run, const PictureArguments& arguments) {
    if (arguments.size.empty()) return;
    const passes::PreviewOptions options = sized({}, arguments);
    gpu::Device& device = run.device();
    const int most = static_cast<int>(device.limits().maxImageDimension2D) / options.supersample;
    if (options.width > most || options.height > most)
        throw geometry::InputError(
            "--size", arguments.size,
            fmt::format("{} draws at most {} pixels along an edge", device.info().name, most));
    const uint64_t pixels = uint64_t(options.width) * uint64_t(options.height) *
                            uint64_t(options.supersample) * uint64_t(options.supersample);
    using Target = passes::SceneTarget;
    const gpu::Memory& memory = device.memory();
    if (pixels * Target::kColourBytes > memory.largestPiece() ||
        pixels * (Target::kColourBytes + Target::kDepthBytes) > memory.largestHeap())
        throw geometry::InputError(
            "--size", arguments.size,
            fmt::format("is drawn with {} million subpixels, for which {} has no memory", pixels / 1'000'000,
                        device.info().name));
}

void settle(passes::Tone& tone, const passes::FrameRenderer& renderer,
            std::span<const compute::Moment> moments) {
    if (!tone.whiteLux) {
        double white = 0;
        for (const compute::Moment& moment : moments)
            white = std::max(white, renderer.autoWhite(moment.lighting));
        tone.whiteLux = white;
    }
    if (tone.map != passes::ToneMap::falseColour) return;
    std::vector<float> lux;
    for (const compute::Moment& moment : moments) {
        const std::vector<float> shown = renderer.shownLux(moment.lighting);
        lux.insert(lux.end(), shown.begin(), shown.end());
    }
    const passes::FalseScale scale = passes::falseScale(tone, lux);
    constexpr double kMost = 10'000; // darker moments would flatten the others
    if (!tone.lowLux) tone.lowLux = std::max(scale.lowLux, scale.highLux / kMost);
    if (!tone.highLux) tone.highLux = scale.highLux;
}

nlohmann::json scatterEntry(const passes::ScatterReport& scatter, double surfaceReflectance) {
    return {{"surface_reflectance", surfaceReflectance},
            {"own_share", scatter.ownShare},
            {"error", scatter.error},
            {"too_bright_share", scatter.tooBright},
            {"passes", scatter.passes}};
}

} // namespace heliodon::app
