// A projector's lens and place from corners that it shows on planes of known height, seen by a calibrated
// camera: each corner's pixel on the projector, and where on the plane the camera sees it (R. Y. Tsai, "A
// versatile camera calibration technique", 1987, with nothing assumed of the principal point: projectors
// shift their lens).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/rig.h"
#include "vision/gray_code.h"
#include "vision/lens_solver.h"

namespace heliodon::vision {

struct ProjectorPlane {
    double height = 0; // metres over the table
    std::vector<PatternCorner> corners;
};

struct CalibratedPlane {
    double height = 0;
    std::vector<size_t> rejected;     // of its corners: beside the plane, or off
    size_t corners = 0;               // used
    double rms = 0;                   // projector px
    std::optional<double> heldOutRms; // with the lens from all other planes; none where these are too few
    double meanOff = 0;               // projector px: length of the mean residual, which noise makes small
};

struct ProjectorCalibration {
    geometry::OpticalDevice projector;
    geometry::Lens sigma; // as in CameraCalibration
    glm::dvec3 centreSigma{};
    double rms = 0;                     // projector px
    std::optional<double> heldOutRms;   // over the planes that have it; none where no plane has
    double meanMm = 0, deviationMm = 0; // distance on the planes between corners seen and shown, millimetres
    double coverage = 0;                // share of the projector's 8 x 6 fields that hold corners
    LensTerms terms; // fitted: what H. Akaike's kin, G. Schwarz's criterion (1978), finds worth it
    std::vector<CalibratedPlane> planes; // as given
    std::vector<std::string> warnings;
};

constexpr size_t kLeastPlanes = 2, kLeastCorners = 12; // of a plane

// Planes with fewer than kLeastCorners corners are left out. Corners that do not lie on the plane of most are
// left out first (light that falls beside the board), then those beyond 4.5 robust deviations. The lens gets
// k1, k2, p1 and p2, k3 only as far as they lower the residual by more than chance.
// Throws CalibrationError with fewer than kLeastPlanes planes at different heights, where they do not
// determine the lens, where the corners do not move with the plane's height, where no lens comes within a
// hundredth of the picture's width of the corners, where only one with pixels more than 1.6 times as long as
// wide does, and where they fit once the pictures of all planes, or of one, are turned by half. About 2 s for
// nine planes of 500 corners; where they do not fit, as long again for each plane and once for all.
ProjectorCalibration calibrateProjector(const geometry::OpticalDevice& camera, int width, int height,
                                        const std::vector<ProjectorPlane>& planes);

} // namespace heliodon::vision
