#include "tests/vision/table_painter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace heliodon::vision {
namespace {

using geometry::heightInches;
using geometry::kMetresPerInch;

constexpr int kSuper = 2, kShift = 4;
const Color kWhite{0.84, 0.84, 0.83}; // foam core

glm::dvec2 direction(double degrees) {
    return {std::cos(degrees * std::numbers::pi / 180), std::sin(degrees * std::numbers::pi / 180)};
}
glm::dvec2 left(glm::dvec2 v) {
    return {-v.y, v.x};
}

double linear(uint8_t v) {
    static const auto light = [] {
        std::array<double, 256> out{};
        for (size_t i = 0; i < out.size(); ++i) out[i] = std::pow(static_cast<double>(i) / 255, 2.2);
        return out;
    }();
    return light[v];
}
uint8_t encodedByPower(double v) {
    return static_cast<uint8_t>(std::lround(255 * std::pow(v, 1 / 2.2)));
}
// The same byte: powers are slow, and between two places of one byte there is no other.
uint8_t encoded(double v) {
    constexpr size_t kSteps = 1 << 15;
    static const auto bytes = [] {
        std::array<uint8_t, kSteps + 2> out{};
        for (size_t i = 0; i < out.size(); ++i)
            out[i] = encodedByPower(std::min(1.0, static_cast<double>(i) / kSteps));
        return out;
    }();
    v = std::clamp(v, 0.0, 1.0);
    const auto i = static_cast<size_t>(v * kSteps);
    return bytes[i] == bytes[i + 1] ? bytes[i] : encodedByPower(v);
}

class Easel {
public:
    Easel(const geometry::Rig& rig, const PaintBox& paints)
        : rig_(rig), face_(paints.face),
          picture_(rig.camera.height * kSuper, rig.camera.width * kSuper, CV_16UC3, scalar(paints.floor)) {}

    // Plan corners at one height; edges are cut small enough to bend as the lens bends them.
    void fill(const std::vector<glm::dvec2>& corners, double height, const Color& color) {
        std::vector<glm::dvec3> world;
        for (size_t i = 0; i < corners.size(); ++i) {
            const glm::dvec2 a = corners[i], b = corners[(i + 1) % corners.size()];
            const int n = 1 + static_cast<int>(glm::distance(a, b));
            for (int k = 0; k < n; ++k)
                world.emplace_back(a + (b - a) * (static_cast<double>(k) / n), height);
        }
        fill(world, color);
    }
    void face(glm::dvec2 a, glm::dvec2 b, double height) {
        fill({glm::dvec3(a, 0), glm::dvec3(0.5 * (a + b), 0), glm::dvec3(b, 0), glm::dvec3(b, height),
              glm::dvec3(0.5 * (a + b), height), glm::dvec3(a, height)},
             face_);
    }

    Photograph develop(const Lighting& lighting) const {
        cv::Mat small;
        cv::resize(picture_, small, {rig_.camera.width, rig_.camera.height}, 0, 0, cv::INTER_AREA);
        cv::GaussianBlur(small, small, {}, 0.6);
        Photograph out{small.cols, small.rows, std::vector<uint8_t>(small.total() * 3)};
        for (int y = 0; y < small.rows; ++y)
            for (int x = 0; x < small.cols; ++x)
                for (int c = 0; c < 3; ++c) {
                    const auto i = static_cast<size_t>(c);
                    const double share = static_cast<double>(x) / small.cols;
                    const double light = (1 - share) * lighting.left[i] + share * lighting.right[i];
                    const double v = std::min(1.0, small.at<cv::Vec<uint16_t, 3>>(y, x)[c] / 65535.0 * light);
                    out.rgb[3 * (static_cast<size_t>(y) * static_cast<size_t>(small.cols) +
                                 static_cast<size_t>(x)) +
                            i] = encoded(v);
                }
        return out;
    }

private:
    static cv::Scalar scalar(const Color& c) { return {65535 * c[0], 65535 * c[1], 65535 * c[2]}; }
    // (plan x, plan y, height), inches.
    void fill(const std::vector<glm::dvec3>& corners, const Color& color) {
        std::vector<cv::Point> points;
        for (const auto& p : corners) {
            const auto pixel = rig_.camera.pixelFromWorld(
                {kMetresPerInch * p.x, kMetresPerInch * p.z, -kMetresPerInch * p.y});
            if (!pixel) return;
            // Pixel centres: integer in the picture, half in the finer one.
            const glm::dvec2 fine = (*pixel + 0.5) * static_cast<double>(kSuper) - 0.5;
            points.emplace_back(static_cast<int>(std::lround(fine.x * (1 << kShift))),
                                static_cast<int>(std::lround(fine.y * (1 << kShift))));
        }
        cv::fillPoly(picture_, std::vector<std::vector<cv::Point>>{points}, scalar(color), cv::LINE_8,
                     kShift);
    }

    const geometry::Rig& rig_;
    Color face_;
    cv::Mat picture_;
};

std::vector<glm::dvec2> box(glm::dvec2 centre, glm::dvec2 size, double degrees) {
    const glm::dvec2 x = 0.5 * size.x * direction(degrees), y = 0.5 * size.y * left(direction(degrees));
    return {centre - x - y, centre + x - y, centre + x + y, centre - x + y};
}

std::vector<glm::dvec2> strip(glm::dvec2 a, glm::dvec2 b, double width) {
    const glm::dvec2 side = 0.5 * width * left(glm::normalize(b - a));
    return {a - side, b - side, b + side, a + side};
}

std::vector<glm::dvec2> ring(const geometry::Arc& arc, double a0, double a1) {
    std::vector<glm::dvec2> out;
    constexpr int kCorners = 60;
    for (int i = 0; i <= kCorners; ++i)
        out.push_back(arc.center +
                      (arc.radius + 0.5 * arc.thickness) * direction(a0 + (a1 - a0) * i / kCorners));
    for (int i = kCorners; i >= 0; --i)
        out.push_back(arc.center +
                      (arc.radius - 0.5 * arc.thickness) * direction(a0 + (a1 - a0) * i / kCorners));
    return out;
}

const Color& paintOf(geometry::HeightClass c, const PaintBox& paints) {
    return c == geometry::HeightClass::red    ? paints.red
           : c == geometry::HeightClass::blue ? paints.blue
                                              : paints.green;
}

void paintWall(Easel& easel, const geometry::Wall& wall, const geometry::Sketch& sketch,
               const PaintBox& paints) {
    const double h = heightInches(wall.heightClass);
    const glm::dvec2 along = glm::normalize(wall.b - wall.a);
    const auto body = strip(wall.a, wall.b, wall.thickness);
    for (size_t i = 0; i < 4; ++i) easel.face(body[i], body[(i + 1) % 4], h);
    easel.fill(body, h, kWhite);
    easel.fill(strip(wall.a + 0.5 * along, wall.b - 0.5 * along, wall.thickness), h,
               paintOf(wall.heightClass, paints));
    for (const auto& window : sketch.windows) {
        if (window.wall != wall.id) continue;
        const Color& color = window.kind == geometry::WindowKind::standard  ? paints.cyan
                             : window.kind == geometry::WindowKind::picture ? paints.magenta
                                                                            : paints.yellow;
        easel.fill(strip(wall.a + (window.pos - 0.5 * window.width) * along,
                         wall.a + (window.pos + 0.5 * window.width) * along, wall.thickness + 0.06),
                   h + 0.03, color);
    }
}

void paintArc(Easel& easel, const geometry::Arc& arc, const PaintBox& paints) {
    const double h = heightInches(arc.heightClass), end = 0.5 / arc.radius * 180 / std::numbers::pi;
    const auto body = ring(arc, arc.a0Deg, arc.a1Deg);
    for (size_t i = 0; i < body.size(); ++i) easel.face(body[i], body[(i + 1) % body.size()], h);
    easel.fill(body, h, kWhite);
    easel.fill(ring(arc, arc.a0Deg + end, arc.a1Deg - end), h, paintOf(arc.heightClass, paints));
}

void paintToken(Easel& easel, const geometry::Token& token, const PaintBox& paints) {
    const Color& rim = token.kind == geometry::TokenKind::floor     ? paints.green
                       : token.kind == geometry::TokenKind::wallAll ? paints.blue
                                                                    : paints.red;
    Color chip;
    for (size_t c = 0; c < 3; ++c) {
        const double v = token.rgb[c] / 255;
        chip[c] = 0.95 * (v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
    }
    easel.fill(box(token.pos, {1.5, 1.5}, token.angleDeg), 0.06, rim);
    easel.fill(box(token.pos, {1.1, 1.1}, token.angleDeg), 0.06, {0.82, 0.82, 0.815});
    easel.fill(box(token.pos, {0.7, 0.7}, token.angleDeg), 0.06, chip);
}

cv::Mat maskOf(const Photograph& photo, const geometry::Rig& rig, const std::vector<glm::dvec2>& corners,
               double height) {
    std::vector<cv::Point> points;
    for (const auto& c : corners) {
        const auto p =
            rig.camera.pixelFromWorld({kMetresPerInch * c.x, kMetresPerInch * height, -kMetresPerInch * c.y});
        if (p) points.emplace_back(static_cast<int>(std::lround(p->x)), static_cast<int>(std::lround(p->y)));
    }
    cv::Mat mask = cv::Mat::zeros(photo.height, photo.width, CV_8U);
    cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{points}, 1);
    return mask;
}

} // namespace

void shade(Photograph& photo, const geometry::Rig& rig, const std::vector<glm::dvec2>& corners, double height,
           const Color& gain, double softPx) {
    cv::Mat soft;
    maskOf(photo, rig, corners, height).convertTo(soft, CV_32F);
    cv::GaussianBlur(soft, soft, {}, softPx);
    for (size_t i = 0; i < photo.rgb.size(); ++i) {
        const double share =
            soft.at<float>(static_cast<int>(i / 3) / photo.width, static_cast<int>(i / 3) % photo.width);
        photo.rgb[i] = encoded(linear(photo.rgb[i]) * (1 + share * (gain[i % 3] - 1)));
    }
}

void cover(Photograph& photo, const geometry::Rig& rig, const std::vector<glm::dvec2>& corners, double height,
           const Color& color) {
    const cv::Mat mask = maskOf(photo, rig, corners, height);
    for (size_t i = 0; i < photo.rgb.size(); ++i)
        if (mask.at<uint8_t>(static_cast<int>(i / 3) / photo.width, static_cast<int>(i / 3) % photo.width))
            photo.rgb[i] = encoded(0.6 * color[i % 3]);
}

void smoothEncoded(Photograph& photo, double px) {
    cv::Mat picture(photo.height, photo.width, CV_8UC3, photo.rgb.data());
    cv::GaussianBlur(picture, picture, {}, px);
}

void mixChannels(Photograph& photo, double share) {
    for (size_t i = 0; i < photo.rgb.size(); i += 3) {
        const double p[3] = {linear(photo.rgb[i]), linear(photo.rgb[i + 1]), linear(photo.rgb[i + 2])};
        const double sum = p[0] + p[1] + p[2];
        for (size_t c = 0; c < 3; ++c) photo.rgb[i + c] = encoded((1 - 3 * share) * p[c] + share * sum);
    }
}

Photograph paintTable(const geometry::Sketch& sketch, const geometry::Rig& rig, const PaintBox& paints,
                      const Lighting& lighting) {
    Easel easel(rig, paints);
    std::vector<glm::dvec2> table;
    for (int i = 0; i < 360; ++i) table.push_back(rig.tableRadius / kMetresPerInch * direction(i));
    easel.fill(table, 0, paints.table);
    for (const auto& s : sketch.skylights) easel.fill(box(s.center, s.size, s.angleDeg), 0.03, paints.sky);
    for (const auto& token : sketch.tokens) paintToken(easel, token, paints);
    if (sketch.north) {
        const glm::dvec2 d = direction(sketch.north->dirDeg), n = left(d), p = sketch.north->pos;
        easel.fill({p - 1.5 * d - 0.16 * n, p + 0.55 * d - 0.16 * n, p + 0.55 * d - 0.5 * n, p + 1.5 * d,
                    p + 0.55 * d + 0.5 * n, p + 0.55 * d + 0.16 * n, p - 1.5 * d + 0.16 * n},
                   0.03, paints.orange);
    }
    // Far from the camera first: a wall hides what lies behind it.
    const glm::dvec3 eye = rig.camera.centre() / kMetresPerInch;
    struct Item {
        double distance;
        const geometry::Wall* wall;
        const geometry::Arc* arc;
    };
    std::vector<Item> items;
    for (const auto& w : sketch.walls)
        items.push_back({glm::distance(0.5 * (w.a + w.b), {eye.x, -eye.z}), &w, nullptr});
    for (const auto& a : sketch.arcs)
        items.push_back(
            {glm::distance(a.center + a.radius * direction(0.5 * (a.a0Deg + a.a1Deg)), {eye.x, -eye.z}),
             nullptr, &a});
    std::sort(items.begin(), items.end(),
              [](const Item& a, const Item& b) { return a.distance > b.distance; });
    for (const Item& item : items)
        item.wall ? paintWall(easel, *item.wall, sketch, paints) : paintArc(easel, *item.arc, paints);
    return easel.develop(lighting);
}

} // namespace heliodon::vision
