// Draws a lit scene into a linear high-range picture: light interpolated between vertices, plus the sun per
// pixel where the stencil counts no shadow volume. And, once for a geometry, what a projector has to make of
// that light at each pixel.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "compute/gpu/buffer.h"
#include "compute/gpu/commands.h"
#include "compute/gpu/graphics_pipeline.h"
#include "compute/gpu/image.h"
#include "engine/passes/device_blend.h"
#include "engine/passes/view.h"

namespace heliodon::passes {

// Attachments of one view.
struct SceneTarget {
    static constexpr uint64_t kColourBytes = 16, kDepthBytes = 8; // a pixel

    SceneTarget(gpu::Device& device, int width, int height, const std::string& name);
    gpu::Image colour, depth;
};

// Lit surfaces: streams of shaders/scene.vert.
struct SurfaceStreams {
    const gpu::Buffer* corners = nullptr; // DrawCorner
    const gpu::Buffer* light = nullptr;   // vec3, kilolux
};

// Those of their corners that are drawn, three a triangle.
struct Triangles {
    const gpu::Buffer* corners = nullptr; // uint32
    uint32_t count = 0;
};

// Light that varies within patches, added to the surfaces that it is on.
struct GlowDraw {
    SurfaceStreams surfaces;            // those with any; light: place on the triangle, number of its grid
    uint32_t count = 0;                 // of their corners
    const gpu::Buffer* grids = nullptr; // vec3, kilolux: shaders/glow.frag
};

// Geometry in one flat colour. Alpha is what the scene picture's alpha becomes (see shaders/display.frag).
struct SolidDraw {
    const gpu::Buffer* corners = nullptr; // DrawCorner
    uint32_t count = 0;
    glm::vec4 colour{0};
    float shading = 0;  // 0: plain
    float pushBack = 0; // metres
    // Blended once a pixel, by alpha, over the room and what of these was drawn before; hides what lies
    // behind it of itself and of those drawn later.
    bool seeThrough = false;
};

struct SunDraw {
    Triangles triangles; // that it may reach
    glm::dvec3 towardsSun{0};
    glm::vec3 kilolux{0};                   // on a plane facing it
    const gpu::Buffer* volumes = nullptr;   // vec4
    uint32_t volumeCount = 0, capCount = 0; // corners; caps come first
    const gpu::Buffer* panes = nullptr;     // io::SunPaneHeader, io::SunPane[]
    const gpu::Buffer* paneEdges = nullptr; // vec4
};

struct SceneInputs {
    const View* view = nullptr;
    SurfaceStreams surfaces;
    Triangles triangles;
    std::optional<GlowDraw> glow;
    std::vector<SolidDraw> solids; // see-through ones last
    glm::vec4 background{0};       // where nothing is drawn; what is seen through is blended over it, too
    std::optional<SunDraw> sun;    // none: neither volumes nor the sun pass are recorded
    std::vector<PixelRect>
        sunlit; // of the scene picture: where its triangles are; volumes are of no use elsewhere
    // Alpha stays what recordGain made it, and so do the colours where there is no surface; `background` and
    // `solids` are of no use then.
    bool keepGain = false;
};

struct GainInputs {
    const View* view = nullptr;
    const gpu::Buffer* corners = nullptr; // DrawCorner
    uint32_t count = 0;
    SolidDraw solids; // hide what is behind them; show nothing
    const DeviceBlend* blend = nullptr;
    io::GainParams params{}; // but for clipFromWorld, which is the view's
};

class ScenePass {
public:
    explicit ScenePass(gpu::Device& device);

    // Leaves target.colour readable by fragment shaders.
    void record(gpu::Commands& commands, const SceneTarget& target, const SceneInputs& inputs) const;

    // A projector's gain (shaders/gain.frag), zero where it shows nothing, into the alpha of target.colour,
    // for all frames with `keepGain` that follow. The colours are what all projectors leak, lux.
    void recordGain(gpu::Commands& commands, const SceneTarget& target, const GainInputs& inputs) const;

private:
    gpu::GraphicsPipeline ambient_, ambientKeepingGain_, volumeCaps_, volumeSides_, sun_, glow_, solid_,
        background_, front_, seeThrough_, gain_;
};

} // namespace heliodon::passes
