// The calibration board in a photograph (section 4.4 of the paper): coloured disks give a first map from
// board to picture, and the marks are walked from the disks inwards, each looked for where its neighbours
// say that it must be. So lens distortion, other marks and hands before the board do not mislead it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "vision/calibration_target.h"
#include "vision/photograph.h"

namespace heliodon::vision {

struct FoundMark {
    size_t id = 0; // in CalibrationTarget::marks
    glm::dvec2 pixel{};
};

struct FoundTarget {
    std::vector<FoundMark> marks;                   // by id; empty: no board
    std::array<std::optional<glm::dvec2>, 4> disks; // those used: centres of their coloured areas
    std::string problem;                            // why there are no marks, for the user
};

// The photograph must be in colour and show three of the disks whole; marks may be hidden. A mirrored board
// is none, which `problem` says. About 0.1 s for 1392 x 1032, twice that without a board.
FoundTarget findTarget(const Photograph& photo, const CalibrationTarget& target);

// A round area of one of the target's colours on white.
struct DiskCandidate {
    glm::dvec2 centre{};
    double radius = 0; // of the circle of the same area, pixels
    double misfit = 0; // hue and shape against what is expected, 0 is perfect
};

// Candidates for each disk of the target, best first. `saturation`: of (max - min) / max against the white
// about it, where paint begins.
std::array<std::vector<DiskCandidate>, 4> findDisks(const Photograph& photo, const CalibrationTarget& target,
                                                    double saturation);

} // namespace heliodon::vision
