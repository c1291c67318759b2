#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "vision/chroma.h"
#include "vision/find_target.h"

namespace heliodon::vision {
namespace {

constexpr int kWorkingSize = 1000; // pixels of the longer side: disks have some ten or more
constexpr int kLeastSize = 100;    // of a picture's side: below, no mark is two pixels large
constexpr double kHueTolerance = 38, kLeastArea = 20;

// Light on white as if there were no print: the largest of each channel near every pixel. Print is darker
// than the board in all channels, and no disk is as large as the neighbourhood.
cv::Mat lightOnWhite(const cv::Mat& light) {
    const int reach = std::max(light.cols, light.rows) / 16;
    cv::Mat small, white;
    cv::resize(light, small, {}, 0.25, 0.25, cv::INTER_AREA);
    const int r = std::max(1, reach / 4);
    cv::dilate(small, small, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * r + 1, 2 * r + 1}));
    cv::GaussianBlur(small, small, {}, r / 2.0);
    cv::resize(small, white, light.size(), 0, 0, cv::INTER_LINEAR);
    return white;
}

// The paper's P' = (P - Pmin) / Pmax of a pixel over white, and its hue.
struct Paint {
    double saturation = 0, value = 0, hue = 0;
};
Paint paintOf(const cv::Vec3f& light, const cv::Vec3f& white) {
    glm::vec3 p;
    for (int c = 0; c < 3; ++c) p[c] = light[c] / std::max(white[c], 1e-4f);
    return {saturationOf(p), std::max({p.r, p.g, p.b}), hueOf(p)};
}

double hueDistance(double a, double b) {
    return std::abs(std::remainder(a - b, 360));
}

// Of a component: whether it is an ellipse, and whether white lies all round it.
std::optional<DiskCandidate> asDisk(const cv::Mat& component, double expectedHue, const cv::Mat& light,
                                    const cv::Mat& white, cv::Point corner) {
    const cv::Moments m = cv::moments(component, true);
    const double area = m.m00, cx = m.m10 / area, cy = m.m01 / area;
    const double xx = m.mu20 / area, xy = m.mu11 / area, yy = m.mu02 / area;
    const double spread = std::sqrt(std::max(xx * yy - xy * xy, 0.0));
    const double middle = (xx + yy) / 2, off = std::hypot((xx - yy) / 2, xy);
    if (!(spread > 0) || middle - off < 0.05 * (middle + off)) return std::nullopt; // 77 degrees of tilt
    const double fill = area / (4 * std::numbers::pi * spread);                     // 1 for an ellipse
    if (fill < 0.85 || fill > 1.1) return std::nullopt;

    DiskCandidate disk{{cx + corner.x, cy + corner.y}, std::sqrt(area / std::numbers::pi), 0};
    const double angle = std::atan2(2 * xy, xx - yy) / 2;
    const double a = 2 * std::sqrt(middle + off), b = 2 * std::sqrt(middle - off);
    int whites = 0, samples = 0;
    double hueError = 0;
    for (int i = 0; i < 24; ++i)
        for (const double scale : {1.5, 0.5}) {
            const double t = 2 * std::numbers::pi * i / 24, u = scale * a * std::cos(t),
                         v = scale * b * std::sin(t);
            const cv::Point p(
                static_cast<int>(std::lround(disk.centre.x + u * std::cos(angle) - v * std::sin(angle))),
                static_cast<int>(std::lround(disk.centre.y + u * std::sin(angle) + v * std::cos(angle))));
            if (!cv::Rect({}, light.size()).contains(p)) continue;
            const Paint paint = paintOf(light.at<cv::Vec3f>(p), white.at<cv::Vec3f>(p));
            if (scale < 1)
                hueError += hueDistance(paint.hue, expectedHue) / 24;
            else {
                ++samples;
                whites += paint.saturation < 0.3 && paint.value > 0.45;
            }
        }
    if (samples < 12 || whites < 0.75 * samples) return std::nullopt;
    disk.misfit =
        hueError / kHueTolerance + 4 * std::abs(fill - 1) + (1 - static_cast<double>(whites) / samples);
    return disk;
}

} // namespace

std::array<std::vector<DiskCandidate>, 4> findDisks(const Photograph& photo, const CalibrationTarget& target,
                                                    double saturation) {
    if (std::min(photo.width, photo.height) < kLeastSize) return {};
    const cv::Mat bytes(photo.height, photo.width, CV_8UC3, const_cast<uint8_t*>(photo.rgb.data()));
    cv::Mat light;
    bytes.convertTo(light, CV_32FC3, 1.0 / 255);
    cv::pow(light, 2.2, light); // near enough for colours, whatever the camera's gamma
    const double scale =
        std::min(1.0, static_cast<double>(kWorkingSize) / std::max(photo.width, photo.height));
    if (scale < 1) cv::resize(light, light, {}, scale, scale, cv::INTER_AREA);
    cv::GaussianBlur(light, light, {}, 1.0);
    const cv::Mat white = lightOnWhite(light);

    std::array<cv::Mat, 4> masks;
    for (cv::Mat& mask : masks) mask = cv::Mat::zeros(light.size(), CV_8U);
    for (int y = 0; y < light.rows; ++y)
        for (int x = 0; x < light.cols; ++x) {
            const Paint paint = paintOf(light.at<cv::Vec3f>(y, x), white.at<cv::Vec3f>(y, x));
            if (paint.saturation < saturation || paint.value < 0.12) continue;
            for (size_t i = 0; i < 4; ++i)
                if (hueDistance(paint.hue, target.disks[i].hueDegrees) < kHueTolerance)
                    masks[i].at<uint8_t>(y, x) = 255;
        }

    std::array<std::vector<DiskCandidate>, 4> out;
    for (size_t i = 0; i < 4; ++i) {
        cv::Mat labels, stats, centres;
        const int count = cv::connectedComponentsWithStats(masks[i], labels, stats, centres, 4);
        for (int c = 1; c < count; ++c) {
            if (stats.at<int>(c, cv::CC_STAT_AREA) < kLeastArea) continue;
            const cv::Rect box(stats.at<int>(c, cv::CC_STAT_LEFT), stats.at<int>(c, cv::CC_STAT_TOP),
                               stats.at<int>(c, cv::CC_STAT_WIDTH), stats.at<int>(c, cv::CC_STAT_HEIGHT));
            const cv::Mat component = labels(box) == c;
            if (auto disk = asDisk(component, target.disks[i].hueDegrees, light, white, box.tl())) {
                disk->centre = (disk->centre + 0.5) / scale - 0.5;
                disk->radius /= scale;
                out[i].push_back(*disk);
            }
        }
        std::sort(out[i].begin(), out[i].end(),
                  [](const DiskCandidate& a, const DiskCandidate& b) { return a.misfit < b.misfit; });
        if (out[i].size() > 4) out[i].resize(4);
    }
    return out;
}

} // namespace heliodon::vision
