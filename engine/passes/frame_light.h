// One moment of light on a scene, made ready to be drawn: per patch, in lux. No device is needed.
#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "compute/lighting.h"
#include "engine/passes/frame_scene.h"

namespace heliodon::passes {

constexpr double kLeastWhite = 1e-6; // lux; that of a scene without light

// The light, without the direct sun's first bounce, that nineteen twentieths of the shown area stay
// below, lux: what is shown as white unless told otherwise. So a room is readable while its sun patch is
// as bright as the display can. A time-lapse takes one value for all its frames. kLeastWhite or more.
double autoWhite(const geometry::PatchMesh& mesh, const compute::Lighting& light);

// Lux on each patch that projectors show, sun included: what false-colour scales are chosen from.
std::vector<float> shownLux(const geometry::PatchMesh& mesh, const compute::Lighting& light);

// Exitance to draw, per patch: openings, which reflect nothing, are shown as the pale sky behind them; by
// night, with no light in the rooms or that of lamps alone, as they are.
std::vector<glm::vec3> pictureLight(const geometry::PatchMesh& mesh, const compute::Lighting& light);

// Sets the values of openings, per vertex, so far below zero that they count as not known.
void markOpenings(const FrameScene& scene, std::vector<glm::vec3>& perVertex);

} // namespace heliodon::passes
