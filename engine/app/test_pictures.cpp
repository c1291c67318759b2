#include "engine/app/test_pictures.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/passes/lettering.h"

namespace heliodon::app {

namespace {

cv::Mat matOf(passes::Image8& picture) {
    return {picture.height, picture.width, CV_8UC3, picture.rgb.data()};
}

void write(passes::Image8& picture, const std::string& text, double middle, double height,
           const std::array<uint8_t, 3>& ink) {
    passes::Lettering letters{height, ink};
    letters.shrinkTo(0.9 * picture.width, text);
    letters.drawCentred(picture, 0.5 * picture.width, middle, text);
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
    constexpr std::array<uint8_t, 3> white{255, 255, 255}, amber{255, 190, 80};
    cv::rectangle(mat, cv::Rect(0, 0, mat.cols, mat.rows), cv::Scalar(255, 255, 255), 3);
    write(picture, std::to_string(number), 0.40 * mat.rows, 0.42 * mat.rows, white);
    write(picture, projector.id, 0.72 * mat.rows, 0.07 * mat.rows, amber);
    write(picture,
          fmt::format("{} x {}{}", projector.width, projector.height,
                      projector.display.empty() ? "" : ", display " + projector.display),
          0.84 * mat.rows, 0.05 * mat.rows, white);
    write(picture, "top", 0.06 * mat.rows, 0.04 * mat.rows, amber);
    return picture;
}

} // namespace heliodon::app
