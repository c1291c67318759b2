// Lens and poses from points seen, by least squares in the picture: of plane boards in many poses, as in
// Zhang's method, or of one view of points in space, as in Tsai's.
#pragma once

#include <span>
#include <stdexcept>
#include <vector>

#include "geometry/rig.h"

namespace heliodon::vision {

struct Correspondence {
    glm::dvec3 at{}; // metres, in the frame of its view
    glm::dvec2 pixel{};
};
using Correspondences = std::vector<Correspondence>;

// Which terms of the lens are fitted; the others are 0. Focal lengths and the principal point always are,
// skew never.
struct LensTerms {
    bool radial1 = true, radial2 = true, radial3 = false, tangential = true;
};

struct Pose {
    glm::dmat3 rotation{1}; // device from the view's frame
    glm::dvec3 translation{};
};

// The lens and how sure it is: one standard deviation of each number, 0 for what was held fixed.
struct LensFit {
    geometry::Lens lens, sigma;
};

struct LensSolution {
    LensFit fit;
    std::vector<Pose> poses; // one a view
    double squares = 0;      // of the residuals, px2
    size_t points = 0;
    double rms() const; // px, of the distance in the picture
};

struct CalibrationError : std::runtime_error { // the data do not determine the lens
    using std::runtime_error::runtime_error;
};

// Plane views (all z = 0), by OpenCV's calibrateCamera. The search begins at the lens of `start` unless that
// is null. Throws CalibrationError.
LensSolution solveLens(const std::vector<Correspondences>& views, int width, int height, LensTerms terms,
                       const LensSolution* start);

// One view of points that do not lie in a plane, from `start`, by Levenberg-Marquardt; the principal point
// may lie anywhere. Throws CalibrationError. About 0.1 s for 5000 points. (OpenCV's needs time and memory
// with the square of a view's points, and a principal point inside the picture.)
LensSolution solveView(const Correspondences& view, LensTerms terms, const LensSolution& start);

// Lens without distortion and pose from one view of points that do not lie in a plane: the direct linear
// transformation (Y. I. Abdel-Aziz and H. M. Karara, 1971), a start for solveView. Throws CalibrationError.
LensSolution solvePinhole(const Correspondences& view);

// The pose that fits this lens best, from `start`.
Pose solvePose(const Correspondences& view, const geometry::Lens& lens, const Pose& start);

// Distance in the picture of each point from where it should be, px; behind the device: infinite.
std::vector<double> residuals(const Correspondences& view, const geometry::Lens& lens, const Pose& pose);

double rmsOf(const std::vector<double>& residuals);

// Share of the picture, in 8 x 6 fields, in which there are points of any view.
double coverageOf(std::span<const Correspondences> views, int width, int height);

// Raises deviations to how much the numbers change when one part of the data is left out: errors within a
// part are not independent, which a fit's own deviations assume. The jackknife (B. Efron, "The jackknife, the
// bootstrap and other resampling plans", 1982); `without`: the lens without each part in turn.
void widenByJackknife(geometry::Lens& sigma, const std::vector<geometry::Lens>& without);

// Whether, inside a picture of this size, the distance from the axis stops growing with the angle.
bool foldsInPicture(const geometry::Lens& lens, int width, int height);

} // namespace heliodon::vision
