#include "vision/calibration_overlay.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "geometry/picture_file.h"

namespace heliodon::vision {
namespace {

constexpr int kShift = 4; // OpenCV draws at 1/16 pixel

cv::Point fixed(glm::dvec2 p) {
    return {static_cast<int>(std::lround(p.x * (1 << kShift))),
            static_cast<int>(std::lround(p.y * (1 << kShift)))};
}

void cross(cv::Mat& picture, glm::dvec2 at, double arm, const cv::Scalar& color) {
    for (const auto& [ink, width] : {std::pair{cv::Scalar(20, 20, 20), 3}, std::pair{color, 1}})
        for (const glm::dvec2 d : {glm::dvec2(arm, arm), glm::dvec2(arm, -arm)})
            cv::line(picture, fixed(at - d), fixed(at + d), ink, width, cv::LINE_AA, kShift);
}

} // namespace

void drawCalibrationOverlay(const Photograph& photo, const OverlayPoints& points,
                            const std::filesystem::path& png) {
    cv::Mat picture =
        cv::Mat(photo.height, photo.width, CV_8UC3, const_cast<uint8_t*>(photo.rgb.data())).clone();
    // Dim pictures as bright as they can be.
    double brightest = 0;
    cv::minMaxLoc(picture.reshape(1), nullptr, &brightest);
    if (brightest > 0) picture.convertTo(picture, -1, 235 / brightest);
    const double arm = std::max(4.0, std::max(photo.width, photo.height) / 250.0);
    for (const glm::dvec2& p : points.anchors)
        cv::circle(picture, fixed(p), static_cast<int>(3 * arm) << kShift, cv::Scalar(255, 0, 255), 2,
                   cv::LINE_AA, kShift);
    for (const glm::dvec2& p : points.found) cross(picture, p, arm, cv::Scalar(255, 235, 0));
    for (const glm::dvec2& p : points.rejected) cross(picture, p, arm, cv::Scalar(255, 40, 30));
    geometry::writePngFile(png, picture.cols, picture.rows, picture.data);
}

} // namespace heliodon::vision
