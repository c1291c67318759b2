#include "vision/photograph.h"

#include <cstring>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "geometry/input_error.h"

namespace heliodon::vision {

Photograph readPhotograph(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored))
        throw geometry::InputError(file.string(), "",
                                   "no such file, expected a photograph (png, jpg or tif)");
    cv::Mat bgr;
    try {
        // The pixels as the sensor has them: the rig was calibrated on those, so no rotation by EXIF.
        bgr = cv::imread(file.string(), cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
    } catch (const cv::Exception&) { // a header that promises more than OpenCV is willing to allocate
        bgr.release();
    }
    if (bgr.empty())
        throw geometry::InputError(file.string(), "",
                                   "not an image that can be read, expected png, jpg or tif");
    Photograph photo{bgr.cols, bgr.rows, {}, file.string()};
    photo.rgb.resize(static_cast<size_t>(bgr.cols) * static_cast<size_t>(bgr.rows) * 3);
    cv::Mat rgb(bgr.rows, bgr.cols, CV_8UC3, photo.rgb.data());
    cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
    return photo;
}

} // namespace heliodon::vision
