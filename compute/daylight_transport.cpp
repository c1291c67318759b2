#include "compute/daylight_transport.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "compute/daylight/horizon_ribbon.h"
#include "compute/daylight/sky_patches.h"
#include "compute/dense_gather.h"
#include "compute/float_dot.h"
#include "compute/gpu/device.h"
#include "compute/moment_light.h"
#include "compute/parallel.h"
#include "compute/patch_slopes.h"
#include "compute/relight_basis.h"
#include "compute/ribbon_light.h"
#include "compute/sensor_gather.h"
#include "compute/sky_detail.h"
#include "compute/sloped_factors.h"
#include "compute/stopwatch.h"
#include "compute/sun_bounce.h"
#include "compute/sun_glow.h"
#include "compute/sun_patches.h"
#include "compute/window_links.h"
#include "geometry/input_error.h"

namespace heliodon::compute {

namespace {

constexpr double kPi = std::numbers::pi;

constexpr double kHemicubeRowError = 0.02; // where the kernel claims none
constexpr double kRibbonError = 0.003;     // of what a ribbon at the horizon gives straight

bool isGrey(glm::vec3 v) {
    return v.x == v.y && v.y == v.z;
}

// Illuminance coefficients of rows of viewpoints for the outside.
struct SkyRows {
    uint32_t elements = 0, channels = 1;
    std::vector<float> values;       // rows x channels x elements
    std::vector<float> error, range; // PatchSky

    // pi sum_k C L, split into sky and ground (the last element).
    void combine(size_t row, const std::vector<float>& luminance, LightParts& parts) const {
        for (uint32_t c = 0; c < 3 && elements > 0; ++c) {
            const float* from = &values[(row * channels + std::min(c, channels - 1)) * elements];
            const int axis = static_cast<int>(c);
            parts.sky[axis] =
                c >= channels ? parts.sky[0] : static_cast<float>(kPi * dot({from, elements - 1}, luminance));
            parts.ground[axis] = static_cast<float>(kPi * from[elements - 1] * luminance[elements - 1]);
        }
    }
};

} // namespace

struct DaylightTransport::State {
    gpu::Device& device;
    geometry::PatchMesh mesh;
    TransportOptions options;
    TransportReport report;
    FormFactors factors;
    std::vector<float> rowSums;
    std::vector<double> areas;
    std::unique_ptr<PointScene> points;
    std::unique_ptr<SunScene> sunScene;
    std::unique_ptr<NearPairs> nearPairs;
    std::unique_ptr<SunBounce> sunBounce; // none without openings
    std::unique_ptr<SunGlow> sunGlow;     // likewise, and where no pictures are made
    std::unique_ptr<SkyDetail> skyDetail; // likewise
    std::unique_ptr<GlowingBlinds> blinds;
    std::unique_ptr<SlatLobes> slats;
    std::unique_ptr<HiddenSky> hiddenSky; // before blinds
    std::unique_ptr<PatchSlopes> slopes;
    std::unique_ptr<SlopedFactors> sloped; // in `factors`
    std::unique_ptr<WindowLinks> links;
    std::vector<std::vector<float>> clear; // per channel: diffuse transmittance of clear interior glass
    SkyRows patchSky;
    SensorGather sensors;
    std::unique_ptr<DenseGather> gather;
    std::unique_ptr<TintedFactors> tinted; // gather with what links through panes do to colours
    std::unique_ptr<RadiositySolver> solver;
    std::unique_ptr<RelightBasis> relight;
    daylight::SkyPatches skyPatches;
    bool hasOpenings = false, grey = true, hasNearLight = false;

    State(gpu::Device& d, const geometry::PatchMesh& m, const TransportOptions& o)
        : device(d), mesh(m), options(o), skyPatches(static_cast<int>(o.skyDivision)) {}

    void makeFactors();
    std::vector<float> rowsThatReturn();
    void findOpenings();
    void makeSky();
    void makeSensors();
    void makeNearLight(const std::function<void(size_t)>& done);
    void readMaterials();
    Moment direct(const daylight::Sky& sky) const;
    std::optional<RibbonLight> ribbonOf(const daylight::Sky& sky) const;
    void skyAtSensors(Moment& moment, const daylight::Sky& even,
                      const std::optional<RibbonLight>& ribbon) const;
    void addRibbon(Moment& moment, const RibbonLight& ribbon) const;
    void sunOn(Moment& moment, const daylight::SunDisc& disc) const;
    std::vector<glm::vec3> firstBounce(const Moment& moment) const; // of the sun, as sent far
    std::vector<glm::vec3> takeSunBack(Moment& moment) const;
    void sunAtSensors(Moment& moment, const SunPatches& sun, std::span<const SunlitParts> partly) const;
    MomentScene momentScene() const;
    template<class Light> void glow(Moment& moment, const Light& light) const;
    void hideSky(Moment& moment, std::span<const double> luminances) const;
    struct PlaceErrors {
        double alike = 0;                      // one bound for all, photometric
        std::vector<float> exitance, gathered; // per patch; empty where that will do
    };
    PlaceErrors errorsByPlace(const Moment& moment, std::span<const uint32_t> channel,
                              const SolvedColumns& solved);
    float emitted(const Moment& moment, size_t patch, uint32_t channel) const;
    void solve(std::span<Moment> moments);
    void lightSensors(Moment& moment, const daylight::Sky& sky) const;
    double rowError() const {
        return factors.report.claimedRowError > 0 ? factors.report.claimedRowError : kHemicubeRowError;
    }
    uint32_t columnsPerMoment() const { return grey ? 1 : 3; }
};

void DaylightTransport::State::makeFactors() {
    const size_t n = mesh.patchCount();
    for (size_t i = 0; i < n; ++i) areas.push_back(geometry::patchArea(mesh, i));
    FormFactorOptions wanted = options.formFactors;
    wanted.forLight = true;
    factors = computeFormFactors(device, mesh, wanted);
    // Rows of a closed room sum to one; where they do not, a second kernel tells whether it is the room's
    // doing.
    constexpr double kLostLight = 0.05;
    if (factors.report.kernel == "exact" && factors.report.closureMax > kLostLight) {
        FormFactorOptions other = options.formFactors;
        other.kernel = "hemicube", other.maxError = 0, other.maxRadiosityError = 0;
        FormFactors hemicube = computeFormFactors(device, mesh, other);
        if (hemicube.report.closureRms < 0.2 * factors.report.closureRms) {
            hemicube.report.why =
                fmt::format("rows of kernel exact miss up to {:.2g} of their sum, the hemicube's {:.2g}",
                            factors.report.closureMax, hemicube.report.closureMax);
            factors = std::move(hemicube);
        }
    }
    report.formFactors = factors.report;
    nearPairs = std::make_unique<NearPairs>(mesh, factors.values); // links through windows are no near pairs
    gather = std::make_unique<DenseGather>(device, factors.values, static_cast<uint32_t>(n));
    rowSums = gather->rowSums();
}

// What of a row can come back from where it goes, for the solver's bounds: not what leaves by openings.
std::vector<float> DaylightTransport::State::rowsThatReturn() {
    std::vector<float> sums = rowSums;
    if (!links->rowSums().empty()) {
        std::vector<float> matter;
        for (uint32_t material : mesh.material) {
            const geometry::Material& m = mesh.materials[material];
            matter.push_back(m.isOpening() && isClear(m) && m.exitance == glm::vec3(0) ? 0.0f : 1.0f);
        }
        gather->gather(matter, sums, 1);
        // Through an opening goes no more than reaches it, what its blinds send back included.
        for (size_t i = 0; i < sums.size(); ++i) sums[i] = std::min(sums[i] + links->mostTint(i), rowSums[i]);
    }
    for (size_t i = 0; i < sums.size(); ++i) sums[i] += 2 * sloped->negative()[i]; // of absolute values
    return sums;
}

// What depends on which patches are glass.
void DaylightTransport::State::findOpenings() {
    hasOpenings = false;
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        hasOpenings |= mesh.twin[i] == geometry::kNoTwin && mesh.materials[mesh.material[i]].isOpening();
    points = std::make_unique<PointScene>(mesh);
    if (links) links->remove(factors.values);
    if (!sloped) {
        slopes = std::make_unique<PatchSlopes>(mesh);
        sloped = std::make_unique<SlopedFactors>(*points, *slopes, *nearPairs, rowSums, factors.values);
    }
    links = std::make_unique<WindowLinks>(*points, factors.values);
    gather->forgetFactors();
    tinted = std::make_unique<TintedFactors>(*gather, *links);
    solver = std::make_unique<RadiositySolver>(*tinted, rowsThatReturn());
    relight = std::make_unique<RelightBasis>(*tinted, *solver, areas);
    sunScene = std::make_unique<SunScene>(mesh);
    sunBounce = hasOpenings ? std::make_unique<SunBounce>(*points, *nearPairs, rowSums) : nullptr;
    sunGlow = hasOpenings && options.forPictures ? std::make_unique<SunGlow>(*points, *nearPairs) : nullptr;
    skyDetail = sunGlow ? std::make_unique<SkyDetail>(*points) : nullptr;
    blinds = std::make_unique<GlowingBlinds>(mesh);
    slats = std::make_unique<SlatLobes>(*points, *blinds, factors.values);
    hiddenSky = std::make_unique<HiddenSky>(mesh, *sunScene, *blinds, skyPatches);
    patchSky = {};
    if (hasOpenings || options.skipNothing) makeSky();
    report.skipped.clear();
    if (!hasOpenings) report.skipped.emplace_back("sky coefficients: no opening leads outside");
    if (!blinds->empty())
        report.skipped.emplace_back(
            "blinds: light that they scatter outwards, also into other windows that they face");
    report.skyElements = patchSky.elements;
}

void DaylightTransport::State::makeSky() {
    const Stopwatch clock;
    patchSky.elements = static_cast<uint32_t>(skyPatches.elementCount());
    patchSky.channels = 1;
    for (const geometry::Material& m : mesh.materials)
        if (!isGrey(m.transmittance)) patchSky.channels = 3;
    PatchSky made = patchSkyCoefficients(*points, skyPatches, patchSky.channels);
    patchSky.values = std::move(made.coefficients);
    patchSky.error = std::move(made.error), patchSky.range = std::move(made.range);
    report.skySeconds = clock.seconds();
}

void DaylightTransport::State::makeSensors() {
    const Stopwatch clock;
    sensors = gatherSensors(*points, *slopes, *slats, options.nearWalls, std::move(sensors.sensors),
                            patchSky.channels);
    hasNearLight = false;
    report.sensorsNearWalls = static_cast<size_t>(std::ranges::count(sensors.nearWall, 1));
    report.sensorsOutside.clear();
    for (size_t s = 0; s < sensors.room.size(); ++s)
        if (sensors.room[s] == geometry::kNoRoom) report.sensorsOutside.push_back(s);
    report.sensorSeconds = clock.seconds();
}

// Not with the sensors: it takes reflectances, which may change before there is light.
void DaylightTransport::State::makeNearLight(const std::function<void(size_t)>& done) {
    if (hasNearLight) return;
    const SecondsAdded clock(report.sensorSeconds);
    findNearLight(*points, *slopes, *slats, columnsPerMoment(), sensors, done);
    hasNearLight = true;
}

void DaylightTransport::State::readMaterials() {
    hasNearLight = false;
    grey = !options.skipNothing;
    for (const geometry::Material& m : mesh.materials)
        grey &= isGrey(m.reflectance) && isGrey(m.transmittance) && isGrey(m.exitance);
    report.channels = grey ? 1 : 3;
    RadiosityMatter matter = radiosityMatter(mesh, report.channels);
    // Light goes straight through clear glass (PointScene, SunPatches, WindowLinks).
    clear.assign(report.channels, std::vector<float>(mesh.patchCount(), 0));
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        if (isClear(mesh.materials[mesh.material[i]]))
            for (uint32_t ch = 0; ch < report.channels; ++ch)
                std::swap(clear[ch][i], matter.transmittance[ch][i]);
    solver->setMatter(std::move(matter));
    relight->restart();
}

// Adds light(group, patch), what blinds scatter, and says so.
template<class Light> void DaylightTransport::State::glow(Moment& moment, const Light& light) const {
    if (blinds->empty()) return;
    if (moment.glow.empty()) {
        moment.glow.assign(mesh.patchCount(), glm::vec3(0));
        moment.report.modelled.emplace_back("blinds: what they scatter");
        moment.lobes.assign(slats->rows(), glm::vec3(0));
    }
    for (size_t g = 0; g < blinds->groups().size(); ++g)
        for (uint32_t patch : blinds->groups()[g].patches) moment.glow[patch] += light(g, patch);
}

// Takes off what of the sky's glow the building hides; `luminances` of its elements.
void DaylightTransport::State::hideSky(Moment& moment, std::span<const double> luminances) const {
    inParallel(hiddenSky->patches().size(), [&](size_t k) {
        const HiddenSky::Patch& p = hiddenSky->patches()[k];
        moment.glow[p.patch] = glm::max(glm::vec3(0), moment.glow[p.patch] - hiddenSky->glow(p, luminances));
        if (!blinds->groups()[p.group].window.hasSlats()) return;
        const daylight::Window::Lobes hidden = hiddenSky->lobes(p, luminances);
        for (size_t node = 0; node < hidden.size(); ++node)
            moment.lobes[p.slats * hidden.size() + node] -= glm::vec3(hidden[node]);
    });
}

// What arrives straight from outside, on patches and at sensors.
Moment DaylightTransport::State::direct(const daylight::Sky& sky) const {
    Moment moment;
    const size_t n = mesh.patchCount();
    moment.patches.resize(n);
    moment.sensors.resize(sensors.sensors.size());
    moment.sunSent.assign(n, glm::vec3(0));
    moment.lighting.sunIlluminance.assign(n, glm::vec3(0));
    auto& modelled = moment.report.modelled;
    auto& skipped = moment.report.skipped;
    const Stopwatch combining;
    const bool all = options.skipNothing;
    if (!hasOpenings && !all) {
        skipped.emplace_back("sky and ground: no opening leads outside");
    } else if (sky.formula.scale <= 0 && sky.ground.luminance <= 0 && !all) {
        skipped.emplace_back("sky and ground: dark");
    } else {
        modelled.emplace_back("sky and ground");
        const daylight::Sky even = daylight::withoutRibbon(sky);
        std::vector<double> means = skyPatches.luminances(even);
        const std::vector<float> luminance(means.begin(), means.end());
        for (size_t i = 0; i < n; ++i) patchSky.combine(i, luminance, moment.patches[i]);
        const std::optional<RibbonLight> ribbon = ribbonOf(sky);
        skyAtSensors(moment, even, ribbon);
        if (skyDetail) moment.lighting.detail = skyDetail->of(even);
        if (ribbon) {
            addRibbon(moment, *ribbon);
            if (!hiddenSky->patches().empty()) means = skyPatches.luminances(sky);
        }
        std::vector<glm::vec3> bySky;
        for (size_t g = 0; g < blinds->groups().size(); ++g) bySky.push_back(blinds->bySky(g, sky));
        glow(moment, [&](size_t g, uint32_t) { return bySky[g]; });
        slats->fill(
            moment.lobes, [&](size_t g) { return blinds->lobesBySky(g, sky); }, [](uint32_t) { return 1.0; });
        hideSky(moment, means);
    }
    moment.report.combineSeconds = combining.seconds();

    const Stopwatch sunning;
    if (!sky.hasSun() && !all) {
        skipped.emplace_back("sun: below the horizon or behind cloud");
    } else if (!hasOpenings && !all) {
        skipped.emplace_back("sun: no opening leads outside");
    } else {
        sunOn(moment, sky.sun);
    }
    moment.report.sunSeconds = sunning.seconds();
    std::vector<glm::vec3> byLobes(n, glm::vec3(0));
    slats->light(moment.lobes, byLobes);
    for (size_t i = 0; i < n; ++i) moment.patches[i].interreflected += byLobes[i];
    return moment;
}

// Of skies that are too bright at the horizon for samples and elements of sky.
std::optional<RibbonLight> DaylightTransport::State::ribbonOf(const daylight::Sky& sky) const {
    if (!daylight::hasHorizonRibbon(sky.formula)) return std::nullopt;
    return RibbonLight(*points, sky);
}

// The sky's own formula in the directions of the samples: nothing is lost to sky elements.
void DaylightTransport::State::skyAtSensors(Moment& moment, const daylight::Sky& even,
                                            const std::optional<RibbonLight>& ribbon) const {
    inParallel(moment.sensors.size(), [&](size_t s) {
        glm::dvec3 above(0), below(0), byWalls(0);
        for (const SkySample& sample : sensors.sky.of(s))
            (sample.direction.y > 0 ? above : below) +=
                glm::dvec3(sample.weight) * even.luminance(glm::dvec3(sample.direction));
        for (const SkySample& sample : sensors.near[s].sky)
            byWalls += glm::dvec3(sample.weight) * even.luminance(glm::dvec3(sample.direction));
        moment.sensors[s].sky = glm::vec3(above);
        moment.sensors[s].ground = glm::vec3(below);
        LightParts& parts = moment.sensors[s];
        parts.interreflected += glm::vec3(byWalls);
        if (!ribbon || sensors.room[s] == geometry::kNoRoom) return;
        const Sensor& sensor = sensors.sensors[s];
        const glm::vec3 straight(ribbon->at(sensor.position, sensor.normal, sensors.room[s]));
        parts.sky += straight;
        parts.error += static_cast<float>(kRibbonError * photometric(straight));
        parts.interreflected += glm::vec3(ribbon->byWalls(sensors.near[s], sensors.room[s]));
    });
}

void DaylightTransport::State::addRibbon(Moment& moment, const RibbonLight& ribbon) const {
    moment.report.modelled.emplace_back("sky: the ribbon of light at its horizon");
    double light = 0, area = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        light += areas[i] * photometric(moment.patches[i].sky), area += areas[i];
    inParallel(mesh.patchCount(), [&](size_t i) {
        const RibbonLight::Mean mean = ribbon.onPatch(static_cast<uint32_t>(i), light / area);
        LightParts& parts = moment.patches[i];
        parts.sky += glm::vec3(mean.lux);
        parts.error += static_cast<float>(mean.error + kRibbonError * photometric(mean.lux));
    });
}

void DaylightTransport::State::sunOn(Moment& moment, const daylight::SunDisc& disc) const {
    const size_t n = mesh.patchCount();
    const SunPatches sun(*sunScene, disc.direction, options.skipNothing);
    if (!sun.canEnter() && !options.skipNothing) {
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
    if (sunBounce) sunBounce->addTo(bounced, moment.sunSent, partly, disc.normalIlluminance);
    glow(moment,
         [&](size_t g, uint32_t patch) { return strength * blinds->bySun(g, patch, sun, disc.direction); });
    slats->fill(
        moment.lobes,
        [&](size_t g) {
            return blinds->groups()[g].window.lobes(moment.lighting.sunDirection, blinds->groups()[g].normal);
        },
        [&](uint32_t patch) { return glm::dvec3(disc.normalIlluminance * sun.onOutside(patch)); });
    for (size_t i = 0; i < n; ++i) {
        moment.patches[i].sun = moment.lighting.sunIlluminance[i] *= strength;
        moment.patches[i].interreflected += bounced[i];
    }
    if (sunGlow) moment.lighting.detail.add(sunGlow->of(moment.lighting, partly, disc.normalIlluminance));
    sunAtSensors(moment, sun, partly);
}

std::vector<glm::vec3> DaylightTransport::State::firstBounce(const Moment& moment) const {
    std::vector<glm::vec3> exitance;
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        exitance.push_back(mesh.materials[mesh.material[i]].reflectance * moment.patches[i].sun +
                           moment.sunSent[i]);
    return exitance;
}

// Sunlight ends where it ends, and does not run on smoothly, as form factors have it. Returns what patches
// send less for that, as far as others get it: for the solver alone.
std::vector<glm::vec3> DaylightTransport::State::takeSunBack(Moment& moment) const {
    const size_t n = mesh.patchCount();
    std::vector<glm::vec3> lux(n, glm::vec3(0)), sent(n, glm::vec3(0));
    if (glm::length(moment.lighting.sunDirection) == 0) return sent;
    sloped->takeBack(firstBounce(moment), lux, sent);
    for (int c = 0; c < 3; ++c) {
        std::vector<float> within, beyond(n, 0); // rooms; beyond windows all light is taken for even
        for (const glm::vec3& less : sent) within.push_back(less[c]);
        links->addLinks(static_cast<uint32_t>(c), within, beyond);
        for (size_t i = 0; i < n; ++i) moment.patches[i].interreflected[c] += lux[i][c] - beyond[i];
    }
    for (size_t i = 0; i < n; ++i) sent[i] += moment.sunSent[i];
    return sent;
}

void DaylightTransport::State::sunAtSensors(Moment& moment, const SunPatches& sun,
                                            std::span<const SunlitParts> partly) const {
    if (sensors.sensors.empty()) return;
    const float strength = moment.lighting.sunNormalIlluminance.x;
    const std::vector<glm::vec3> reflected = firstBounce(moment);
    inParallel(sensors.sensors.size(), [&](size_t s) {
        const Sensor& sensor = sensors.sensors[s];
        if (sensors.room[s] == geometry::kNoRoom) return;
        moment.sensors[s].sun = strength * sun.atPoint(sensor.position, sensor.normal);
        const double unsure = photometric(strength * sun.unsureAtPoint(sensor.position, sensor.normal));
        moment.sensors[s].error += static_cast<float>(unsure);
        moment.sensors[s].interreflected += sunEdges(*points, sensors, s, partly, strength, reflected);
    });
}

// What leaves a patch before light goes between patches, lux: its own, and of what reaches it from outside.
float DaylightTransport::State::emitted(const Moment& moment, size_t patch, uint32_t channel) const {
    const auto axis = static_cast<int>(channel);
    const float rho = solver->matter().reflectance[channel][patch],
                tau = solver->matter().transmittance[channel][patch];
    const LightParts& parts = moment.patches[patch];
    float out = mesh.materials[mesh.material[patch]].exitance[axis] +
                rho * (parts.sun[axis] + parts.sky[axis] + parts.ground[axis] + parts.interreflected[axis]);
    if (!moment.glow.empty()) out += moment.glow[patch][axis];
    if (tau > 0) { // the sun goes through any as a beam
        const LightParts& other = moment.patches[static_cast<size_t>(mesh.twin[patch])];
        out += tau * (other.sky[axis] + other.ground[axis] + other.interreflected[axis]);
    }
    return out;
}

void DaylightTransport::State::solve(std::span<Moment> moments) {
    const Stopwatch clock;
    const size_t n = mesh.patchCount();
    const uint32_t perMoment = columnsPerMoment();
    std::vector<float> outgoing, lessSun;
    std::vector<uint32_t> channel;
    for (Moment& moment : moments) {
        const std::vector<glm::vec3> less = takeSunBack(moment);
        for (uint32_t c = 0; c < perMoment; ++c) {
            channel.push_back(c);
            for (size_t i = 0; i < n; ++i) {
                lessSun.push_back(less[i][static_cast<int>(c)]);
                outgoing.push_back(emitted(moment, i, c) + lessSun.back());
            }
        }
    }
    const bool anyLight =
        options.skipNothing || std::ranges::any_of(outgoing, [](float out) { return out > 0; });
    std::vector<float> exitance, gathered;
    RadiosityReport solution;
    if (anyLight) {
        solution = relight->solve(outgoing, channel, exitance, gathered, options.radiosity);
    } else {
        exitance.assign(outgoing.size(), 0), gathered.assign(outgoing.size(), 0);
    }
    const double seconds = clock.seconds() / static_cast<double>(moments.size());
    const MomentScene scene = momentScene();
    for (size_t k = 0; k < moments.size(); ++k) {
        Moment& moment = moments[k];
        moment.report.radiosity = solution;
        moment.report.solveSeconds = seconds;
        if (anyLight)
            moment.report.modelled.emplace_back("interreflection");
        else
            moment.report.skipped.emplace_back("interreflection: no light enters and nothing emits");
        if (grey)
            moment.report.skipped.emplace_back(
                "colour: all materials are grey, one channel stands for three");
        SolvedColumns solved{exitance, gathered, k * perMoment * n, {}};
        PlaceErrors errors = anyLight ? errorsByPlace(moment, channel, solved) : PlaceErrors{};
        moment.solverError = errors.alike;
        moment.exitanceErrors = std::move(errors.exitance), solved.gatheredError = errors.gathered;
        for (size_t at = solved.first; at < solved.first + perMoment * n; ++at) exitance[at] -= lessSun[at];
        lightPatches(scene, solved, moment);
        compute::lightSensors(scene, moment);
    }
}

MomentScene DaylightTransport::State::momentScene() const {
    return {mesh,       areas,      rowSums,        links->rowSums(), solver->matter(), clear,
            *slopes,    *nearPairs, *points,        sensors,          *slats,           *gather,
            rowError(), grey,       patchSky.error, patchSky.range};
}

void DaylightTransport::State::lightSensors(Moment& moment, const daylight::Sky& sky) const {
    moment.sensors.assign(sensors.sensors.size(), {});
    if ((hasOpenings && (sky.formula.scale > 0 || sky.ground.luminance > 0)) || options.skipNothing)
        skyAtSensors(moment, daylight::withoutRibbon(sky), ribbonOf(sky));
    if (glm::length(moment.lighting.sunDirection) > 0) {
        const SunPatches sun(*sunScene, sky.sun.direction, options.skipNothing);
        std::vector<SunlitParts> partly;
        (void)sun.onPatches(&partly);
        sunAtSensors(moment, sun, partly);
    }
    compute::lightSensors(momentScene(), moment);
}

// Those of the solver, where one bound for all is over kSeen of the light of more than kOften of the patches.
DaylightTransport::State::PlaceErrors
DaylightTransport::State::errorsByPlace(const Moment& moment, std::span<const uint32_t> channel,
                                        const SolvedColumns& solved) {
    constexpr double kSeen = 0.003, kOften = 0.05;
    const size_t n = mesh.patchCount(), columns = columnsPerMoment();
    const auto photometricOf = [&](std::span<const float> values, size_t i) {
        return grey ? double{values[i]} : photometric(glm::vec3(values[i], values[n + i], values[2 * n + i]));
    };
    const std::span<const float> exitance = solved.exitance.subspan(solved.first, columns * n),
                                 gathered = solved.gathered.subspan(solved.first, columns * n);
    PlaceErrors errors;
    for (size_t i = 0; i < n; ++i) // no less than what is reflected
        errors.alike = std::max(errors.alike, moment.report.radiosity.bound * photometricOf(gathered, i));
    size_t seen = 0;
    for (size_t i = 0; i < n; ++i)
        seen += errors.alike > kSeen * (photometricOf(gathered, i) + photometric(moment.patches[i].total()));
    std::vector<float> onExitance, onGathered;
    if (!options.errorByPlace || static_cast<double>(seen) < kOften * static_cast<double>(n) ||
        !solver->findErrors(channel.subspan(solved.first / n, columns), exitance, gathered, onExitance,
                            onGathered))
        return errors;
    for (size_t i = 0; i < n; ++i) {
        errors.exitance.push_back(static_cast<float>(photometricOf(onExitance, i)));
        errors.gathered.push_back(static_cast<float>(photometricOf(onGathered, i)));
    }
    return errors;
}

namespace {

// Throws InputError.
void checkMaterials(std::span<const geometry::Material> materials) {
    for (const geometry::Material& m : materials)
        for (int c = 0; c < 3; ++c)
            if (!(m.reflectance[c] >= 0 && m.reflectance[c] < 1))
                throw geometry::InputError("material", m.name,
                                           fmt::format("reflectance {} is outside [0, 1)", m.reflectance[c]));
}

} // namespace

DaylightTransport::DaylightTransport(gpu::Device& device, const geometry::PatchMesh& mesh,
                                     const TransportOptions& options)
    : state_(std::make_unique<State>(device, mesh, options)) {
    checkMaterials(mesh.materials);
    state_->makeFactors();
    state_->findOpenings();
    state_->readMaterials();
}

DaylightTransport::~DaylightTransport() = default;

void DaylightTransport::setMaterials(const std::vector<geometry::Material>& materials) {
    if (materials.size() != state_->mesh.materials.size())
        throw geometry::InputError(
            "materials", "",
            fmt::format("{} given, the mesh has {}", materials.size(), state_->mesh.materials.size()));
    checkMaterials(materials);
    bool glassChanged = false;
    for (size_t k = 0; k < materials.size(); ++k) {
        const geometry::Material &before = state_->mesh.materials[k], &now = materials[k];
        glassChanged |= before.transmittance != now.transmittance ||
                        before.refractiveIndex != now.refractiveIndex || before.blind != now.blind;
    }
    state_->mesh.materials = materials;
    if (glassChanged) {
        state_->findOpenings();
        if (!state_->sensors.sensors.empty()) state_->makeSensors();
    }
    state_->readMaterials();
}

void DaylightTransport::setSensors(std::vector<Sensor> sensors) {
    state_->sensors.sensors = std::move(sensors);
    state_->makeSensors();
}

Moment DaylightTransport::light(const daylight::Sky& sky) {
    return std::move(light(std::span(&sky, 1))[0]);
}

void DaylightTransport::makeNearLight(const std::function<void(size_t)>& done) {
    state_->makeNearLight(done);
}

std::vector<Moment> DaylightTransport::light(std::span<const daylight::Sky> skies) {
    std::vector<Moment> moments;
    makeNearLight();
    for (const daylight::Sky& sky : skies) moments.push_back(state_->direct(sky));
    if (!moments.empty()) state_->solve(moments);
    return moments;
}

void DaylightTransport::forgetLights() {
    state_->relight->restart();
}

void DaylightTransport::lightSensors(Moment& moment, const daylight::Sky& sky) {
    makeNearLight();
    state_->lightSensors(moment, sky);
}

TransportParts DaylightTransport::parts() {
    State& state = *state_;
    state.makeNearLight({});
    return {state.device,
            *state.solver,
            *state.tinted,
            *state.sloped,
            state.gather->hostBytes(),
            state.columnsPerMoment(),
            state.patchSky.elements,
            state.patchSky.channels,
            state.patchSky.values,
            state.sensors.sky,
            state.sensors.smooth,
            state.sensors.even,
            state.sensors.sensors,
            state.sensors.room,
            state.sensors.tinted,
            state.sensors.near,
            *state.links,
            *state.points,
            state.skyPatches,
            *state.sunScene,
            state.sunBounce.get(),
            *state.blinds,
            *state.hiddenSky,
            *state.slats,
            state.sensors.slats};
}

const geometry::PatchMesh& DaylightTransport::mesh() const {
    return state_->mesh;
}
const FormFactors& DaylightTransport::formFactors() const {
    return state_->factors;
}
const TransportReport& DaylightTransport::report() const {
    return state_->report;
}

} // namespace heliodon::compute
