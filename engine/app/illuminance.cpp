#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "engine/app/commands.h"
#include "engine/app/light_report.h"
#include "engine/app/moment.h"
#include "engine/app/plan_chart.h"
#include "engine/app/progress.h"
#include "engine/app/scene_input.h"
#include "engine/app/table_file.h"
#include "engine/app/work_plane.h"
#include "geometry/input_error.h"
#include "geometry/whole_file.h"

namespace heliodon::app {

namespace {

std::string luxColumns(const compute::LightParts& parts) {
    return fmt::format("{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.4g}", compute::photometric(parts.total()),
                       compute::photometric(parts.sun), compute::photometric(parts.sky),
                       compute::photometric(parts.ground), compute::photometric(parts.interreflected),
                       static_cast<double>(parts.error));
}

constexpr const char* kLuxHeader = ",lux,lux_sun,lux_sky,lux_ground,lux_interreflected,lux_error\n";

std::string patchTable(const Scene& scene, const std::vector<compute::LightParts>& patches) {
    std::string text = std::string("x,y,z,nx,ny,nz,area,material") + kLuxHeader;
    const geometry::PatchMesh& mesh = scene.mesh;
    for (size_t i = 0; i < patches.size(); ++i) {
        const glm::dvec3 p = modelFromWorld(geometry::patchCentroid(mesh, i), scene.up);
        const glm::dvec3 n = modelFromWorld(geometry::patchNormal(mesh, i), scene.up);
        text += fmt::format("{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6g},{},{}\n", p.x, p.y, p.z, n.x,
                            n.y, n.z, geometry::patchArea(mesh, i),
                            csvField(mesh.materials[mesh.material[i]].name), luxColumns(patches[i]));
    }
    return text;
}

std::string sensorTable(const SensorTable& sensors, const std::vector<compute::LightParts>& parts) {
    std::string text = sensors.header + kLuxHeader;
    for (size_t i = 0; i < parts.size(); ++i) text += sensors.rows[i] + "," + luxColumns(parts[i]) + "\n";
    return text;
}

// The mean is by area where these are patches of the mesh, else over sensors.
void reportLux(Run& run, const geometry::PatchMesh* mesh, const std::vector<compute::LightParts>& parts) {
    if (parts.empty()) return;
    double sum = 0, weights = 0, least = 1e300, most = 0;
    for (size_t i = 0; i < parts.size(); ++i) {
        const double lux = compute::photometric(parts[i].total()),
                     weight = mesh ? geometry::patchArea(*mesh, i) : 1;
        sum += weight * lux;
        weights += weight;
        least = std::min(least, lux);
        most = std::max(most, lux);
    }
    run.report()["lux"] = {{"count", parts.size()}, {"mean", sum / weights}, {"min", least}, {"max", most}};
}

// lux_error over lux that 95 of 100 places stay below; places that get hardly any light do not count.
double reachedError(const std::vector<compute::LightParts>& parts) {
    std::vector<double> shares;
    double most = 0;
    for (const compute::LightParts& p : parts) most = std::max(most, compute::photometric(p.total()));
    for (const compute::LightParts& p : parts)
        if (const double lux = compute::photometric(p.total()); lux > 1e-4 * most)
            shares.push_back(static_cast<double>(p.error) / lux);
    if (shares.empty()) return 0;
    const auto at = static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(shares.size() - 1));
    std::nth_element(shares.begin(), shares.begin() + at, shares.end());
    return shares[static_cast<size_t>(at)];
}

// Light of one sky on a mesh that is refined until the error asked for is reached.
struct Solution {
    Scene scene;
    std::optional<SensorTable> sensors; // given, or of the work plane
    compute::Moment moment;
    std::string title; // when, under which sky
};

// What is read once, however many meshes are tried.
struct Input {
    std::optional<SensorTable> sensors;
    SceneSource scene;
};

// Small files first: a typing error there should not cost the detection.
Input readInput(Run& run, const IlluminanceArguments& arguments) {
    Input input;
    if (!arguments.sensors.empty()) input.sensors = readSensors(arguments.sensors, upAxisOf(arguments.scene));
    input.scene = readSource(run, arguments.scene);
    return input;
}

void giveSensors(Run& run, compute::DaylightTransport& transport, const SensorTable& sensors) {
    std::vector<compute::Sensor> points;
    for (size_t i = 0; i < sensors.points.size(); ++i)
        points.push_back({sensors.points[i], sensors.normals[i]});
    {
        const StageTimer timer(run, "sensors");
        transport.setSensors(std::move(points));
    }
    warnOfSensorsOutside(run, transport.report().sensorsOutside, sensors.points.size());
    const StageTimer timer(run, "near_walls");
    Progress progress("walls beside sensors", sensors.points.size(), run.showsProgress());
    transport.makeNearLight([&](size_t done) { progress.advance(done); });
}

Solution solveOn(Run& run, const IlluminanceArguments& arguments, const Input& input, size_t triangles) {
    Solution s;
    s.sensors = input.sensors;
    SceneArguments meshed = arguments.scene;
    meshed.triangles = triangles;
    s.scene = makeScene(run, meshed, input.scene.rig, input.scene.sketch);
    if (s.sensors) refuseAllOutside(arguments.sensors, *s.sensors, s.scene, arguments.scene);
    const SkySource source(run, arguments.moment, s.scene);
    const daylight::Sky sky = source.reportedSky(run);
    s.title = source.title();
    compute::TransportOptions options;
    options.errorByPlace = true;
    options.sunDisc = arguments.sunDisc;
    if (arguments.maxError > 0) {
        options.formFactors.maxError = std::clamp(arguments.maxError / 10, 1e-5, 2e-3);
        options.radiosity.tolerance = std::clamp(arguments.maxError / 200, 1e-6, 1e-4);
        // Taking walls apart beside more sensors costs less than a finer mesh.
        options.nearWalls = {.one = 0.12, .together = 0.25, .reach = 1};
    }
    const auto transport = makeTransport(run, s.scene.mesh, options);
    if (!s.sensors && !arguments.plan.empty()) {
        WorkPlane plane;
        plane.worldPerBuilding = s.scene.worldPerBuilding;
        plane.spacing /= 2; // for the drawing only: patches of sun keep their shape
        s.sensors = workPlaneSensors(s.scene.mesh, s.scene.up, plane);
        s.title += "; " + plane.inWords();
    }
    if (s.sensors) giveSensors(run, *transport, *s.sensors);
    s.moment = solveLight(run, *transport, sky, s.scene.worldPerBuilding);
    warnOfNight(run, source, lightFigures(s.scene.mesh, s.moment).maxLux);
    return s;
}

struct MeshError {
    size_t triangles;
    double error;
};

// The error that a mesh of `finest` triangles would have, going on as from a mesh at least four times coarser
// than the last to the last; 0 while there is none. Over less, what differs is as much how meshes happen to
// lie as how fine they are.
double errorOfFinest(std::span<const MeshError> tried, size_t finest) {
    constexpr size_t kApart = 4;
    const MeshError& now = tried.back();
    const auto before = std::find_if(tried.rbegin(), tried.rend(), [&](const MeshError& m) {
        return kApart * m.triangles <= now.triangles;
    });
    if (before == tried.rend() || !(before->error > 0)) return 0;
    const double slope =
        std::log(now.error / before->error) /
        std::log(static_cast<double>(now.triangles) / static_cast<double>(before->triangles));
    const double further = static_cast<double>(finest) / static_cast<double>(now.triangles);
    return now.error * std::pow(std::max(1.0, further), std::min(0.0, slope));
}

// The mesh, the form factors and the solution that --max-error asks for: the estimate of what the mesh leaves
// open falls about as the cube root of the number of triangles, or faster.
Solution solveToError(Run& run, const IlluminanceArguments& arguments, const Input& input) {
    constexpr size_t kFirst = 600, kMost = 16000;
    const double wanted = arguments.maxError;
    size_t triangles = arguments.scene.triangles.value_or(kFirst);
    nlohmann::json rounds = nlohmann::json::array();
    std::vector<MeshError> tried;
    for (;;) {
        Solution s = solveOn(run, arguments, input, triangles);
        const double reached = reachedError(arguments.sensors.empty() ? s.moment.patches : s.moment.sensors);
        tried.push_back({s.scene.mesh.patchCount(), reached});
        rounds.push_back({{"triangles", s.scene.mesh.patchCount()}, {"error", reached}});
        const double finest = errorOfFinest(tried, kMost);
        const bool enough = reached <= wanted, vain = triangles < kMost && finest > 1.1 * wanted,
                   last = triangles >= kMost || arguments.scene.triangles || vain;
        if (!enough && !last) {
            const double factor = std::clamp(std::pow(reached / wanted, 3), 2.0, 5.0);
            triangles = std::min(kMost, static_cast<size_t>(static_cast<double>(triangles) * factor));
            continue;
        }
        const std::string why =
            enough
                ? "the coarsest mesh tried that reaches it on 95 of 100 places; form factors to a tenth of "
                  "it, the solution to a two-hundredth"
            : arguments.scene.triangles ? "the mesh was given by --triangles"
            : vain ? fmt::format("by this mesh and one at least four times coarser, the finest of {} "
                                 "triangles would leave {:.2g}",
                                 kMost, finest)
                   : "it is the finest mesh allowed";
        run.report()["accuracy"] = {
            {"wanted", wanted}, {"reached", reached}, {"rounds", rounds}, {"why", why}};
        if (!enough)
            run.warn(fmt::format("--max-error {:.3g} is not reached: lux_error is {:.3g} of lux on 95 of 100 "
                                 "places with {} triangles; {}{}",
                                 wanted, reached, s.scene.mesh.patchCount(), why,
                                 arguments.sensors.empty() ? "; sensors may get less than patches" : ""));
        return s;
    }
}

Plan planOf(const Solution& solution) {
    const compute::Lighting& light = solution.moment.lighting;
    std::vector<double> lux, direct;
    for (const compute::LightParts& p : solution.moment.sensors) {
        lux.push_back(compute::photometric(p.total()));
        direct.push_back(compute::photometric(p.sun));
    }
    PlanValues values{solution.sensors->points, solution.sensors->normals, lux};
    std::optional<compute::SunPatches> sun;
    if (glm::length(light.sunDirection) > 0) {
        values.sun = direct;
        values.sunPatches = &sun.emplace(solution.scene.mesh, light.sunDirection);
        values.sunLux = compute::photometric(light.sunNormalIlluminance);
    }
    return planChart(solution.scene, values, std::nullopt, "Illuminance", solution.title);
}

} // namespace

void execute(Run& run, const IlluminanceArguments& arguments) {
    refuseNoDrawing(arguments.plan);
    const Input input = readInput(run, arguments);
    const Solution solution =
        arguments.maxError > 0
            ? solveToError(run, arguments, input)
            : solveOn(run, arguments, input, arguments.scene.triangles.value_or(kDefaultTriangles));
    const Scene& scene = solution.scene;
    const std::optional<SensorTable>& sensors = solution.sensors;
    const bool perPatch = arguments.sensors.empty();
    const compute::Moment& moment = solution.moment;
    const std::vector<compute::LightParts>& parts = perPatch ? moment.patches : moment.sensors;
    reportLux(run, perPatch ? &scene.mesh : nullptr, parts);
    geometry::writeWholeText(arguments.output,
                             perPatch ? patchTable(scene, parts) : sensorTable(*sensors, parts));
    if (!arguments.plan.empty()) {
        const StageTimer timer(run, "draw");
        const Plan plan = planOf(solution);
        plan.chart.write(arguments.plan);
        if (plan.shown == 0) run.warn(kEmptyPlan);
    }
}

} // namespace heliodon::app
