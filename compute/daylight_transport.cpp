#include "compute/daylight_transport.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "compute/daylight/sky_patches.h"
#include "compute/float_dot.h"
#include "compute/gpu/device.h"
#include "compute/parallel.h"
#include "compute/patch_slopes.h"
#include "compute/radiosity_gather.h"
#include "compute/relight_basis.h"
#include "compute/sensor_gather.h"
#include "compute/stopwatch.h"
#include "compute/sun_patches.h"
#include "compute/window_links.h"
#include "geometry/input_error.h"

namespace heliodon::compute {

namespace {

constexpr double kPi = std::numbers::pi;

// Shares of light by which errors are estimated. The first is of what is measured: how much light varies
// within the patches that a sensor sees. Set so that rooms of 600 to 2000 triangles stay inside on 99 of 100
// sensors, against Radiance.
constexpr double kSpreadShare = 0.05;  // of light's variation within patches, after its slope is allowed for
constexpr double kNearShare = 0.5;     // of a patch's light, times its own share of the view
constexpr double kBounceError = 0.006; // of reflected light: what earlier bounces between patches leave
constexpr double kSensorSkyError = 0.008; // of sky light, from its cubature and that of glass
constexpr double kPatchSkyError = 0.01;   // the same for four points a patch and sky elements
constexpr double kPatchError = 0.02;      // of reflected light on a patch
constexpr double kHemicubeRowError = 0.02;

bool isGrey(glm::vec3 v) {
    return v.x == v.y && v.y == v.z;
}

// Illuminance coefficients of rows of viewpoints for the outside.
struct SkyRows {
    uint32_t elements = 0, channels = 1;
    std::vector<float> values; // rows x channels x elements

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
    std::unique_ptr<GlowingBlinds> blinds;
    std::unique_ptr<PatchSlopes> slopes;
    std::unique_ptr<WindowLinks> links;
    std::vector<std::vector<float>> clear; // per channel: diffuse transmittance of clear interior glass
    SkyRows patchSky;
    SensorGather sensors;
    std::unique_ptr<RadiosityGather> gather;
    std::unique_ptr<RadiositySolver> solver;
    std::unique_ptr<RelightBasis> relight;
    daylight::SkyPatches skyPatches;
    bool hasOpenings = false, grey = true;

    State(gpu::Device& d, const geometry::PatchMesh& m, const TransportOptions& o)
        : device(d), mesh(m), options(o), skyPatches(static_cast<int>(o.skyDivision)) {}

    void makeFactors();
    std::vector<float> rowsThatReturn();
    void findOpenings();
    void makeSky();
    void makeSensors();
    void readMaterials();
    Moment direct(const daylight::Sky& sky) const;
    void skyAtSensors(Moment& moment, const daylight::Sky& sky) const;
    void sunOn(Moment& moment, const daylight::SunDisc& disc) const;
    template<class Light> void glow(Moment& moment, const Light& light) const;
    void solve(std::span<Moment> moments);
    void finish(Moment& moment, const std::vector<float>& exitance, const std::vector<float>& gathered,
                size_t firstColumn) const;
    void atSensors(Moment& moment, const std::vector<float>& exitance, size_t firstColumn) const;
    std::vector<float> spreadWithin(const std::vector<float> (&smooth)[3]) const;
    double rowError() const {
        return factors.report.claimedRowError > 0 ? factors.report.claimedRowError : kHemicubeRowError;
    }
    uint32_t columnsPerMoment() const { return grey ? 1 : 3; }
};

void DaylightTransport::State::makeFactors() {
    const size_t n = mesh.patchCount();
    for (size_t i = 0; i < n; ++i) areas.push_back(geometry::patchArea(mesh, i));
    factors = computeFormFactors(device, mesh, options.formFactors);
    // Rows of a closed room sum to one; where they do not, a second kernel tells whether it is the room's
    // doing.
    constexpr double kLostLight = 0.05;
    if (factors.report.kernel == "exact" && factors.report.closureMax > kLostLight) {
        FormFactorOptions other = options.formFactors;
        other.kernel = "hemicube", other.maxError = 0;
        FormFactors hemicube = computeFormFactors(device, mesh, other);
        if (hemicube.report.closureRms < 0.2 * factors.report.closureRms) {
            hemicube.report.why =
                fmt::format("rows of kernel exact miss up to {:.2g} of their sum, the hemicube's {:.2g}",
                            factors.report.closureMax, hemicube.report.closureMax);
            factors = std::move(hemicube);
        }
    }
    report.formFactors = factors.report;
    gather = std::make_unique<RadiosityGather>(device, factors.values, static_cast<uint32_t>(n));
    rowSums = gather->rowSums();
}

// What of a row can come back from where it goes, for the solver's bounds: not what leaves by openings.
std::vector<float> DaylightTransport::State::rowsThatReturn() {
    if (links->rowSums().empty()) return rowSums;
    std::vector<float> matter, sums(mesh.patchCount());
    for (uint32_t material : mesh.material) {
        const geometry::Material& m = mesh.materials[material];
        matter.push_back(m.isOpening() && isClear(m) && m.exitance == glm::vec3(0) ? 0.0f : 1.0f);
    }
    gather->gather(matter, sums, 1);
    // Through an opening goes no more than reaches it, what its blinds send back included.
    for (size_t i = 0; i < sums.size(); ++i) sums[i] = std::min(sums[i], rowSums[i]);
    return sums;
}

// What depends on which patches are glass.
void DaylightTransport::State::findOpenings() {
    hasOpenings = false;
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        hasOpenings |= mesh.twin[i] == geometry::kNoTwin && mesh.materials[mesh.material[i]].isOpening();
    points = std::make_unique<PointScene>(mesh);
    if (!slopes) slopes = std::make_unique<PatchSlopes>(mesh);
    if (links) links->remove(factors.values);
    links = std::make_unique<WindowLinks>(*points, factors.values);
    solver = std::make_unique<RadiositySolver>(*gather, rowsThatReturn());
    relight = std::make_unique<RelightBasis>(*gather, *solver);
    sunScene = std::make_unique<SunScene>(mesh);
    blinds = std::make_unique<GlowingBlinds>(mesh);
    patchSky = {};
    if (hasOpenings || options.skipNothing) makeSky();
    if (!hasOpenings) report.skipped.emplace_back("sky coefficients: no opening leads outside");
    report.skyElements = patchSky.elements;
}

void DaylightTransport::State::makeSky() {
    const Stopwatch clock;
    patchSky.elements = static_cast<uint32_t>(skyPatches.elementCount());
    patchSky.channels = 1;
    for (const geometry::Material& m : mesh.materials)
        if (!isGrey(m.transmittance)) patchSky.channels = 3;
    patchSky.values = patchSkyCoefficients(*points, skyPatches, patchSky.channels);
    report.skySeconds = clock.seconds();
}

void DaylightTransport::State::makeSensors() {
    const Stopwatch clock;
    sensors = gatherSensors(*points, *slopes, std::move(sensors.sensors), skyPatches, patchSky.channels);
    report.sensorsOutside =
        static_cast<size_t>(std::count(sensors.room.begin(), sensors.room.end(), kNoRoom));
    report.sensorSeconds = clock.seconds();
}

void DaylightTransport::State::readMaterials() {
    grey = !options.skipNothing;
    for (const geometry::Material& m : mesh.materials) {
        for (int c = 0; c < 3; ++c)
            if (!(m.reflectance[c] >= 0 && m.reflectance[c] < 1))
                throw geometry::InputError("material", m.name,
                                           fmt::format("reflectance {} is outside [0, 1)", m.reflectance[c]));
        grey &= isGrey(m.reflectance) && isGrey(m.transmittance) && isGrey(m.exitance);
    }
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
    }
    for (size_t g = 0; g < blinds->groups().size(); ++g)
        for (uint32_t patch : blinds->groups()[g].patches) moment.glow[patch] += light(g, patch);
}

// What arrives straight from outside, on patches and at sensors.
Moment DaylightTransport::State::direct(const daylight::Sky& sky) const {
    Moment moment;
    const size_t n = mesh.patchCount();
    moment.patches.resize(n);
    moment.sensors.resize(sensors.sensors.size());
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
        const std::vector<double> means = skyPatches.luminances(sky);
        const std::vector<float> luminance(means.begin(), means.end());
        for (size_t i = 0; i < n; ++i) patchSky.combine(i, luminance, moment.patches[i]);
        skyAtSensors(moment, sky);
        std::vector<glm::vec3> bySky;
        for (size_t g = 0; g < blinds->groups().size(); ++g) bySky.push_back(blinds->bySky(g, sky));
        glow(moment, [&](size_t g, uint32_t) { return bySky[g]; });
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
    return moment;
}

// The sky's own formula in the directions of the samples: nothing is lost to sky elements.
void DaylightTransport::State::skyAtSensors(Moment& moment, const daylight::Sky& sky) const {
    inParallel(moment.sensors.size(), [&](size_t s) {
        glm::dvec3 above(0), below(0);
        for (const SkySample& sample : sensors.sky.of(s))
            (sample.direction.y > 0 ? above : below) +=
                glm::dvec3(sample.weight) * sky.luminance(glm::dvec3(sample.direction));
        moment.sensors[s].sky = glm::vec3(above);
        moment.sensors[s].ground = glm::vec3(below);
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
    moment.lighting.sunIlluminance = sun.onPatches(sensors.sensors.empty() ? nullptr : &partly);
    glow(moment,
         [&](size_t g, uint32_t patch) { return strength * blinds->bySun(g, patch, sun, disc.direction); });
    std::vector<glm::vec3> firstBounce(n);
    for (size_t i = 0; i < n; ++i) {
        moment.patches[i].sun = moment.lighting.sunIlluminance[i] *= strength;
        firstBounce[i] = mesh.materials[mesh.material[i]].reflectance * moment.patches[i].sun;
    }
    inParallel(sensors.sensors.size(), [&](size_t s) {
        const Sensor& sensor = sensors.sensors[s];
        if (sensors.room[s] == kNoRoom) return;
        moment.sensors[s].sun = strength * sun.atPoint(sensor.position, sensor.normal);
        moment.sensors[s].interreflected = sunEdges(*points, sensors, s, partly, strength, firstBounce);
    });
}

void DaylightTransport::State::solve(std::span<Moment> moments) {
    const Stopwatch clock;
    const size_t n = mesh.patchCount();
    const uint32_t perMoment = columnsPerMoment();
    const RadiosityMatter& matter = solver->matter();
    std::vector<float> emitted;
    std::vector<uint32_t> channel;
    bool anyLight = options.skipNothing;
    for (const Moment& moment : moments)
        for (uint32_t c = 0; c < perMoment; ++c) {
            const auto axis = static_cast<int>(c);
            channel.push_back(c);
            const auto &rho = matter.reflectance[c], &tau = matter.transmittance[c];
            for (size_t i = 0; i < n; ++i) {
                const LightParts& parts = moment.patches[i];
                float out = mesh.materials[mesh.material[i]].exitance[axis] +
                            rho[i] * (parts.sun[axis] + parts.sky[axis] + parts.ground[axis]);
                if (!moment.glow.empty()) out += moment.glow[i][axis];
                if (tau[i] > 0) { // the sun goes through any as a beam
                    const LightParts& other = moment.patches[static_cast<size_t>(mesh.twin[i])];
                    out += tau[i] * (other.sky[axis] + other.ground[axis]);
                }
                anyLight |= out > 0;
                emitted.push_back(out);
            }
        }
    std::vector<float> exitance, gathered;
    RadiosityReport solved;
    if (anyLight) {
        solved = relight->solve(emitted, channel, exitance, gathered, options.radiosity);
    } else {
        exitance.assign(emitted.size(), 0), gathered.assign(emitted.size(), 0);
    }
    const double seconds = clock.seconds() / static_cast<double>(moments.size());
    for (size_t k = 0; k < moments.size(); ++k) {
        Moment& moment = moments[k];
        moment.report.radiosity = solved;
        moment.report.solveSeconds = seconds;
        if (anyLight)
            moment.report.modelled.emplace_back("interreflection");
        else
            moment.report.skipped.emplace_back("interreflection: no light enters and nothing emits");
        if (grey)
            moment.report.skipped.emplace_back("colour: all materials are grey, one channel stands for three");
        finish(moment, exitance, gathered, k * perMoment * n);
        atSensors(moment, exitance, k * perMoment * n);
    }
}

void DaylightTransport::State::finish(Moment& moment, const std::vector<float>& exitance,
                                      const std::vector<float>& gathered, size_t first) const {
    const size_t n = mesh.patchCount();
    moment.lighting.exitance.resize(n);
    const std::vector<float>& linked = links->rowSums();
    double in = 0, absorbed = 0, lost = 0, mean = 0, total = 0, most = 0;
    for (size_t i = 0; i < n; ++i) {
        LightParts& parts = moment.patches[i];
        const geometry::Material& m = mesh.materials[mesh.material[i]];
        glm::vec3 out(0), tau(0), straight(0);
        for (int c = 0; c < 3; ++c) {
            const size_t channel = static_cast<size_t>(grey ? 0 : c), at = first + channel * n + i;
            out[c] = exitance[at];
            parts.interreflected[c] = gathered[at];
            tau[c] = solver->matter().transmittance[channel][i];
            straight[c] = clear[channel][i];
        }
        moment.lighting.exitance[i] = out;
        const glm::vec3 direct = parts.sun + parts.sky + parts.ground;
        in += areas[i] * photometric(m.exitance + direct);
        if (!moment.glow.empty()) in += areas[i] * photometric(moment.glow[i]);
        // What goes straight on counts where it lands.
        const glm::vec3 on = straight * direct + tau * parts.sun;
        in -= areas[i] * photometric(on);
        absorbed +=
            areas[i] * photometric((glm::vec3(1) - m.reflectance - tau) * parts.total() - straight * direct);
        if (!linked.empty()) absorbed -= areas[i] * double{linked[i]} * photometric(out);
        lost += areas[i] * (1 - double{rowSums[i]}) * photometric(out);
        mean += areas[i] * photometric(out);
        total += areas[i];
        most = std::max(most, photometric(out));
    }
    mean /= std::max(total, 1e-30);
    for (size_t i = 0; i < n; ++i) {
        LightParts& parts = moment.patches[i];
        parts.error +=
            static_cast<float>(std::abs(1 - rowSums[i]) * mean + moment.report.radiosity.bound * most +
                               (rowError() + kPatchError) * photometric(parts.interreflected) +
                               kPatchSkyError * photometric(parts.sky + parts.ground));
    }
    moment.report.lumensIn = in;
    moment.report.lumensAbsorbed = absorbed;
    moment.report.lumensLost = lost;
    moment.report.energyImbalance = in > 0 ? std::abs(in - absorbed - lost) / in : 0;
}

// How much the light that runs on smoothly changes across each patch, photometric; `smooth` per channel.
std::vector<float> DaylightTransport::State::spreadWithin(const std::vector<float> (&smooth)[3]) const {
    const size_t n = mesh.patchCount();
    std::vector<float> light(n), spread(n);
    for (size_t i = 0; i < n; ++i)
        light[i] =
            grey ? smooth[0][i] : static_cast<float>(photometric({smooth[0][i], smooth[1][i], smooth[2][i]}));
    for (size_t i = 0; i < n; ++i) {
        glm::vec3 slope(0);
        for (const PatchSlopes::Term& term : slopes->terms(i)) slope += light[term.patch] * term.weight;
        spread[i] = glm::length(slope) * static_cast<float>(points->patches()[i].size);
    }
    return spread;
}

void DaylightTransport::State::atSensors(Moment& moment, const std::vector<float>& exitance,
                                         size_t first) const {
    const Stopwatch clock;
    const size_t n = mesh.patchCount();
    double most = 0;
    for (const glm::vec3& out : moment.lighting.exitance) most = std::max(most, photometric(out));
    // Sunlight has edges, and is even but for those (sunEdges has put them in already); all else runs on
    // smoothly.
    const bool sun = glm::length(moment.lighting.sunDirection) > 0;
    std::vector<float> even[3], smooth[3];
    for (int c = 0; c < (grey ? 1 : 3); ++c) {
        smooth[c].assign(&exitance[first + static_cast<size_t>(c) * n],
                         &exitance[first + static_cast<size_t>(c) * n] + n);
        if (!sun) continue;
        even[c].resize(n);
        for (size_t i = 0; i < n; ++i) {
            even[c][i] = mesh.materials[mesh.material[i]].reflectance[c] * moment.patches[i].sun[c];
            smooth[c][i] -= even[c][i];
        }
    }
    const std::vector<float> spread = moment.sensors.empty() ? std::vector<float>{} : spreadWithin(smooth);
    std::vector<float> light(n);
    for (size_t i = 0; i < n; ++i) light[i] = static_cast<float>(photometric(moment.lighting.exitance[i]));
    inParallel(moment.sensors.size(), [&](size_t s) {
        LightParts& parts = moment.sensors[s];
        for (int c = 0; c < 3; ++c) {
            if (grey && c > 0) {
                parts.interreflected[c] = parts.interreflected[0];
                continue;
            }
            double lux = dot({&sensors.smooth[s * n], n}, smooth[c]);
            if (sun) lux += dot({&sensors.even[s * n], n}, even[c]);
            parts.interreflected[c] += static_cast<float>(lux);
        }
        // Light of patches that fill much of the view, which the mesh does not resolve.
        double near = 0;
        for (size_t i = 0; i < n; ++i) {
            const double share = sensors.even[s * n + i];
            near += share * share * double{light[i]};
        }
        parts.error = static_cast<float>(moment.report.radiosity.bound * most + kNearShare * near +
                                         kSpreadShare * dot({&sensors.even[s * n], n}, spread) +
                                         (rowError() + kBounceError) * photometric(parts.interreflected) +
                                         kSensorSkyError * photometric(parts.sky + parts.ground));
    });
    moment.report.sensorSeconds = clock.seconds();
}

DaylightTransport::DaylightTransport(gpu::Device& device, const geometry::PatchMesh& mesh,
                                     const TransportOptions& options)
    : state_(std::make_unique<State>(device, mesh, options)) {
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

std::vector<Moment> DaylightTransport::light(std::span<const daylight::Sky> skies) {
    std::vector<Moment> moments;
    for (const daylight::Sky& sky : skies) moments.push_back(state_->direct(sky));
    if (!moments.empty()) state_->solve(moments);
    return moments;
}

TransportParts DaylightTransport::parts() {
    State& state = *state_;
    return {*state.solver,
            *state.gather,
            state.columnsPerMoment(),
            state.patchSky.elements,
            state.patchSky.channels,
            state.patchSky.values,
            state.sensors.skyCoefficients,
            state.sensors.smooth,
            state.sensors.even,
            state.sensors.sensors,
            state.sensors.room,
            state.skyPatches,
            *state.sunScene,
            *state.blinds};
}

std::optional<PointView> DaylightTransport::viewOfSensor(size_t sensor) const {
    const SensorGather& sensors = state_->sensors;
    if (sensors.room[sensor] == kNoRoom) return std::nullopt;
    return PointView(state_->points->blockers(), sensors.sensors[sensor].position,
                     glm::normalize(sensors.sensors[sensor].normal), sensors.room[sensor]);
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
