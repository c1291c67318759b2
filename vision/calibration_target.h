// The board that the camera is calibrated with: isolated corner marks, and four coloured disks that say which
// way it lies (J. Mallon and P. F. Whelan, "Which pattern?" 2007: isolated saddle corners are not biased by
// perspective or lens). Board frame: metres, origin at its centre, x right and y down as printed, z into the
// board.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace heliodon::vision {

// A mark is two black squares that touch at the mark's point: one spans [0, square]^2, the other
// [-square, 0]^2.
struct CalibrationTarget {
    double board = 1.016; // edge of the board, 40 in
    double square = 0.02;
    double pitch = 0.066; // between marks, 15 to a side
    double diskRadius = 0.028;
    std::vector<glm::dvec2> marks; // 212: the grid less its middle and three at each corner, row by row
    std::vector<glm::dvec2> gaps;  // the 13 places of the grid that have none
    struct Disk {
        glm::dvec2 at;
        double hueDegrees;
        glm::dvec3 srgb; // ink
    };
    std::array<Disk, 4> disks; // red, green, blue, yellow: clockwise as printed, from the upper left
};

// The target in its usual size, or another with all of its lengths scaled (`boardEdge` metres, above 0).
CalibrationTarget makeTarget(double boardEdge = 1.016);

// The target to print in true size: a page of the board's size, vectors only. By the file's extension .svg or
// .pdf; throws InputError for another one.
void writeTarget(const CalibrationTarget& target, const std::filesystem::path& file);

} // namespace heliodon::vision
