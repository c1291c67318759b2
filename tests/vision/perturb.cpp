#include "tests/vision/perturb.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <glm/geometric.hpp>
#include <glm/glm.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "vision/picture_header.h"

namespace heliodon::vision {
namespace {

cv::Mat linear(const Photograph& photo) {
    cv::Mat bytes(photo.height, photo.width, CV_8UC3, const_cast<uint8_t*>(photo.rgb.data())), out;
    bytes.convertTo(out, CV_32FC3, 1.0 / 255);
    cv::pow(out, 2.2, out);
    return out;
}

// Turns the chroma of a colour about the grey axis as an HSV hue turn does, on the part above the smallest
// component.
cv::Vec3f turnedHue(cv::Vec3f p, float degrees) {
    const float high = std::max({p[0], p[1], p[2]}), low = std::min({p[0], p[1], p[2]}), span = high - low;
    if (span < 0.25f * high) return p;
    float hue = high == p[0]   ? std::fmod((p[1] - p[2]) / span + 6, 6.0f)
                : high == p[1] ? 2 + (p[2] - p[0]) / span
                               : 4 + (p[0] - p[1]) / span;
    hue = std::fmod(hue + degrees / 60 + 6, 6.0f);
    cv::Vec3f out;
    for (int c = 0; c < 3; ++c) {
        const float k = std::fmod(hue + (c == 0 ? 0.0f : c == 1 ? 4.0f : 2.0f), 6.0f);
        out[c] = low + span * std::clamp(std::abs(k - 3) - 1, 0.0f, 1.0f);
    }
    return out;
}

} // namespace

Photograph perturbed(const Photograph& photo, const Perturbation& how) {
    cv::Mat light = linear(photo);
    if (how.blurPx > 0) cv::GaussianBlur(light, light, {}, how.blurPx);
    std::mt19937 random(how.seed);
    std::normal_distribution<float> normal;
    Photograph out = photo;
    cv::Mat bytes(photo.height, photo.width, CV_8UC3, out.rgb.data());
    for (int y = 0; y < light.rows; ++y)
        for (int x = 0; x < light.cols; ++x) {
            cv::Vec3f p = light.at<cv::Vec3f>(y, x);
            if (how.hueDegrees != 0) p = turnedHue(p, static_cast<float>(how.hueDegrees));
            for (int c = 0; c < 3; ++c) {
                float v = p[c] * static_cast<float>(how.gain[c]);
                if (how.electronsAtWhite > 0) {
                    const float e = v * static_cast<float>(how.electronsAtWhite);
                    v += std::sqrt(std::max(e, 0.0f) + static_cast<float>(how.readNoise * how.readNoise)) *
                         normal(random) / static_cast<float>(how.electronsAtWhite);
                }
                v = std::pow(std::clamp(v, 0.0f, 1.0f), static_cast<float>(1 / how.gamma));
                bytes.at<cv::Vec3b>(y, x)[c] = static_cast<uint8_t>(std::lround(255 * v));
            }
        }
    if (how.jpegQuality > 0) {
        std::vector<uint8_t> file;
        cv::Mat bgr;
        cv::cvtColor(bytes, bgr, cv::COLOR_RGB2BGR);
        cv::imencode(".jpg", bgr, file, {cv::IMWRITE_JPEG_QUALITY, how.jpegQuality});
        cv::cvtColor(cv::imdecode(file, cv::IMREAD_COLOR), bytes, cv::COLOR_BGR2RGB);
        out.jpegQuality = jpegQuality(file), out.chromaStep = chromaStep(file);
    }
    return out;
}

Photograph rephotographed(const Photograph& photo, geometry::Rig& rig, const double (&turnDegrees)[3],
                          const geometry::Lens& lens) {
    const geometry::OpticalDevice before = rig.camera;
    glm::dmat3 turn(1);
    for (int axis = 0; axis < 3; ++axis) {
        const double a = turnDegrees[axis] * std::numbers::pi / 180, c = std::cos(a), s = std::sin(a);
        const int i = (axis + 1) % 3, k = (axis + 2) % 3;
        glm::dmat3 r(1);
        r[i][i] = c, r[k][i] = -s, r[i][k] = s, r[k][k] = c;
        turn = r * turn;
    }
    rig.camera.lens = lens;
    rig.camera.deviceFromWorld = turn * before.deviceFromWorld;
    rig.camera.translation = turn * before.translation;
    cv::Mat mapX(photo.height, photo.width, CV_32F), mapY(photo.height, photo.width, CV_32F);
    for (int y = 0; y < photo.height; ++y)
        for (int x = 0; x < photo.width; ++x) {
            const glm::dvec3 ray(lens.planeFromPixel(glm::dvec2(x, y)), 1);
            const glm::dvec3 old = glm::transpose(turn) * ray;
            const glm::dvec2 p = before.lens.pixelFromPlane(glm::dvec2(old.x, old.y) / old.z);
            mapX.at<float>(y, x) = static_cast<float>(p.x), mapY.at<float>(y, x) = static_cast<float>(p.y);
        }
    Photograph out = photo;
    cv::Mat from(photo.height, photo.width, CV_8UC3, const_cast<uint8_t*>(photo.rgb.data()));
    cv::Mat to(photo.height, photo.width, CV_8UC3, out.rgb.data());
    cv::remap(from, to, mapX, mapY, cv::INTER_CUBIC, cv::BORDER_CONSTANT, cv::Scalar(20, 20, 20));
    return out;
}

} // namespace heliodon::vision
