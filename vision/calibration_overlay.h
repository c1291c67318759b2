// Calibration pictures with what was found in them, as figure 10 of the paper has it.
#pragma once

#include <filesystem>
#include <span>

#include <glm/vec2.hpp>

#include "vision/photograph.h"

namespace heliodon::vision {

struct OverlayPoints {
    std::span<const glm::dvec2> found;    // yellow crosses
    std::span<const glm::dvec2> rejected; // red ones
    std::span<const glm::dvec2> anchors;  // rings: the disks
};

// Throws InputError or std::runtime_error when the file cannot be written.
void drawCalibrationOverlay(const Photograph& photo, const OverlayPoints& points,
                            const std::filesystem::path& png);

} // namespace heliodon::vision
