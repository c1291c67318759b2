// What decides the pictures of a time-lapse, kept beside them as frames.json: only frames of the same job may
// be taken over by a later run.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/app/arguments.h"
#include "engine/app/run.h"
#include "engine/app/scene_input.h"

namespace heliodon::app {

struct FrameJob {
    nlohmann::ordered_json options; // by name as on the command line; files by a hash of what is in them
    std::vector<std::string> views;
    size_t frames = 0;
};

// Reads the files that the arguments name, and asks the run for its device.
FrameJob frameJobOf(Run& run, const TimelapseArguments& arguments, const Scene& scene,
                    std::vector<std::string> views, size_t frames);

// The first option in which they differ, with both values where they can be read: "--step is PT15M there and
// PT30M here". None: the same frames.
std::optional<std::string> difference(const FrameJob& there, const FrameJob& here);

// None where there is no such file, or nothing that can be read in it.
std::optional<FrameJob> readFrameJob(const std::filesystem::path& file);
void writeFrameJob(const FrameJob& job, const std::filesystem::path& file);

} // namespace heliodon::app
