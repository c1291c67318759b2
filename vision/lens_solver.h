// Lens and poses from points seen: the maximum-likelihood step of Zhang's method, and of Tsai's when there is
// one view of points that do not lie in a plane. Levenberg-Marquardt of OpenCV's calibrateCamera.
#pragma once

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

// `start` may be null when every view is plane (all z = 0); otherwise its lens is where the search begins.
// Throws CalibrationError.
LensSolution solveLens(const std::vector<Correspondences>& views, int width, int height, LensTerms terms,
                       const LensSolution* start);

// The pose that fits this lens best, from `start`.
Pose solvePose(const Correspondences& view, const geometry::Lens& lens, const Pose& start);

// Distance in the picture of each point from where it should be, px; behind the device: infinite.
std::vector<double> residuals(const Correspondences& view, const geometry::Lens& lens, const Pose& pose);

double rmsOf(const std::vector<double>& residuals);
double medianOf(std::vector<double> values); // 0 of none

// Whether, inside a picture of this size, the distance from the axis stops growing with the angle.
bool foldsInPicture(const geometry::Lens& lens, int width, int height);

} // namespace heliodon::vision
