#include "engine/app/test_pictures.h"

#include <algorithm>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace heliodon::app {

namespace {

cv::Mat matOf(passes::Image8& picture) {
    return {picture.height, picture.width, CV_8UC3, picture.rgb.data()};
}

void write(cv::Mat& mat, const std::string& text, double middle, double height, const cv::Scalar& colour) {
    constexpr double kLetter = 22; // pixels of the font at scale 1
    double scale = height / kLetter;
    int below = 0;
    cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, 1, &below);
    scale *= std::min(1.0, 0.9 * mat.cols / size.width);
    const int thick = std::max(1, static_cast<int>(2.5 * scale));
    size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, thick, &below);
    cv::putText(mat, text, {(mat.cols - size.width) / 2, static_cast<int>(middle) + size.height / 2},
                cv::FONT_HERSHEY_SIMPLEX, scale, colour, thick, cv::LINE_AA);
}

} // namespace

passes::Image8 plainPicture(const geometry::Projector& projector, uint8_t value) {
    const size_t count = static_cast<size_t>(projector.width) * static_cast<size_t>(projector.height);
    return {projector.width, projector.height, std::vector<uint8_t>(3 * count, value)};
}

passes::Image8 gridPicture(const geometry::Projector& projector) {
    passes::Image8 picture = plainPicture(projector, 0);
    cv::Mat mat = matOf(picture);
    const cv::Scalar line(150, 150, 150), strong(255, 255, 255), mark(255, 190, 80);
    const int width = picture.width, height = picture.height;
    constexpr int kStep = 64;
    for (int x = (width / 2) % kStep; x < width; x += kStep) cv::line(mat, {x, 0}, {x, height - 1}, line);
    for (int y = (height / 2) % kStep; y < height; y += kStep) cv::line(mat, {0, y}, {width - 1, y}, line);
    cv::rectangle(mat, cv::Rect(0, 0, width, height), strong);
    cv::line(mat, {width / 2, 0}, {width / 2, height - 1}, strong, 2);
    cv::line(mat, {0, height / 2}, {width - 1, height / 2}, strong, 2);
    const int radius = height / 3;
    cv::circle(mat, {width / 2, height / 2}, radius, mark, 2, cv::LINE_AA);
    for (int k = 0; k < 4; ++k)
        cv::circle(
            mat, {k % 2 ? width - 1 - radius / 2 : radius / 2, k / 2 ? height - 1 - radius / 2 : radius / 2},
            radius / 3, mark, 2, cv::LINE_AA);
    return picture;
}

passes::Image8 namePicture(const geometry::Projector& projector, size_t number) {
    passes::Image8 picture = plainPicture(projector, 24);
    cv::Mat mat = matOf(picture);
    const cv::Scalar white(255, 255, 255), amber(255, 190, 80);
    cv::rectangle(mat, cv::Rect(0, 0, mat.cols, mat.rows), white, 3);
    write(mat, std::to_string(number), 0.40 * mat.rows, 0.42 * mat.rows, white);
    write(mat, projector.id, 0.72 * mat.rows, 0.07 * mat.rows, amber);
    write(mat,
          fmt::format("{} x {}{}", projector.width, projector.height,
                      projector.display.empty() ? "" : ", display " + projector.display),
          0.84 * mat.rows, 0.05 * mat.rows, white);
    write(mat, "top", 0.06 * mat.rows, 0.04 * mat.rows, amber);
    return picture;
}

} // namespace heliodon::app
