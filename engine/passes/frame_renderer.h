// Light on a mesh -> pictures: one per projector of the rig, and a preview from above at an angle.
// What depends on geometry alone is prepared once; a frame uploads light, records draws and reads pixels
// back. What a frame does not need is not drawn: no sun, no shadow volumes and no sun pass.
//
// A projector's picture makes the *physical* white surface show the simulated exitance times an exposure:
//   drive = exposure * share * B r^2 / (rho cos theta) / fullIntensity,   within 0..1,
// with B the simulated exitance (lux) within `white` (brighter in a channel: of the same luminance and hue,
// as far as white has them, and less saturated; so is a drive beyond 1), equally bright however many
// projectors share it; share the projector's part of the picture there (shares sum to one, so the projectors
// together show exposure * B wherever none is clipped) and rho the physical surface's reflectance. exposure =
// reachLux() / white: what is `white` in the simulation is shown at the exitance that the rig reaches on nine
// tenths of what it shows. What all projectors that see a place leak while black is taken off, by the same
// shares, as far as there is light. Where `light.ownScatter` is given, B is what is left without it, and not
// negative.
#pragma once

#include <memory>
#include <vector>

#include "compute/lighting.h"
#include "engine/passes/frame_scene.h"
#include "engine/passes/picture.h"
#include "engine/passes/tone.h"
#include "engine/passes/view.h"
#include "geometry/patch_mesh.h"
#include "geometry/rig.h"

namespace heliodon::gpu {
class Device;
class Image;
} // namespace heliodon::gpu

namespace heliodon::passes {

struct PreviewOptions {
    int width = 1280, height = 960;
    double azimuthDegrees = 25, elevationDegrees = 52; // of the eye: 0 from +z (the user), 90 from +x
    double fovDegrees = 28;
    int supersample = 2; // subpixels in each direction
    Tone tone{ToneMap::soft};
};

struct ProjectorOptions {
    int supersample = kProjectorSupersample;
    Tone tone;
};

struct ProjectorPictures {
    std::vector<Image8> bytes;
    std::vector<ImageF> floats;
};

class FrameRenderer {
public:
    // `rig` may be null: then there are previews only. The device outlives the renderer; the rest is copied.
    FrameRenderer(gpu::Device& device, const geometry::PatchMesh& mesh, const geometry::Occluders& occluders,
                  const geometry::Rig* rig, const FrameRendererOptions& options = {});
    FrameRenderer(gpu::Device& device, FrameScene scene);
    FrameRenderer(FrameRenderer&&) noexcept;
    FrameRenderer& operator=(FrameRenderer&&) noexcept;
    ~FrameRenderer();

    // Another geometry in place of the one before: pipelines stay. Cost: uploads.
    void replace(FrameScene scene);
    // FrameScene::leaveOut of the geometry at hand. Cost: that of `replace`.
    void leaveOut(const std::vector<bool>& projectors);

    const FrameScene& scene() const;
    // Those of frame_light.h.
    double autoWhite(const compute::Lighting& light) const;
    std::vector<float> shownLux(const compute::Lighting& light) const;
    // Physical exitance of white, lux; 1000 without a rig. Exposure = reachLux() / white.
    double reachLux() const;

    // A false-colour legend takes columns at the right: it hides nothing. Glazing is grey, as no lux are
    // known there.
    Image8 preview(const compute::Lighting& light, const PreviewOptions& options = {});
    // One picture per projector, in the rig's order, each for its own panel and response.
    std::vector<Image8> projectors(const compute::Lighting& light, const ProjectorOptions& options = {});

    // Draws those pictures and leaves them on the device, in TRANSFER_SRC_OPTIMAL, coded as the panels want
    // them (BGRA8 sRGB, or UNORM where the response is a gamma), until the next call of any member.
    // Submitted, not waited for: what is submitted after it on the same device comes after it.
    std::vector<const gpu::Image*> drawProjectors(const compute::Lighting& light,
                                                  const ProjectorOptions& options = {});

    // The same in floats. A preview holds exitance in lux (zero where nothing is simulated); a projector's
    // picture holds its drive, linear, 1 = full, not clipped.
    ImageF previewHdr(const compute::Lighting& light, const PreviewOptions& options = {});
    std::vector<ImageF> projectorsHdr(const compute::Lighting& light, const ProjectorOptions& options = {});

    // projectors() and projectorsHdr(), of one drawing of the scene where that will do.
    ProjectorPictures projectorsBoth(const compute::Lighting& light, const ProjectorOptions& options = {});

    // Exitance (lux) seen by any view through a pinhole or a lens; nothing but simulated patches is drawn.
    ImageF exitance(const compute::Lighting& light, const View& view);

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace heliodon::passes
