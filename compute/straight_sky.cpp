#include "compute/straight_sky.h"

#include <cmath>
#include <map>
#include <tuple>

#include <glm/geometric.hpp>

#include "compute/daylight/sky_table.h"
#include "compute/lighting.h"

namespace heliodon::compute {

namespace {

// The cells of a near wall see a window from places so near one another that their samples crowd: those
// within a box of directions count as one at their middle, off by the square of the box's size. Its height is
// that of the root of the direction's, as skies change fast above the horizon.
constexpr float kBox = 0.0125F;

std::vector<SkySample> gathered(std::span<const SkySample> samples) {
    struct Box {
        glm::dvec3 direction{0}, weight{0};
        double total = 0;
    };
    std::map<std::tuple<int, int, int>, Box> boxes;
    for (const SkySample& sample : samples) {
        const auto at = [](float x) { return static_cast<int>(std::floor(x / kBox)); };
        const glm::vec3 d = sample.direction;
        Box& box = boxes[{at(d.x), at(d.z), d.y > 0 ? at(std::sqrt(d.y)) : -1}];
        const double weight = photometric(sample.weight);
        box.direction += weight * glm::dvec3(d);
        box.weight += glm::dvec3(sample.weight);
        box.total += weight;
    }
    std::vector<SkySample> few;
    for (const auto& [key, box] : boxes)
        if (box.total > 0) few.push_back({glm::vec3(glm::normalize(box.direction)), glm::vec3(box.weight)});
    return few;
}

} // namespace

StraightSky::StraightSky(const SkyView& view, std::span<const NearLight> near) {
    for (size_t s = 0; s < near.size(); ++s) {
        double ground = 0;
        const auto take = [&](std::span<const SkySample> samples) {
            for (const SkySample& sample : samples) {
                const auto weight = static_cast<float>(photometric(sample.weight));
                if (sample.direction.y > 0)
                    samples_.push_back(
                        {sample.direction, daylight::SkyTable::heightIndex(sample.direction.y), weight});
                else
                    ground += double{weight};
            }
        };
        take(view.of(s));
        take(gathered(near[s].sky));
        first_.push_back(samples_.size());
        ground_.push_back(static_cast<float>(ground));
    }
}

void StraightSky::addTo(const daylight::Sky& sky, float* lux, size_t stride) const {
    const auto add = [&](auto luminance) {
        for (size_t s = 0; s < ground_.size(); ++s) {
            float sum = ground_[s] * static_cast<float>(sky.ground.luminance);
            for (size_t k = first_[s]; k < first_[s + 1]; ++k)
                sum += samples_[k].weight * luminance(samples_[k]);
            lux[s * stride] += sum;
        }
    };
    if (sky.formula.intermediate) {
        add([&](const Sample& at) { return static_cast<float>(sky.luminance(glm::dvec3(at.direction))); });
    } else {
        const daylight::SkyTable table(sky);
        add([&](const Sample& at) { return table.luminance(at.direction, at.heightIndex); });
    }
}

} // namespace heliodon::compute
