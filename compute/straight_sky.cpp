#include "compute/straight_sky.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include <glm/geometric.hpp>

#include "compute/daylight/sky_table.h"
#include "compute/lighting.h"
#include "compute/parallel.h"

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

using daylight::SkyTables;
using Samples = std::span<const StraightSky::Sample>;

[[gnu::always_inline]] inline void addSamples(const SkyTables& tables, Samples samples,
                                              SkyTables::Floats& lux) {
    SkyTables::Floats sum{}; // in a register
    for (const StraightSky::Sample& at : samples) tables.add(at.direction, at.heightIndex, at.weight, sum);
    lux = sum;
}

using AddSamples = void (*)(const SkyTables&, Samples, SkyTables::Floats&);

void narrow(const SkyTables& tables, Samples samples, SkyTables::Floats& lux) {
    addSamples(tables, samples, lux);
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] void wide(const SkyTables& tables, Samples samples, SkyTables::Floats& lux) {
    addSamples(tables, samples, lux);
}
#endif

AddSamples ofThisProcessor() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) return wide;
#endif
    return narrow;
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
                        {sample.direction, SkyTables::heightIndex(sample.direction.y), weight});
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

void StraightSky::addTo(std::span<float> lux, std::span<const daylight::Sky> skies,
                        std::span<const uint32_t> hours, const std::function<void(size_t)>& done) const {
    constexpr size_t kAtOnce = SkyTables::kSkies;
    inParallel((hours.size() + kAtOnce - 1) / kAtOnce,
               [&](size_t block) {
                   const size_t first = block * kAtOnce;
                   addTogether(lux, skies, hours.subspan(first, std::min(kAtOnce, hours.size() - first)));
               },
               [&](size_t blocks) {
                   if (done) done(std::min(blocks * kAtOnce, hours.size()));
               });
}

// At most as many as SkyTables holds.
void StraightSky::addTogether(std::span<float> lux, std::span<const daylight::Sky> skies,
                              std::span<const uint32_t> hours) const {
    std::array<const daylight::Sky*, SkyTables::kSkies> separable{};
    for (size_t k = 0; k < hours.size(); ++k)
        if (!skies[hours[k]].formula.intermediate) separable[k] = &skies[hours[k]];
    const SkyTables tables(separable);
    const AddSamples add = ofThisProcessor();
    for (size_t s = 0; s < ground_.size(); ++s) {
        const Samples samples = Samples(samples_).subspan(first_[s], first_[s + 1] - first_[s]);
        SkyTables::Floats sum;
        add(tables, samples, sum);
        for (size_t k = 0; k < hours.size(); ++k) {
            const daylight::Sky& sky = skies[hours[k]];
            if (!separable[k])
                for (const Sample& at : samples)
                    sum[k] += at.weight * static_cast<float>(sky.luminance(glm::dvec3(at.direction)));
            lux[s * skies.size() + hours[k]] +=
                sum[k] + ground_[s] * static_cast<float>(sky.ground.luminance);
        }
    }
}

} // namespace heliodon::compute
