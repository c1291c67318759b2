#include "compute/daylight_transport.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "compute/daylight/glazing.h"
#include "compute/daylight/sky_patches.h"
#include "compute/gpu/device.h"
#include "compute/hemicube.h"
#include "compute/radiosity_gather.h"
#include "compute/sun_patches.h"
#include "geometry/input_error.h"

namespace heliodon::compute {

namespace {

constexpr double kPi = std::numbers::pi;

// Shares of light by which errors are estimated where nothing is measured; set so that the rooms of
// tests/data/compute/daylight, meshed at 0.4 to 0.6 m, stay inside on nearly all sensors.
constexpr double kHemicubeRowError = 0.03; // reflected light: one-point form factors and constant patches
constexpr double kMeshError = 0.02;        // reflected light: constant patches alone
constexpr double kPatchSkyError = 0.03;    // of a patch's mean from its middle
constexpr double kSensorSkyError = 0.01;   // sky cut into elements
constexpr double kSamplingSafety = 2;      // on the difference of two hemicubes

class Clock {
public:
    double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

bool isGrey(glm::vec3 v) {
    return v.x == v.y && v.y == v.z;
}

// Dense rows on the host (sky coefficients, sensors' factors) times a vector: eight partial sums, so that it
// vectorises and is the same on every run.
double rowTimes(const float* row, const float* x, size_t n) {
    float parts[16]{};
    size_t i = 0;
    for (; i + 16 <= n; i += 16)
        for (size_t k = 0; k < 16; ++k) parts[k] += row[i + k] * x[i + k];
    for (; i < n; ++i) parts[0] += row[i] * x[i];
    double sum = 0;
    for (float part : parts) sum += part;
    return sum;
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
            parts.sky[axis] = c >= channels
                                  ? parts.sky[0]
                                  : static_cast<float>(kPi * rowTimes(from, luminance.data(), elements - 1));
            parts.ground[axis] = static_cast<float>(kPi * from[elements - 1] * luminance[elements - 1]);
        }
    }
};

// Room of a point: that of the first patch in some direction whose front it sees. Where nothing is seen, any.
uint32_t roomOf(const geometry::PatchMesh& mesh, const Sensor& sensor) {
    const glm::dvec3 directions[]{sensor.normal, glm::normalize(sensor.normal + glm::dvec3(0.31, 0.17, 0.23)),
                                  glm::normalize(sensor.normal + glm::dvec3(-0.29, -0.13, 0.37))};
    for (const glm::dvec3& direction : directions) {
        double nearest = std::numeric_limits<double>::infinity();
        uint32_t room = io::kHemicubeAnyRoom;
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            const auto corners = mesh.patch(i);
            const glm::dvec3 normal = geometry::patchNormal(mesh, i);
            const double slope = glm::dot(normal, direction);
            if (slope >= 0) continue;
            const double t = glm::dot(mesh.vertices[corners[0]] - sensor.position, normal) / slope;
            if (t <= 0 || t >= nearest) continue;
            const glm::dvec3 p = sensor.position + t * direction;
            bool inside = true;
            for (size_t k = 0; k < corners.size() && inside; ++k) {
                const glm::dvec3 a = mesh.vertices[corners[k]];
                inside = glm::dot(glm::cross(mesh.vertices[corners[(k + 1) % corners.size()]] - a, p - a),
                                  normal) >= 0;
            }
            if (inside) nearest = t, room = mesh.room[i];
        }
        if (room != io::kHemicubeAnyRoom) return room;
    }
    return io::kHemicubeAnyRoom;
}

} // namespace

double photometric(glm::vec3 rgb) {
    return 0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z;
}

struct DaylightTransport::State {
    gpu::Device& device;
    geometry::PatchMesh mesh;
    TransportOptions options;
    TransportReport report;
    FormFactors factors;
    std::vector<float> rowSums;
    std::vector<double> areas;
    SkyRows patchSky, sensorSky[2];
    std::vector<Sensor> sensors;
    std::vector<float> sensorFactors[2]; // sensors x patches
    std::unique_ptr<RadiosityGather> gather;
    std::unique_ptr<RadiositySolver> solver;
    std::unique_ptr<SunScene> sunScene; // where there are openings
    daylight::SkyPatches skyPatches;
    bool hasOpenings = false, grey = true, emits = false;

    State(gpu::Device& d, const geometry::PatchMesh& m, const TransportOptions& o)
        : device(d), mesh(m), options(o), skyPatches(static_cast<int>(o.skyDivision)) {}

    void makeFactors();
    void makeSky();
    void makeSensors();
    void readMaterials();
    Moment direct(const daylight::Sky& sky) const;
    void solve(std::span<Moment> moments);
    void finish(Moment& moment, const std::vector<float>& exitance, const std::vector<float>& gathered,
                size_t firstColumn) const;
    void atSensors(Moment& moment, const std::vector<float>& exitance, size_t firstColumn) const;
    std::vector<float> spreadOfSun(const Moment& moment) const;
    double rowError() const {
        return factors.report.kernel == "hemicube" ? kHemicubeRowError
                                                   : factors.report.claimedRowError + kMeshError;
    }
    uint32_t columnsPerMoment() const { return grey ? 1 : 3; }
};

void DaylightTransport::State::makeFactors() {
    const size_t n = mesh.patchCount();
    areas.resize(n);
    for (size_t i = 0; i < n; ++i) {
        areas[i] = geometry::patchArea(mesh, i);
        hasOpenings |= mesh.twin[i] == geometry::kNoTwin && mesh.materials[mesh.material[i]].isOpening();
    }
    const FormFactorOptions& asked = options.formFactors;
    const bool onePass = asked.kernel == "hemicube" || (asked.kernel == "auto" && asked.maxError <= 0);
    if (onePass && hasOpenings) {
        const Clock clock;
        Hemicube hemicube(device, mesh, {options.formFactors.resolution, options.skyDivision});
        const PatchViewpoints views = patchViewpoints(mesh, options.formFactors.points);
        Hemicube::Result result = hemicube.run(views.viewpoints, views.pointsPerPatch);
        factors.patchCount = static_cast<uint32_t>(n);
        factors.values = std::move(result.factors);
        patchSky = {
            hemicube.skyElements(), hemicube.channels(),
            result.sky.download<float>(size_t{result.rows} * hemicube.skyElements() * hemicube.channels())};
        factors.report.kernel = "hemicube";
        factors.report.why = "form factors and sky coefficients in one pass";
        factors.report.resolution = options.formFactors.resolution;
        factors.report.points = views.pointsPerPatch;
        factors.report.seconds = clock.seconds();
        measureFormFactors(mesh, factors.values, factors.report);
    } else {
        factors = computeFormFactors(device, mesh, options.formFactors);
        if (hasOpenings) makeSky();
    }
    if (!hasOpenings) report.skipped.push_back("sky coefficients: no opening leads outside");
    report.formFactors = factors.report;
    report.skyElements = patchSky.elements;
    std::vector<float> copy;
    const float* F = factors.values.mapped<float>();
    if (!F) copy = factors.values.download<float>(n * n), F = copy.data();
    const std::vector<float> ones(n, 1.0f);
    rowSums.resize(n);
    for (size_t i = 0; i < n; ++i) rowSums[i] = static_cast<float>(rowTimes(F + i * n, ones.data(), n));
    gather = std::make_unique<RadiosityGather>(device, factors.values, static_cast<uint32_t>(n));
    solver = std::make_unique<RadiositySolver>(*gather, rowSums);
}

// Sky coefficients alone, where another kernel made the form factors or the glass has changed.
void DaylightTransport::State::makeSky() {
    const Clock clock;
    Hemicube hemicube(device, mesh, {options.formFactors.resolution, options.skyDivision});
    const PatchViewpoints views = patchViewpoints(mesh, options.formFactors.points);
    const Hemicube::Result result = hemicube.run(views.viewpoints, views.pointsPerPatch);
    patchSky = {
        hemicube.skyElements(), hemicube.channels(),
        result.sky.download<float>(size_t{result.rows} * hemicube.skyElements() * hemicube.channels())};
    report.skySeconds = clock.seconds();
}

// Two hemicubes for each sensor, their grids turned against each other: the mean is better than either, and
// their difference tells how much sampling leaves open.
void DaylightTransport::State::makeSensors() {
    const Clock clock;
    const size_t n = mesh.patchCount();
    Hemicube hemicube(device, mesh, {options.sensorResolution, options.skyDivision});
    std::vector<Viewpoint> views;
    for (const Sensor& sensor : sensors)
        views.push_back(
            {sensor.position, glm::normalize(sensor.normal), io::kHemicubeNoPatch, roomOf(mesh, sensor)});
    for (size_t turn = 0; turn < 2; ++turn) {
        for (size_t s = 0; s < views.size(); ++s)
            views[s].turn = std::fmod(0.6180339887498949 * static_cast<double>(2 * s + turn), 1.0) * kPi / 2;
        const Hemicube::Result result = hemicube.run(views);
        sensorFactors[turn] = result.factors.download<float>(views.size() * n);
        sensorSky[turn] = {
            hemicube.skyElements(), hemicube.channels(),
            result.sky.download<float>(views.size() * hemicube.skyElements() * hemicube.channels())};
    }
    report.sensorSeconds = clock.seconds();
}

void DaylightTransport::State::readMaterials() {
    const size_t n = mesh.patchCount();
    if (hasOpenings) sunScene = std::make_unique<SunScene>(mesh);
    grey = true, emits = false;
    for (const geometry::Material& m : mesh.materials) {
        for (int c = 0; c < 3; ++c)
            if (!(m.reflectance[c] >= 0 && m.reflectance[c] < 1))
                throw geometry::InputError("material", m.name,
                                           fmt::format("reflectance {} is outside [0, 1)", m.reflectance[c]));
        grey &= isGrey(m.reflectance) && isGrey(m.transmittance) && isGrey(m.exitance);
    }
    for (size_t i = 0; i < n; ++i) emits |= glm::length(mesh.materials[mesh.material[i]].exitance) > 0;
    RadiosityMatter matter;
    matter.patchCount = static_cast<uint32_t>(n);
    matter.twin = mesh.twin;
    for (int c = 0; c < (grey ? 1 : 3); ++c) {
        std::vector<float> rho(n), tau(n);
        for (size_t i = 0; i < n; ++i) {
            const geometry::Material& m = mesh.materials[mesh.material[i]];
            rho[i] = m.reflectance[c];
            if (mesh.twin[i] != geometry::kNoTwin)
                tau[i] = std::min(static_cast<float>(daylight::glazingOf(m).diffuseTransmittance()[c]),
                                  1 - rho[i]);
        }
        matter.reflectance.push_back(std::move(rho));
        matter.transmittance.push_back(std::move(tau));
    }
    report.channels = grey ? 1 : 3;
    solver->setMatter(std::move(matter));
}

// What arrives straight from outside, on patches and at sensors.
Moment DaylightTransport::State::direct(const daylight::Sky& sky) const {
    Moment moment;
    const size_t n = mesh.patchCount();
    moment.patches.resize(n);
    moment.sensors.resize(sensors.size());
    moment.lighting.sunIlluminance.assign(n, glm::vec3(0));
    auto& modelled = moment.report.modelled;
    auto& skipped = moment.report.skipped;
    const Clock combining;
    if (!hasOpenings) {
        skipped.push_back("sky and ground: no opening leads outside");
    } else if (sky.formula.scale <= 0 && sky.ground.luminance <= 0) {
        skipped.push_back("sky and ground: dark");
    } else {
        modelled.push_back("sky and ground");
        const std::vector<double> means = skyPatches.luminances(sky);
        const std::vector<float> luminance(means.begin(), means.end());
        for (size_t i = 0; i < n; ++i) patchSky.combine(i, luminance, moment.patches[i]);
        for (size_t s = 0; s < sensors.size(); ++s) {
            LightParts two[2];
            for (size_t turn = 0; turn < 2; ++turn) sensorSky[turn].combine(s, luminance, two[turn]);
            LightParts& parts = moment.sensors[s];
            parts.sky = 0.5f * (two[0].sky + two[1].sky);
            parts.ground = 0.5f * (two[0].ground + two[1].ground);
            parts.error += static_cast<float>(
                std::abs(photometric(two[0].sky + two[0].ground) - photometric(two[1].sky + two[1].ground)));
        }
    }
    moment.report.combineSeconds = combining.seconds();

    const Clock sunning;
    if (!sky.hasSun()) {
        skipped.push_back("sun: below the horizon or behind cloud");
    } else if (!hasOpenings) {
        skipped.push_back("sun: no opening leads outside");
    } else {
        const SunPatches sun(*sunScene, sky.sun.direction);
        if (!sun.canEnter()) {
            skipped.push_back("sun: shines on no opening from outside");
        } else {
            modelled.push_back("sun");
            moment.lighting.sunDirection = glm::normalize(sky.sun.direction);
            const auto strength = static_cast<float>(sky.sun.normalIlluminance);
            moment.lighting.sunNormalIlluminance = glm::vec3(strength);
            moment.lighting.sunIlluminance = sun.onPatches();
            for (size_t i = 0; i < n; ++i)
                moment.patches[i].sun = moment.lighting.sunIlluminance[i] *= strength;
            for (size_t s = 0; s < sensors.size(); ++s)
                moment.sensors[s].sun =
                    strength * sun.atPoint(sensors[s].position, glm::normalize(sensors[s].normal));
        }
    }
    moment.report.sunSeconds = sunning.seconds();
    return moment;
}

void DaylightTransport::State::solve(std::span<Moment> moments) {
    const Clock clock;
    const size_t n = mesh.patchCount();
    const uint32_t perMoment = columnsPerMoment();
    std::vector<float> emitted;
    std::vector<uint32_t> channel;
    bool anyLight = false;
    for (const Moment& moment : moments)
        for (uint32_t c = 0; c < perMoment; ++c) {
            const auto axis = static_cast<int>(c);
            channel.push_back(c);
            std::vector<float> tau(n), arriving(n);
            for (size_t i = 0; i < n; ++i) {
                const LightParts& parts = moment.patches[i];
                arriving[i] = parts.sun[axis] + parts.sky[axis] + parts.ground[axis];
            }
            for (size_t i = 0; i < n; ++i) {
                const geometry::Material& m = mesh.materials[mesh.material[i]];
                float out = m.exitance[axis] + m.reflectance[axis] * arriving[i];
                if (mesh.twin[i] != geometry::kNoTwin) {
                    // The sun goes through clear glass as a beam (SunPatches); sky light that falls on it
                    // goes on diffusely.
                    const LightParts& other = moment.patches[static_cast<size_t>(mesh.twin[i])];
                    out += std::min(static_cast<float>(daylight::glazingOf(m).diffuseTransmittance()[axis]),
                                    1 - m.reflectance[axis]) *
                           (other.sky[axis] + other.ground[axis]);
                }
                anyLight |= out > 0;
                emitted.push_back(out);
            }
        }
    std::vector<float> exitance, gathered;
    RadiosityReport solved;
    if (anyLight) {
        solved = solver->solve(emitted, channel, exitance, gathered, options.radiosity);
    } else {
        exitance.assign(emitted.size(), 0), gathered.assign(emitted.size(), 0);
    }
    const double seconds = clock.seconds() / static_cast<double>(moments.size());
    for (size_t k = 0; k < moments.size(); ++k) {
        Moment& moment = moments[k];
        moment.report.radiosity = solved;
        moment.report.solveSeconds = seconds;
        if (anyLight)
            moment.report.modelled.push_back("interreflection");
        else
            moment.report.skipped.push_back("interreflection: no light enters and nothing emits");
        if (grey)
            moment.report.skipped.push_back("colour: all materials are grey, one channel stands for three");
        finish(moment, exitance, gathered, k * perMoment * n);
        atSensors(moment, exitance, k * perMoment * n);
    }
}

void DaylightTransport::State::finish(Moment& moment, const std::vector<float>& exitance,
                                      const std::vector<float>& gathered, size_t first) const {
    const size_t n = mesh.patchCount();
    moment.lighting.exitance.resize(n);
    double in = 0, absorbed = 0, mean = 0, total = 0, most = 0;
    for (size_t i = 0; i < n; ++i) {
        LightParts& parts = moment.patches[i];
        const geometry::Material& m = mesh.materials[mesh.material[i]];
        glm::vec3 out(0);
        for (int c = 0; c < 3; ++c) {
            const size_t at = first + static_cast<size_t>(grey ? 0 : c) * n + i;
            out[c] = exitance[at];
            parts.interreflected[c] = gathered[at];
        }
        moment.lighting.exitance[i] = out;
        const glm::vec3 direct = parts.sun + parts.sky + parts.ground;
        in += areas[i] * photometric(m.exitance + direct);
        glm::vec3 kept = glm::vec3(1) - m.reflectance;
        if (mesh.twin[i] != geometry::kNoTwin) {
            const glm::vec3 tau = glm::min(glm::vec3(daylight::glazingOf(m).diffuseTransmittance()), kept);
            in -= areas[i] * photometric(tau * parts.sun); // goes on as a beam, counted where it lands
            absorbed += areas[i] * (photometric((kept - tau) * parts.total()));
        } else {
            absorbed += areas[i] * photometric(kept * parts.total());
        }
        mean += areas[i] * photometric(out);
        total += areas[i];
        most = std::max(most, photometric(out));
    }
    mean /= std::max(total, 1e-30);
    for (size_t i = 0; i < n; ++i) {
        LightParts& parts = moment.patches[i];
        parts.error +=
            static_cast<float>(std::abs(1 - rowSums[i]) * mean + moment.report.radiosity.bound * most +
                               rowError() * photometric(parts.interreflected) +
                               kPatchSkyError * photometric(parts.sky + parts.ground));
    }
    moment.report.lumensIn = in;
    moment.report.lumensAbsorbed = absorbed;
    moment.report.energyImbalance = in > 0 ? std::abs(in - absorbed) / in : 0;
}

// Standard deviation, within each patch, of the exitance that an edge of sunlight on it leaves; empty without
// sun. The full sun is that of the brightest patch of the same surface.
std::vector<float> DaylightTransport::State::spreadOfSun(const Moment& moment) const {
    if (glm::length(moment.lighting.sunDirection) == 0) return {};
    const size_t n = mesh.patchCount();
    uint32_t surfaces = 0;
    for (uint32_t surface : mesh.surface) surfaces = std::max(surfaces, surface + 1);
    std::vector<double> full(surfaces);
    for (size_t i = 0; i < n; ++i)
        full[mesh.surface[i]] = std::max(full[mesh.surface[i]], photometric(moment.patches[i].sun));
    std::vector<float> spread(n);
    for (size_t i = 0; i < n; ++i) {
        const double whole = full[mesh.surface[i]], sun = photometric(moment.patches[i].sun);
        spread[i] = static_cast<float>(photometric(mesh.materials[mesh.material[i]].reflectance) *
                                       std::sqrt(std::max(0.0, sun * (whole - sun))));
    }
    return spread;
}

void DaylightTransport::State::atSensors(Moment& moment, const std::vector<float>& exitance,
                                         size_t first) const {
    const Clock clock;
    const size_t n = mesh.patchCount();
    double most = 0;
    for (const glm::vec3& out : moment.lighting.exitance) most = std::max(most, photometric(out));
    const std::vector<float> spread = spreadOfSun(moment);
    for (size_t s = 0; s < sensors.size(); ++s) {
        LightParts& parts = moment.sensors[s];
        glm::vec3 two[2]{};
        double edges = 0;
        for (size_t turn = 0; turn < 2; ++turn) {
            const float* row = &sensorFactors[turn][s * n];
            for (int c = 0; c < 3; ++c)
                two[turn][c] =
                    grey && c > 0
                        ? two[turn][0]
                        : static_cast<float>(rowTimes(row, &exitance[first + static_cast<size_t>(c) * n], n));
            for (size_t i = 0; i < n && !spread.empty(); ++i) edges += std::pow(row[i] * spread[i], 2);
        }
        parts.interreflected = 0.5f * (two[0] + two[1]);
        parts.error = static_cast<float>(
            kSamplingSafety * (parts.error + std::abs(photometric(two[0]) - photometric(two[1]))) +
            moment.report.radiosity.bound * most + rowError() * photometric(parts.interreflected) +
            kSensorSkyError * photometric(parts.sky + parts.ground) + 2 * std::sqrt(0.5 * edges));
    }
    moment.report.sensorSeconds = clock.seconds();
}

DaylightTransport::DaylightTransport(gpu::Device& device, const geometry::PatchMesh& mesh,
                                     const TransportOptions& options)
    : state_(std::make_unique<State>(device, mesh, options)) {
    state_->makeFactors();
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
        glassChanged |=
            before.transmittance != now.transmittance || before.refractiveIndex != now.refractiveIndex;
    }
    state_->mesh.materials = materials;
    if (glassChanged) {
        state_->hasOpenings = false;
        for (size_t i = 0; i < state_->mesh.patchCount(); ++i)
            state_->hasOpenings |=
                state_->mesh.twin[i] == geometry::kNoTwin && materials[state_->mesh.material[i]].isOpening();
        if (state_->hasOpenings) state_->makeSky();
        if (!state_->sensors.empty()) state_->makeSensors();
    }
    state_->readMaterials();
}

void DaylightTransport::setSensors(std::vector<Sensor> sensors) {
    state_->sensors = std::move(sensors);
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
    const auto mean = [](const std::vector<float>& a, const std::vector<float>& b) {
        std::vector<float> result(a.size());
        for (size_t i = 0; i < a.size(); ++i) result[i] = 0.5f * (a[i] + b[i]);
        return result;
    };
    return {*state.solver,
            *state.gather,
            state.columnsPerMoment(),
            state.patchSky.elements,
            state.patchSky.channels,
            state.patchSky.values,
            mean(state.sensorSky[0].values, state.sensorSky[1].values),
            mean(state.sensorFactors[0], state.sensorFactors[1]),
            state.sensors,
            state.skyPatches};
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
