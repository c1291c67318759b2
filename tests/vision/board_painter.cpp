#include "tests/vision/board_painter.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <glm/glm.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace heliodon::vision {
namespace {

constexpr int kSamples = 4; // along a pixel's side

glm::dvec3 inkAt(const CalibrationTarget& target, glm::dvec2 p) {
    const double half = target.board / 2;
    if (std::abs(p.x) > half || std::abs(p.y) > half) return glm::dvec3(0.04);
    for (const auto& disk : target.disks)
        if (glm::distance(p, disk.at) < target.diskRadius) return glm::pow(disk.srgb, glm::dvec3(2.2)) * 0.85;
    const glm::dvec2 cell = glm::round(p / target.pitch), off = p - target.pitch * cell;
    if (off.x * off.y > 0 && std::max(std::abs(off.x), std::abs(off.y)) < target.square)
        for (const glm::dvec2& mark : target.marks)
            if (glm::distance(mark, target.pitch * cell) < target.pitch / 2) return glm::dvec3(0.035);
    return glm::dvec3(0.86);
}

} // namespace

glm::dvec2 seen(const geometry::Lens& lens, const Pose& pose, glm::dvec2 board) {
    const glm::dvec3 p = pose.rotation * glm::dvec3(board, 0) + pose.translation;
    return lens.pixelFromPlane({p.x / p.z, p.y / p.z});
}

Pose boardPose(double tilt, double axis, double spin, glm::dvec3 at) {
    const auto turn = [](double degrees) {
        const double a = glm::radians(degrees), c = std::cos(a), s = std::sin(a);
        return glm::dmat3(c, s, 0, -s, c, 0, 0, 0, 1);
    };
    const double a = glm::radians(tilt), c = std::cos(a), s = std::sin(a);
    const glm::dmat3 tilted(1, 0, 0, 0, c, s, 0, -s, c);
    return {turn(axis) * tilted * turn(-axis) * turn(spin), at};
}

Photograph paintBoard(const CalibrationTarget& target, const geometry::Lens& lens, int width, int height,
                      const Pose& pose, const BoardLight& light) {
    // A pixel's ray on the board, with the plane's z = 0 in the board's frame.
    const glm::dmat3 toBoard = glm::transpose(pose.rotation);
    const glm::dvec3 centre = -(toBoard * pose.translation);
    const auto onBoard = [&](double x, double y) {
        const glm::dvec3 ray = toBoard * glm::dvec3(lens.planeFromPixel({x, y}), 1);
        return glm::dvec2(centre - ray * (centre.z / ray.z));
    };
    cv::Mat picture(height, width, CV_32FC3);
    std::vector<glm::dvec2> upper, lower; // at the pixels' corners
    for (int y = 0; y <= height; ++y) {
        std::swap(upper, lower);
        lower.clear();
        for (int x = 0; x <= width; ++x) lower.push_back(onBoard(x - 0.5, y - 0.5));
        if (y == 0) continue;
        for (int x = 0; x < width; ++x) {
            const size_t i = static_cast<size_t>(x);
            glm::dvec3 sum{};
            for (int v = 0; v < kSamples; ++v)
                for (int u = 0; u < kSamples; ++u) {
                    const double a = (u + 0.5) / kSamples, b = (v + 0.5) / kSamples;
                    sum += inkAt(target, glm::mix(glm::mix(upper[i], upper[i + 1], a),
                                                  glm::mix(lower[i], lower[i + 1], a), b));
                }
            const double dx = (x - width / 2.0) / (width / 2.0), dy = (y - height / 2.0) / (width / 2.0);
            const double fall = (1 + light.slope * dx / 2) / (1 + light.vignetting * (dx * dx + dy * dy));
            sum *= light.cast * (light.exposure * fall / (kSamples * kSamples));
            picture.at<cv::Vec3f>(y - 1, x) = {static_cast<float>(sum.x), static_cast<float>(sum.y),
                                               static_cast<float>(sum.z)};
        }
    }
    if (light.blurPx > 0) cv::GaussianBlur(picture, picture, {}, light.blurPx);
    std::mt19937 random(light.seed);
    std::normal_distribution<double> normal;
    Photograph out{width, height, {}, "painted"};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) {
                const double value = static_cast<double>(picture.at<cv::Vec3f>(y, x)[c]);
                const double noisy =
                    light.noise > 0 ? value + light.noise * std::sqrt(value + 0.005) * normal(random) : value;
                out.rgb.push_back(
                    static_cast<uint8_t>(std::lround(255 * std::pow(std::clamp(noisy, 0.0, 1.0), 1 / 2.2))));
            }
    return out;
}

} // namespace heliodon::vision
