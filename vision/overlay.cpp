#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "vision/detect.h"
#include "vision/median.h"

namespace heliodon::vision {
namespace {

constexpr int kShift = 4; // OpenCV draws at 1/16 pixel

cv::Scalar bgr(int r, int g, int b) {
    return {static_cast<double>(b), static_cast<double>(g), static_cast<double>(r)};
}

cv::Scalar colorOf(geometry::HeightClass c) {
    return c == geometry::HeightClass::red    ? bgr(255, 70, 60)
           : c == geometry::HeightClass::blue ? bgr(70, 130, 255)
                                              : bgr(50, 215, 100);
}

cv::Scalar colorOf(geometry::WindowKind k) {
    return k == geometry::WindowKind::standard  ? bgr(0, 235, 245)
           : k == geometry::WindowKind::picture ? bgr(255, 80, 220)
                                                : bgr(255, 225, 40);
}

class Canvas {
public:
    explicit Canvas(const Photograph& photo) {
        const cv::Mat rgb(photo.height, photo.width, CV_8UC3, const_cast<uint8_t*>(photo.rgb.data()));
        // Bright enough to see in a dim room's picture, and grey enough for the drawing to stand out.
        std::vector<uint8_t> green;
        for (size_t i = 1; i < photo.rgb.size(); i += 3 * 97) green.push_back(photo.rgb[i]);
        double white = 255;
        if (!green.empty()) white = std::max<double>(ranked(green, green.size() * 97 / 100), 16);
        cv::Mat grey, color;
        cv::cvtColor(rgb, color, cv::COLOR_RGB2BGR);
        cv::cvtColor(rgb, grey, cv::COLOR_RGB2GRAY);
        cv::cvtColor(grey, grey, cv::COLOR_GRAY2BGR);
        cv::addWeighted(color, 0.55 * 205 / white, grey, 0.45 * 205 / white, 0, picture_);
    }

    void outline(const geometry::Detection& detection, const cv::Scalar& color, int width = 2) {
        if (detection.outlinePx.size() < 2) return;
        std::vector<cv::Point> points;
        for (const auto& p : detection.outlinePx)
            points.emplace_back(static_cast<int>(std::lround(std::clamp(p.x, -1e4, 1e4) * (1 << kShift))),
                                static_cast<int>(std::lround(std::clamp(p.y, -1e4, 1e4) * (1 << kShift))));
        cv::polylines(picture_, points, true, bgr(15, 15, 20), width + 2, cv::LINE_AA, kShift);
        cv::polylines(picture_, points, true, color, width, cv::LINE_AA, kShift);
    }

    // Stripes over the triangles, all in one pattern so that neighbours show no seams.
    void hatch(const geometry::OpticalDevice& camera, std::span<const std::array<glm::dvec3, 3>> triangles) {
        if (triangles.empty()) return;
        cv::Mat mask(picture_.size(), CV_8UC1, cv::Scalar(0));
        for (const auto& triangle : triangles) {
            std::vector<cv::Point> points;
            for (const glm::dvec3& corner : triangle)
                if (const auto p = camera.pixelFromWorld(corner))
                    points.emplace_back(
                        static_cast<int>(std::lround(std::clamp(p->x, -1e4, 1e4) * (1 << kShift))),
                        static_cast<int>(std::lround(std::clamp(p->y, -1e4, 1e4) * (1 << kShift))));
            if (points.size() == 3) cv::fillConvexPoly(mask, points, cv::Scalar(255), cv::LINE_8, kShift);
        }
        const cv::Vec3b ink(40, 150, 255), shade(30, 30, 30);
        for (int y = 0; y < mask.rows; ++y)
            for (int x = 0; x < mask.cols; ++x)
                if (mask.at<uint8_t>(y, x)) {
                    cv::Vec3b& pixel = picture_.at<cv::Vec3b>(y, x);
                    pixel = (x + y) % 9 < 2 ? ink : pixel * 0.8 + shade * 0.2;
                }
    }

    const cv::Mat& picture() const { return picture_; }

private:
    cv::Mat picture_;
};

} // namespace

geometry::Detection tableEdge(const geometry::Rig& rig) {
    geometry::Detection out;
    for (int i = 0; i < 180; ++i) {
        const double a = 2 * std::numbers::pi * i / 180;
        const auto pixel =
            rig.camera.pixelFromWorld({rig.tableRadius * std::cos(a), 0, rig.tableRadius * std::sin(a)});
        if (pixel) out.outlinePx.push_back(*pixel);
    }
    return out;
}

Overlay drawOverlay(const Photograph& photo, const geometry::Rig& rig, const geometry::Sketch& sketch,
                    std::span<const std::array<glm::dvec3, 3>> dark) {
    Canvas canvas(photo);
    canvas.hatch(rig.camera, dark);
    canvas.outline(tableEdge(rig), bgr(235, 235, 215), 1);
    Overlay out;
    using Side = OverlayTag::Side;
    const auto add = [&](const geometry::Detection& detection, const std::string& words,
                         const cv::Scalar& color, Side side) {
        canvas.outline(detection, color);
        if (detection.outlinePx.empty()) return;
        const auto channel = [&](int c) { return static_cast<uint8_t>(color[c]); };
        out.tags.push_back(
            {words, {channel(2), channel(1), channel(0)}, detection.outlinePx, side, std::nullopt});
    };
    for (const auto& wall : sketch.walls)
        add(wall.detection, wall.id, colorOf(wall.heightClass), Side::outer);
    for (const auto& arc : sketch.arcs) add(arc.detection, arc.id, colorOf(arc.heightClass), Side::outer);
    for (const auto& window : sketch.windows)
        add(window.detection, window.id, colorOf(window.kind), Side::inner);
    for (const auto& skylight : sketch.skylights)
        add(skylight.detection, skylight.id, bgr(150, 215, 255), Side::any);
    for (const auto& token : sketch.tokens) {
        if (token.detection.outlinePx.empty()) continue;
        add(token.detection,
            token.kind == geometry::TokenKind::floor     ? "floor"
            : token.kind == geometry::TokenKind::wallAll ? "all walls"
                                                         : "nearest wall",
            bgr(255, 255, 255), Side::any);
        const auto byte = [&](size_t c) {
            return static_cast<uint8_t>(std::clamp(token.rgb[c], 0.0, 255.0));
        };
        out.tags.back().paint = {byte(0), byte(1), byte(2)};
    }
    if (sketch.north) add(sketch.north->detection, "N", bgr(255, 150, 40), Side::any);
    cv::Mat rgb;
    cv::cvtColor(canvas.picture(), rgb, cv::COLOR_BGR2RGB);
    out.picture = {rgb.cols, rgb.rows, std::vector<uint8_t>(rgb.datastart, rgb.dataend), photo.name};
    return out;
}

} // namespace heliodon::vision
