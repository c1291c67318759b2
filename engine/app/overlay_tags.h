// The names on the picture of what was found on the table, each beside its outline.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/rig.h"
#include "geometry/sketch.h"
#include "vision/detect.h"

namespace heliodon::app {

// vision::drawOverlay with its tags lettered, as PNG; written whole or not at all.
void writeOverlay(const vision::Photograph& photo, const geometry::Rig& rig, const geometry::Sketch& sketch,
                  const std::filesystem::path& png, std::span<const std::array<glm::dvec3, 3>> dark = {});

} // namespace heliodon::app
