// The camera's lens and place from photographs of the calibration board (Z. Zhang, "A flexible new technique
// for camera calibration", 2000), with what the figures are worth.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "vision/find_target.h"
#include "vision/lens_solver.h"

namespace heliodon::vision {

struct TargetView {
    std::string name;
    std::vector<FoundMark> marks;
};

constexpr size_t kLeastViews = 3;

struct CalibratedView {
    std::string name;
    size_t marks = 0;                 // used
    std::vector<size_t> rejected;     // ids of marks left out because they lay too far off
    double rms = 0;                   // px
    std::optional<double> heldOutRms; // with the lens from all other views; none of kLeastViews views
    double tiltDegrees = 0;           // between the board's normal and the camera's axis
    bool used = true;                 // false: its marks do not fit those of the other views
    bool turned = false;              // so, but do once the picture is turned by half; not used
    geometry::OpticalDevice camera;   // with the board as the world's table
};

struct CameraCalibration {
    // Its sigma: the larger of what the residuals say and how the lens changes with each view left out.
    LensFit fit;
    double rms = 0;                    // px, over all marks used
    std::optional<double> heldOutRms;  // the same of marks in views held out
    double coverage = 0;               // share of the picture's 8 x 6 fields that hold marks
    std::vector<CalibratedView> views; // as given
    std::vector<std::string> warnings;
};

// `thickness`: metres from the printed side down to the world's y = 0. k3 is fitted only if that lowers the
// residual by more than chance (Akaike). Marks that lie off by more than 4.5 robust deviations are left out,
// and so are views that lie far off as a whole, or in a picture turned by half (of four views or fewer that
// cannot be told). At least kLeastViews views of at least 20 marks
// (precondition). Throws CalibrationError when the views do not determine the lens (all within 5 degrees of
// parallel). About 5 s for 30 views with all marks.
CameraCalibration calibrateCamera(const CalibrationTarget& target, int width, int height,
                                  const std::vector<TargetView>& views, double thickness = 0);

} // namespace heliodon::vision
