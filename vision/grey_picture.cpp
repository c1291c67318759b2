#include "vision/grey_picture.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace heliodon::vision {
float GreyPicture::at(glm::dvec2 pixel) const {
    const double x = std::clamp(pixel.x, 0.0, width - 1.0), y = std::clamp(pixel.y, 0.0, height - 1.0);
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const int x1 = std::min(x0 + 1, width - 1), y1 = std::min(y0 + 1, height - 1);
    const float u = static_cast<float>(x - x0), v = static_cast<float>(y - y0);
    const GreyPicture& p = *this;
    return (1 - v) * ((1 - u) * p(x0, y0) + u * p(x1, y0)) + v * ((1 - u) * p(x0, y1) + u * p(x1, y1));
}

bool GreyPicture::holds(glm::dvec2 pixel, double margin) const {
    return pixel.x >= margin && pixel.y >= margin && pixel.x <= width - 1 - margin &&
           pixel.y <= height - 1 - margin;
}

GreyPicture greyOf(const Photograph& photo) {
    const cv::Mat rgb(photo.height, photo.width, CV_8UC3, const_cast<uint8_t*>(photo.rgb.data()));
    GreyPicture out{photo.width, photo.height, std::vector<float>(rgb.total())};
    cv::Mat grey, values(photo.height, photo.width, CV_32FC1, out.values.data());
    cv::cvtColor(rgb, grey, cv::COLOR_RGB2GRAY);
    grey.convertTo(values, CV_32F, 1.0 / 255);
    return out;
}

GreyPicture blurred(const GreyPicture& picture, double sigma) {
    if (!(sigma > 0)) return picture;
    GreyPicture out = picture;
    const cv::Mat from(picture.height, picture.width, CV_32FC1, const_cast<float*>(picture.values.data()));
    cv::Mat to(picture.height, picture.width, CV_32FC1, out.values.data());
    cv::GaussianBlur(from, to, {}, sigma);
    return out;
}

} // namespace heliodon::vision
