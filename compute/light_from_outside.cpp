#include "compute/light_from_outside.h"

#include <algorithm>
#include <numbers>

#include <glm/geometric.hpp>

#include "compute/daylight/horizon_ribbon.h"
#include "compute/float_dot.h"
#include "compute/parallel.h"
#include "compute/stopwatch.h"

namespace heliodon::compute {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRibbonError = 0.003; // of what a ribbon at the horizon gives straight

struct Received {
    glm::vec3 lux{0};
    float unsure = 0; // lux
};
Received received(std::span<const OutsideShare> shares, std::span<const OutsideCell> cells,
                  std::span<const glm::vec3> exitance) {
    Received all;
    for (const OutsideShare& share : shares) {
        const glm::vec3 lux = share.weight * exitance[share.cell];
        all.lux += lux;
        all.unsure += cells[share.cell].unsure * static_cast<float>(photometric(lux));
    }
    return all;
}

} // namespace

LightFromOutside::LightFromOutside(const PointScene& points, const NearPairs& pairs,
                                   std::span<const float> rowSums, const gpu::Buffer& factors,
                                   const daylight::SkyPatches& sky, const TransportOptions& options)
    : points_(points), mesh_(points.mesh()), sky_(sky), skipNothing_(options.skipNothing),
      sunScene_(mesh_, options.sunDisc), blinds_(mesh_), slats_(points, blinds_, factors),
      hiddenSky_(mesh_, sunScene_, blinds_, sky), reflection_(points, sky),
      outsideOnBlinds_(points, blinds_) {
    for (size_t i = 0; i < mesh_.patchCount(); ++i)
        hasOpenings_ |= mesh_.twin[i] == geometry::kNoTwin && mesh_.materials[mesh_.material[i]].isOpening();
    if (hasOpenings_) sunBounce_ = std::make_unique<SunBounce>(points, pairs, rowSums);
    if (hasOpenings_ && options.forPictures) {
        sunGlow_ = std::make_unique<SunGlow>(points, pairs);
        skyDetail_ = std::make_unique<SkyDetail>(points);
    }
    if (!hasOpenings_ && !skipNothing_) return;
    const Stopwatch clock;
    skyElements_ = static_cast<uint32_t>(sky.elementCount());
    for (const geometry::Material& m : mesh_.materials)
        if (!geometry::isGrey(m.transmittance)) skyChannels_ = 3;
    if (!reflection_.isGrey()) skyChannels_ = 3;
    patchSky_ = patchSkyCoefficients(points, sky, skyChannels_);
    skySeconds_ = clock.seconds();
}

bool LightFromOutside::isLitBySky(const daylight::Sky& sky) const {
    return (hasOpenings_ && (sky.formula.scale > 0 || sky.ground.luminance > 0)) || skipNothing_;
}

Moment LightFromOutside::light(const daylight::Sky& sky, const SensorGather& sensors) const {
    Moment moment;
    const size_t n = mesh_.patchCount();
    moment.patches.resize(n);
    moment.sensors.resize(sensors.sensors.size());
    moment.sunSent.assign(n, glm::vec3(0));
    moment.lighting.sunIlluminance.assign(n, glm::vec3(0));
    auto& skipped = moment.report.skipped;
    const Stopwatch combining;
    if (isLitBySky(sky))
        skyOn(moment, sky, sensors);
    else
        skipped.emplace_back(hasOpenings_ ? "sky and ground: dark"
                                          : "sky and ground: no opening leads outside");
    moment.report.combineSeconds = combining.seconds();

    const Stopwatch sunning;
    const std::optional<SunPatches> sun = sunOf(sky);
    if (!sky.hasSun() && !skipNothing_)
        skipped.emplace_back("sun: below the horizon or behind cloud");
    else if (!hasOpenings_ && !skipNothing_)
        skipped.emplace_back("sun: no opening leads outside");
    else
        sunOn(moment, sky.sun, sensors, *sun);
    moment.report.sunSeconds = sunning.seconds();
    reflect(moment, sky, sensors, sun ? &*sun : nullptr);

    std::vector<glm::vec3> byLobes(n, glm::vec3(0));
    slats_.light(moment.lobes, byLobes);
    for (size_t i = 0; i < n; ++i) moment.patches[i].interreflected += byLobes[i];
    return moment;
}

void LightFromOutside::lightSensors(Moment& moment, const daylight::Sky& sky,
                                    const SensorGather& sensors) const {
    if (isLitBySky(sky)) skyAtSensors(moment, daylight::withoutRibbon(sky), ribbonOf(sky), sensors);
    const std::optional<SunPatches> sun = sunOf(sky);
    if (!reflection_.isEmpty())
        reflectAtSensors(moment, outsideExitance(sky, sun ? &*sun : nullptr), sensors);
    if (glm::length(moment.lighting.sunDirection) == 0) return;
    std::vector<SunlitParts> partly;
    (void)sun->onPatches(&partly);
    sunAtSensors(moment, *sun, partly, sensors);
}

std::vector<glm::vec3> LightFromOutside::firstBounce(const Moment& moment) const {
    std::vector<glm::vec3> exitance;
    for (size_t i = 0; i < mesh_.patchCount(); ++i)
        exitance.push_back(mesh_.materials[mesh_.material[i]].reflectance * moment.patches[i].sun +
                           moment.sunSent[i]);
    return exitance;
}

// Of a sky with a sun, projected for all that it may light.
std::optional<SunPatches> LightFromOutside::sunOf(const daylight::Sky& sky) const {
    if (!skipNothing_ && (!sky.hasSun() || !hasOpenings_)) return std::nullopt;
    return std::optional<SunPatches>(std::in_place, sunScene_, sky.sun.direction,
                                     skipNothing_ || !reflection_.isEmpty());
}

// Of skies that are too bright at the horizon for samples and elements of sky.
std::optional<RibbonLight> LightFromOutside::ribbonOf(const daylight::Sky& sky) const {
    if (!daylight::hasHorizonRibbon(sky.formula)) return std::nullopt;
    return RibbonLight(points_, sky);
}

void LightFromOutside::skyOn(Moment& moment, const daylight::Sky& sky, const SensorGather& sensors) const {
    moment.report.modelled.emplace_back("sky and ground");
    const daylight::Sky even = daylight::withoutRibbon(sky);
    std::vector<double> means = sky_.luminances(even);
    skyOnPatches(moment, std::vector<float>(means.begin(), means.end()));
    const std::optional<RibbonLight> ribbon = ribbonOf(sky);
    skyAtSensors(moment, even, ribbon, sensors);
    if (skyDetail_) moment.lighting.detail = skyDetail_->of(even);
    if (ribbon) {
        addRibbon(moment, *ribbon);
        if (!hiddenSky_.patches().empty()) means = sky_.luminances(sky);
    }
    std::vector<glm::vec3> bySky;
    for (size_t g = 0; g < blinds_.groups().size(); ++g) bySky.push_back(blinds_.bySky(g, sky));
    glow(moment, [&](size_t g, uint32_t) { return bySky[g]; });
    slats_.fill(
        moment.lobes, [&](size_t g) { return blinds_.lobesBySky(g, sky); }, [](uint32_t) { return 1.0; });
    hideSky(moment, means);
}

// pi sum_k C L, split into sky and ground (the last element).
void LightFromOutside::skyOnPatches(Moment& moment, std::span<const float> luminance) const {
    const size_t above = skyElements_ - 1;
    for (size_t i = 0; i < mesh_.patchCount(); ++i)
        for (uint32_t c = 0; c < 3; ++c) {
            const auto axis = static_cast<int>(c);
            LightParts& parts = moment.patches[i];
            const float* from =
                &patchSky_.coefficients[(i * skyChannels_ + std::min(c, skyChannels_ - 1)) * skyElements_];
            parts.sky[axis] = c >= skyChannels_
                                  ? parts.sky[0]
                                  : static_cast<float>(kPi * dot({from, above}, luminance.first(above)));
            parts.ground[axis] = static_cast<float>(kPi * from[above] * luminance[above]);
        }
}

// The sky's own formula in the directions of the samples: nothing is lost to sky elements.
void LightFromOutside::skyAtSensors(Moment& moment, const daylight::Sky& even,
                                    const std::optional<RibbonLight>& ribbon,
                                    const SensorGather& sensors) const {
    inParallel(moment.sensors.size(), [&](size_t s) {
        glm::dvec3 above(0), below(0), byWalls(0);
        for (const SkySample& sample : sensors.sky.of(s))
            (sample.direction.y > 0 ? above : below) +=
                glm::dvec3(sample.weight) * even.luminance(glm::dvec3(sample.direction));
        for (const SkySample& sample : sensors.near[s].sky)
            byWalls += glm::dvec3(sample.weight) * even.luminance(glm::dvec3(sample.direction));
        LightParts& parts = moment.sensors[s];
        parts.sky = glm::vec3(above);
        parts.ground = glm::vec3(below);
        parts.interreflected += glm::vec3(byWalls);
        if (!ribbon || sensors.room[s] == geometry::kNoRoom) return;
        const Sensor& sensor = sensors.sensors[s];
        const glm::vec3 straight(ribbon->at(sensor.position, sensor.normal, sensors.room[s]));
        parts.sky += straight;
        parts.error += static_cast<float>(kRibbonError * photometric(straight));
        parts.interreflected += glm::vec3(ribbon->byWalls(sensors.near[s], sensors.room[s]));
    });
}

void LightFromOutside::addRibbon(Moment& moment, const RibbonLight& ribbon) const {
    moment.report.modelled.emplace_back("sky: the ribbon of light at its horizon");
    double light = 0, area = 0;
    for (size_t i = 0; i < mesh_.patchCount(); ++i) {
        const double own = geometry::patchArea(mesh_, i);
        light += own * photometric(moment.patches[i].sky), area += own;
    }
    inParallel(mesh_.patchCount(), [&](size_t i) {
        const RibbonLight::Mean mean = ribbon.onPatch(static_cast<uint32_t>(i), light / area);
        LightParts& parts = moment.patches[i];
        parts.sky += glm::vec3(mean.lux);
        parts.error += static_cast<float>(mean.error + kRibbonError * photometric(mean.lux));
    });
}

// Adds light(group, patch), what blinds scatter, and says so.
template<class Light> void LightFromOutside::glow(Moment& moment, const Light& light) const {
    if (blinds_.empty()) return;
    if (moment.glow.empty()) {
        moment.glow.assign(mesh_.patchCount(), glm::vec3(0));
        moment.report.modelled.emplace_back("blinds: what they scatter");
        moment.lobes.assign(slats_.rows(), glm::vec3(0));
    }
    for (size_t g = 0; g < blinds_.groups().size(); ++g)
        for (uint32_t patch : blinds_.groups()[g].patches) moment.glow[patch] += light(g, patch);
}

// Takes off what of the sky's glow the building hides; `luminances` of its elements.
void LightFromOutside::hideSky(Moment& moment, std::span<const double> luminances) const {
    inParallel(hiddenSky_.patches().size(), [&](size_t k) {
        const HiddenSky::Patch& p = hiddenSky_.patches()[k];
        moment.glow[p.patch] = glm::max(glm::vec3(0), moment.glow[p.patch] - hiddenSky_.glow(p, luminances));
        if (!blinds_.groups()[p.group].window.hasSlats()) return;
        const daylight::Window::Lobes hidden = hiddenSky_.lobes(p, luminances);
        for (size_t node = 0; node < hidden.size(); ++node)
            moment.lobes[p.slats * hidden.size() + node] -= glm::vec3(hidden[node]);
    });
}

// Of the cells of what stands outside.
std::vector<glm::vec3> LightFromOutside::outsideExitance(const daylight::Sky& sky,
                                                         const SunPatches* sun) const {
    std::vector<glm::vec3> straight(reflection_.cells().size(), glm::vec3(0));
    const std::vector<float> bySky = reflection_.skyLight(sky_.luminances(sky));
    for (size_t c = 0; c < straight.size(); ++c) straight[c] = glm::vec3(bySky[c]);
    if (sky.hasSun()) {
        const std::vector<glm::vec3> bySun = reflection_.sunlight(*sun);
        for (size_t c = 0; c < straight.size(); ++c)
            straight[c] += static_cast<float>(sky.sun.normalIlluminance) * bySun[c];
    }
    return reflection_.exitance(straight);
}

void LightFromOutside::reflect(Moment& moment, const daylight::Sky& sky, const SensorGather& sensors,
                               const SunPatches* sun) const {
    if (reflection_.isEmpty()) {
        if (hasOpenings_) moment.report.skipped.push_back(reflection_.inWords());
        return;
    }
    if (sky.isDark()) {
        moment.report.skipped.emplace_back("what stands outside: dark");
        return;
    }
    moment.report.modelled.push_back(reflection_.inWords());
    const std::vector<glm::vec3> exitance = outsideExitance(sky, sun);
    for (size_t i = 0; i < patchSky_.walls.size(); ++i) {
        const auto [lux, unsure] = received(patchSky_.walls[i], reflection_.cells(), exitance);
        moment.patches[i].ground += lux;
        moment.patches[i].error += unsure;
        moment.unsureLumens += geometry::patchArea(mesh_, i) * double{unsure};
    }
    reflectAtSensors(moment, exitance, sensors);
    if (outsideOnBlinds_.patches().empty()) return;
    glow(moment, [](size_t, uint32_t) { return glm::vec3(0); });
    for (const OutsideOnBlinds::Patch& p : outsideOnBlinds_.patches()) {
        const auto [lux, unsure] = received(p.shares, reflection_.cells(), exitance);
        moment.glow[p.patch] += lux;
        moment.unsureLumens += geometry::patchArea(mesh_, p.patch) * double{unsure};
    }
}

void LightFromOutside::reflectAtSensors(Moment& moment, std::span<const glm::vec3> exitance,
                                        const SensorGather& sensors) const {
    for (size_t s = 0; s < moment.sensors.size(); ++s) {
        const Received straight = received(sensors.walls[s], reflection_.cells(), exitance),
                       byWalls = received(sensors.near[s].walls, reflection_.cells(), exitance);
        LightParts& parts = moment.sensors[s];
        parts.ground += straight.lux;
        parts.interreflected += byWalls.lux;
        parts.error += straight.unsure + byWalls.unsure;
    }
}

void LightFromOutside::sunOn(Moment& moment, const daylight::SunDisc& disc, const SensorGather& sensors,
                             const SunPatches& sun) const {
    const size_t n = mesh_.patchCount();
    if (!sun.canEnter() && !skipNothing_) {
        moment.report.skipped.emplace_back("sun: shines on no opening from outside");
        return;
    }
    moment.report.modelled.emplace_back("sun");
    moment.lighting.sunDirection = glm::normalize(disc.direction);
    const auto strength = static_cast<float>(disc.normalIlluminance);
    moment.lighting.sunNormalIlluminance = glm::vec3(strength);
    std::vector<SunlitParts> partly;
    moment.lighting.sunIlluminance = sun.onPatches(&partly);
    std::vector<glm::vec3> bounced(n, glm::vec3(0));
    if (sunBounce_) sunBounce_->addTo(bounced, moment.sunSent, partly, disc.normalIlluminance);
    glow(moment,
         [&](size_t g, uint32_t patch) { return strength * blinds_.bySun(g, patch, sun, disc.direction); });
    slats_.fill(
        moment.lobes,
        [&](size_t g) {
            return blinds_.groups()[g].window.lobes(moment.lighting.sunDirection, blinds_.groups()[g].normal);
        },
        [&](uint32_t patch) { return glm::dvec3(disc.normalIlluminance * sun.onOutside(patch)); });
    for (size_t i = 0; i < n; ++i) {
        moment.patches[i].sun = moment.lighting.sunIlluminance[i] *= strength;
        moment.patches[i].interreflected += bounced[i];
    }
    if (sunGlow_) moment.lighting.detail.add(sunGlow_->of(moment.lighting, partly, disc.normalIlluminance));
    sunAtSensors(moment, sun, partly, sensors);
}

void LightFromOutside::sunAtSensors(Moment& moment, const SunPatches& sun,
                                    std::span<const SunlitParts> partly, const SensorGather& sensors) const {
    if (sensors.sensors.empty()) return;
    const float strength = moment.lighting.sunNormalIlluminance.x;
    const std::vector<glm::vec3> reflected = firstBounce(moment);
    inParallel(sensors.sensors.size(), [&](size_t s) {
        const Sensor& sensor = sensors.sensors[s];
        if (sensors.room[s] == geometry::kNoRoom) return;
        LightParts& parts = moment.sensors[s];
        const auto [share, unsure] = sun.beamAtPoint(sensor.position, sensor.normal);
        parts.sun = strength * share;
        parts.error += static_cast<float>(photometric(strength * unsure));
        parts.interreflected += sunEdges(points_, sensors, s, partly, strength, reflected);
    });
}

} // namespace heliodon::compute
