// Light to pictures on disk, for single moments and for frames of a time-lapse.
#pragma once

#include <span>

#include "compute/daylight_transport.h"
#include "engine/app/arguments.h"
#include "engine/app/run.h"
#include "engine/app/scene_input.h"
#include "engine/passes/frame_renderer.h"
#include "engine/passes/own_scatter.h"

namespace heliodon::app {

// On the run's device, or on another one.
passes::FrameRenderer makeRenderer(Run& run, const Scene& scene, gpu::Device* device = nullptr);

// Of the size that the arguments ask for, else as `options` have it.
passes::PreviewOptions sized(passes::PreviewOptions options, const PictureArguments& arguments);

// Throws InputError naming --size where it is no size, or the device cannot draw such pictures.
void checkSize(Run& run, const PictureArguments& arguments);

// `tone` as the arguments want it: their exposure, and false colour in place of its map.
passes::Tone toned(passes::Tone tone, const PictureArguments& arguments, bool falseColour);

// What `tone` leaves open, one for all of these moments: white is the brightest that one of them asks for; a
// false-colour scale holds the light of all, the brightest four decades where there are more.
void settle(passes::Tone& tone, const passes::FrameRenderer& renderer,
            std::span<const compute::Moment> moments);

// `scatter` of the report.
nlohmann::json scatterEntry(const passes::ScatterReport& scatter, double surfaceReflectance);

} // namespace heliodon::app
