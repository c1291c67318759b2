// The names on the picture of what was found on the table, each beside its outline.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/app/label_places.h"
#include "geometry/rig.h"
#include "geometry/sketch.h"
#include "vision/detect.h"

namespace heliodon::app {

// A box of the size given for each tag, as near to its outline as it goes without covering an outline,
// another box or the picture's rim; where nothing is free, where it covers least. `sizes`: pixels, one a tag.
std::vector<Box> placeTags(int width, int height, std::span<const vision::OverlayTag> tags,
                           std::span<const glm::dvec2> sizes);

// vision::drawOverlay with its tags lettered, as PNG; written whole or not at all.
void writeOverlay(const vision::Photograph& photo, const geometry::Rig& rig, const geometry::Sketch& sketch,
                  const std::filesystem::path& png, std::span<const std::array<glm::dvec3, 3>> dark = {});

} // namespace heliodon::app
