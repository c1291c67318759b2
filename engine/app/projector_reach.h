// What no projector of the rig reaches, as figures for the report and as triangles for the overlay.
#pragma once

#include <filesystem>

#include "engine/app/run.h"
#include "engine/app/scene_input.h"

namespace heliodon::app {

// Fills `projector_reach` of the report: area and unreachable area in all and per surface, in square feet of
// building; a warning for each projector that reaches nothing. Nothing without a rig that has projectors.
void reportReach(Run& run, const Scene& scene);

// The photograph with what was found in it and, hatched, what no projector reaches.
void drawReachOverlay(const Scene& scene, const std::filesystem::path& photo,
                      const std::filesystem::path& png);

} // namespace heliodon::app
