// Paints the calibration board as a camera of known lens and place sees it.
#pragma once

#include "geometry/rig.h"
#include "vision/calibration_target.h"
#include "vision/lens_solver.h"
#include "vision/photograph.h"

namespace heliodon::vision {

struct BoardLight {
    double exposure = 0.6;          // of white
    glm::dvec3 cast{1, 1, 1};       // of the lamps, per channel
    double blurPx = 0.7, noise = 0; // noise: standard deviation over the square root of the light, white = 1
    double vignetting = 0;          // 1 / (1 + v r2), r = 1 at the corner
    double slope = 0;               // relative change of light from left to right
    unsigned seed = 1;
};

// Board poses as in lens_solver.h: camera = rotation * board + translation. Encoded with gamma 2.2.
Photograph paintBoard(const CalibrationTarget& target, const geometry::Lens& lens, int width, int height,
                      const Pose& pose, const BoardLight& light = {});

// Facing the camera, turned in its plane, then tilted by `tilt` about an axis at `axis` (degrees); the
// board's centre at `at` (metres, camera frame).
Pose boardPose(double tilt, double axis, double spin, glm::dvec3 at);

// Where the camera sees a point of the board.
glm::dvec2 seen(const geometry::Lens& lens, const Pose& pose, glm::dvec2 board);

} // namespace heliodon::vision
