#include "compute/straight_sky.h"

#include "compute/daylight/sky_table.h"
#include "compute/lighting.h"

namespace heliodon::compute {

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
        take(near[s].sky);
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
