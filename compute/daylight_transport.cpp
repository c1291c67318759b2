#include "compute/daylight_transport.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "compute/dense_gather.h"
#include "compute/gpu/device.h"
#include "compute/light_from_outside.h"
#include "compute/moment_light.h"
#include "compute/outside_return.h"
#include "compute/parallel.h"
#include "compute/patch_slopes.h"
#include "compute/relight_basis.h"
#include "compute/sensor_gather.h"
#include "compute/sloped_factors.h"
#include "compute/stopwatch.h"
#include "compute/window_links.h"
#include "geometry/input_error.h"

namespace heliodon::compute {

namespace {

constexpr double kHemicubeRowError = 0.02; // where the kernel claims none

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
    std::unique_ptr<NearPairs> nearPairs;
    std::unique_ptr<LightFromOutside> outside;
    std::unique_ptr<OutsideReturn> returned; // of rooms
    std::vector<glm::vec3> linked; // per patch: what of its light goes by windows to others, or back
    std::unique_ptr<PatchSlopes> slopes;
    std::unique_ptr<SlopedFactors> sloped; // in `factors`
    std::unique_ptr<WindowLinks> links;
    std::vector<std::vector<float>> clear; // per channel: diffuse transmittance of clear interior glass
    SensorGather sensors;
    std::unique_ptr<DenseGather> gather;
    std::unique_ptr<TintedFactors> tinted; // gather with what links through panes do to colours, and returned
    std::unique_ptr<RadiositySolver> solver;
    std::unique_ptr<RelightBasis> relight;
    daylight::SkyPatches skyPatches;
    bool grey = true, hasNearLight = false;

    State(gpu::Device& d, const geometry::PatchMesh& m, const TransportOptions& o)
        : device(d), mesh(m), options(o), skyPatches(static_cast<int>(o.skyDivision)) {}

    void makeFactors();
    std::vector<float> rowsThatReturn();
    void makeSolver();
    void findOpenings();
    void makeSensors();
    void makeNearLight(const std::function<void(size_t)>& done);
    void readMaterials();
    std::vector<glm::vec3> takeSunBack(Moment& moment) const;
    MomentScene momentScene() const;
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

void DaylightTransport::State::makeSolver() {
    linked = links->rowSums();
    const std::vector<glm::vec3> back = returned->rowSums();
    if (linked.empty())
        linked = back;
    else
        for (size_t i = 0; i < back.size(); ++i) linked[i] += back[i];
    std::vector<float> rows = rowsThatReturn();
    for (size_t i = 0; i < back.size(); ++i) rows[i] += std::max({back[i].x, back[i].y, back[i].z});
    solver = std::make_unique<RadiositySolver>(*tinted, std::move(rows));
    relight = std::make_unique<RelightBasis>(*tinted, *solver, areas);
}

// What depends on which patches are glass.
void DaylightTransport::State::findOpenings() {
    points = std::make_unique<PointScene>(mesh);
    if (links) links->remove(factors.values);
    if (!sloped) {
        slopes = std::make_unique<PatchSlopes>(mesh);
        sloped = std::make_unique<SlopedFactors>(*points, *slopes, *nearPairs, rowSums, factors.values);
    }
    links = std::make_unique<WindowLinks>(*points, factors.values);
    gather->forgetFactors();
    outside =
        std::make_unique<LightFromOutside>(*points, *nearPairs, rowSums, factors.values, skyPatches, options);
    returned = std::make_unique<OutsideReturn>(mesh, outside->reflection(), outside->patchSky().walls);
    tinted = std::make_unique<TintedFactors>(*gather, *links, *returned);
    makeSolver();
    report.skySeconds = outside->skySeconds();
    report.skyElements = outside->skyElements();
    report.skipped.clear();
    if (!outside->hasOpenings()) report.skipped.emplace_back("sky coefficients: no opening leads outside");
    if (!outside->blinds().empty())
        report.skipped.emplace_back(
            "blinds: light that they scatter outwards, also into other windows that they face");
}

void DaylightTransport::State::makeSensors() {
    const Stopwatch clock;
    sensors = gatherSensors(*points, *slopes, outside->slats(), options.nearWalls, std::move(sensors.sensors),
                            outside->skyChannels());
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
    findNearLight(*points, *slopes, outside->slats(), columnsPerMoment(), sensors, done);
    sensors.returned.assign(sensors.sensors.size(), {});
    inParallel(returned->isEmpty() ? 0 : sensors.sensors.size(), [&](size_t s) {
        std::vector<OutsideShare> seen = sensors.walls[s];
        seen.insert(seen.end(), sensors.near[s].walls.begin(), sensors.near[s].walls.end());
        sensors.returned[s] = returned->rowOf(seen);
    });
    hasNearLight = true;
}

void DaylightTransport::State::readMaterials() {
    hasNearLight = false;
    if (!returned->isEmpty()) makeSolver(); // reflectances of outer sides
    grey = !options.skipNothing;
    for (const geometry::Material& m : mesh.materials)
        grey &= geometry::isGrey(m.reflectance) && geometry::isGrey(m.transmittance) &&
                geometry::isGrey(m.exitance);
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

// Sunlight ends where it ends, and does not run on smoothly, as form factors have it. Returns what patches
// send less for that, as far as others get it: for the solver alone.
std::vector<glm::vec3> DaylightTransport::State::takeSunBack(Moment& moment) const {
    const size_t n = mesh.patchCount();
    std::vector<glm::vec3> lux(n, glm::vec3(0)), sent(n, glm::vec3(0));
    if (glm::length(moment.lighting.sunDirection) == 0) return sent;
    sloped->takeBack(outside->firstBounce(moment), lux, sent);
    for (int c = 0; c < 3; ++c) {
        std::vector<float> within, beyond(n, 0); // rooms; beyond windows all light is taken for even
        for (const glm::vec3& less : sent) within.push_back(less[c]);
        links->addLinks(static_cast<uint32_t>(c), within, beyond);
        returned->add(static_cast<uint32_t>(c), within, beyond);
        for (size_t i = 0; i < n; ++i) moment.patches[i].interreflected[c] += lux[i][c] - beyond[i];
    }
    for (size_t i = 0; i < n; ++i) sent[i] += moment.sunSent[i];
    return sent;
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
    return {mesh,
            areas,
            rowSums,
            linked,
            solver->matter(),
            clear,
            *slopes,
            *nearPairs,
            *points,
            sensors,
            outside->slats(),
            *gather,
            rowError(),
            grey,
            outside->patchSky().error,
            outside->patchSky().range,
            !returned->isEmpty()};
}

void DaylightTransport::State::lightSensors(Moment& moment, const daylight::Sky& sky) const {
    moment.sensors.assign(sensors.sensors.size(), {});
    outside->lightSensors(moment, sky, sensors);
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

// Of outer sides (OutsideCells): whether they reflect, and whether in colour.
std::array<bool, 2> cellsOf(const geometry::Material& material) {
    return {material.reflectance != glm::vec3(0), geometry::isGrey(material.reflectance)};
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
    const bool outerSides = state_->points->outside().hasOuterSides();
    for (size_t k = 0; k < materials.size(); ++k) {
        const geometry::Material &before = state_->mesh.materials[k], &now = materials[k];
        glassChanged |= outerSides && cellsOf(before) != cellsOf(now);
        glassChanged |= before.transmittance != now.transmittance ||
                        before.refractiveIndex != now.refractiveIndex || before.blind != now.blind;
    }
    for (const uint32_t material : state_->mesh.outside.material) // decides cells and channels
        glassChanged |= state_->mesh.materials[material].reflectance != materials[material].reflectance;
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
    for (const daylight::Sky& sky : skies) moments.push_back(state_->outside->light(sky, state_->sensors));
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
            state.outside->skyElements(),
            state.outside->skyChannels(),
            state.outside->patchSky().coefficients,
            state.sensors.sky,
            state.sensors.smooth,
            state.sensors.even,
            state.sensors.sensors,
            state.sensors.room,
            state.sensors.tinted,
            state.sensors.returned,
            state.sensors.near,
            *state.links,
            *state.returned,
            *state.points,
            state.skyPatches,
            state.outside->sunScene(),
            state.outside->sunBounce(),
            state.outside->blinds(),
            state.outside->hiddenSky(),
            state.outside->slats(),
            state.sensors.slats,
            state.outside->reflection(),
            state.outside->patchSky().walls,
            state.sensors.walls,
            state.outside->outsideOnBlinds()};
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
