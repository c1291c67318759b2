// Light to pictures on disk, for single moments and for frames of a time-lapse.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/app/arguments.h"
#include "engine/app/run.h"
#include "engine/app/scene_input.h"
#include "engine/passes/frame_renderer.h"

namespace heliodon::app {

// On the run's device, or on another one.
passes::FrameRenderer makeRenderer(Run& run, const Scene& scene, gpu::Device* device = nullptr);

// `tone` as the arguments want it: their exposure, and false colour in place of its map.
passes::Tone toned(passes::Tone tone, const PictureArguments& arguments, bool falseColour);

// Makes the folder when it is missing; throws InputError when it is a file or cannot be made or written to.
void prepareFolder(const std::filesystem::path& folder);

} // namespace heliodon::app
