#include "tests/vision/pattern_painter.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <glm/glm.hpp>

namespace heliodon::vision {
namespace {

constexpr int kSamples = 3; // along a pixel's side

} // namespace

PatternPainter::PatternPainter(const PatternScene& scene) : scene_(scene) {
    const auto &camera = scene.camera, &projector = scene.projector;
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x)
            for (int i = 0; i < kSamples * kSamples; ++i) {
                const glm::dvec2 pixel(x + (i % kSamples + 0.5) / kSamples - 0.5,
                                       y + (i / kSamples + 0.5) / kSamples - 0.5);
                Sample sample;
                auto at = camera.worldOnPlane(pixel, scene.height);
                double white = 1;
                if (at && std::max(std::abs(at->x), std::abs(at->z)) > scene.boardHalf) {
                    at = camera.worldOnPlane(pixel, 0);
                    white = scene.tableWhite;
                }
                if (const auto shown = at ? projector.pixelFromWorld(*at) : std::nullopt) {
                    const glm::dvec2 p = glm::floor(*shown + 0.5);
                    if (p.x >= 0 && p.y >= 0 && p.x < projector.width && p.y < projector.height) {
                        const glm::dvec3 ray = projector.centre() - *at;
                        sample.x = static_cast<int>(p.x), sample.y = static_cast<int>(p.y);
                        sample.light = static_cast<float>(white * 2 * ray.y / std::pow(glm::length(ray), 3));
                    }
                }
                samples_.push_back(sample);
            }
}

GreyPicture PatternPainter::operator()(const std::string& name) const {
    const Photograph pattern = drawPattern(scene_.patterns, name);
    std::mt19937 random(static_cast<unsigned>(std::hash<std::string>{}(name)));
    std::normal_distribution<float> normal;
    GreyPicture sharp{scene_.camera.width, scene_.camera.height, {}};
    for (size_t i = 0; i < samples_.size(); i += kSamples * kSamples) {
        float sum = 0;
        for (size_t s = i; s < i + kSamples * kSamples; ++s)
            if (samples_[s].x >= 0) {
                const size_t pixel = static_cast<size_t>(samples_[s].y * pattern.width + samples_[s].x);
                sum +=
                    samples_[s].light * (pattern.rgb[3 * pixel] ? 1 : static_cast<float>(scene_.blackLevel));
            }
        sharp.values.push_back(static_cast<float>(scene_.exposure) *
                               (sum / (kSamples * kSamples) + static_cast<float>(scene_.ambient)));
    }
    GreyPicture out = blurred(sharp, 0.7);
    for (float& value : out.values) {
        value += static_cast<float>(scene_.noise) * std::sqrt(value + 0.003f) * normal(random);
        value = std::pow(std::clamp(value, 0.0f, 1.0f), 1 / static_cast<float>(scene_.gamma));
        value = std::round(255 * value) / 255;
    }
    return out;
}

geometry::OpticalDevice deviceLooking(glm::dvec3 centre, glm::dvec3 at, glm::dvec3 up,
                                      const geometry::Lens& lens, int width, int height) {
    geometry::OpticalDevice device{"", width, height, lens, glm::dmat3(1), {}};
    const glm::dvec3 z = glm::normalize(at - centre), x = glm::normalize(glm::cross(z, up)),
                     y = glm::cross(z, x);
    device.deviceFromWorld = glm::transpose(glm::dmat3(x, y, z));
    device.translation = -(device.deviceFromWorld * centre);
    return device;
}

} // namespace heliodon::vision
