// What no projector of the rig reaches, as figures for the report and as triangles for the overlay.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "engine/app/run.h"
#include "engine/app/scene_input.h"

namespace heliodon::app {

// Fills `projector_reach` of the report: area and unreachable area in all and per surface, in square feet of
// building; a warning for each projector that reaches nothing. Nothing without a rig that has projectors.
void reportReach(Run& run, const Scene& scene);

// Which projectors reach anything, as bits. `visible`: per triangle, those that see it.
uint32_t reachingProjectors(std::span<const uint32_t> visible);

// A warning for each projector of the rig that is not among those `reaching`: one that stands or looks
// elsewhere than its rig says leaves a black picture among good ones.
void warnOfBlack(Run& run, const geometry::Rig& rig, uint32_t reaching);

// The photograph with what was found in it and, hatched, what no projector reaches.
void drawReachOverlay(const Scene& scene, const std::filesystem::path& photo,
                      const std::filesystem::path& png);

} // namespace heliodon::app
