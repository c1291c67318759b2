// What no projector of the rig reaches, as figures for the report and as triangles for the overlay.
#pragma once

#include <array>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/app/run.h"
#include "engine/app/scene_input.h"

namespace heliodon::app {

// Fills `projector_reach` of the report: area and unreachable area in all and per surface, in square feet of
// building. Nothing without a rig that has projectors.
void reportReach(Run& run, const Scene& scene);

// The triangles of projection surfaces, in world metres, that no projector reaches and the camera sees.
std::vector<std::array<glm::dvec3, 3>> unreachableTriangles(const Scene& scene);

// The photograph with what was found in it and, hatched, what no projector reaches.
void drawReachOverlay(const Scene& scene, const std::filesystem::path& photo,
                      const std::filesystem::path& png);

} // namespace heliodon::app
