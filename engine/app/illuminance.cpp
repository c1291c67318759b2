#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "engine/app/commands.h"
#include "engine/app/light_report.h"
#include "engine/app/moment.h"
#include "engine/app/plan_chart.h"
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
                            n.y, n.z, geometry::patchArea(mesh, i), mesh.materials[mesh.material[i]].name,
                            luxColumns(patches[i]));
    }
    return text;
}

std::string sensorTable(const SensorTable& sensors, const std::vector<compute::LightParts>& parts) {
    std::string text = sensors.header + kLuxHeader;
    for (size_t i = 0; i < parts.size(); ++i) text += sensors.rows[i] + "," + luxColumns(parts[i]) + "\n";
    return text;
}

void reportLux(Run& run, const std::vector<compute::LightParts>& parts) {
    if (parts.empty()) return;
    double sum = 0, least = 1e300, most = 0;
    for (const compute::LightParts& p : parts) {
        const double lux = compute::photometric(p.total());
        sum += lux;
        least = std::min(least, lux);
        most = std::max(most, lux);
    }
    run.report()["lux"] = {{"count", parts.size()},
                           {"mean", sum / static_cast<double>(parts.size())},
                           {"min", least},
                           {"max", most}};
}

} // namespace

void execute(Run& run, const IlluminanceArguments& arguments) {
    // Small files first: a typing error there should not cost the form factors.
    if (!arguments.plan.empty() && arguments.plan.extension() != ".png" &&
        arguments.plan.extension() != ".svg")
        throw geometry::InputError(arguments.plan.string(), "",
                                   "is no kind of drawing, expected .png or .svg");
    std::optional<SensorTable> sensors;
    if (!arguments.sensors.empty()) sensors = readSensors(arguments.sensors, upAxisOf(arguments.scene));
    const Scene scene = loadScene(run, arguments.scene);
    const SkySource source(run, arguments.moment, scene);
    const daylight::Sky sky = source.skyAt(source.moment());
    const auto transport = makeTransport(run, scene.mesh);
    const bool perPatch = !sensors;
    if (perPatch && !arguments.plan.empty()) {
        WorkPlane plane;
        plane.worldPerBuilding = worldPerBuilding(scene);
        sensors = workPlaneSensors(scene.mesh, scene.up, plane);
    }
    if (sensors) {
        const StageTimer timer(run, "sensors");
        std::vector<compute::Sensor> points;
        for (size_t i = 0; i < sensors->points.size(); ++i)
            points.push_back({sensors->points[i], sensors->normals[i]});
        transport->setSensors(std::move(points));
    }
    if (const size_t outside = transport->report().sensorsOutside; outside > 0)
        run.warn(
            fmt::format("{} of {} sensors lie in no room and stay dark", outside, sensors->points.size()));
    const std::vector<compute::Moment> moments = solveLight(run, *transport, std::span(&sky, 1));
    const std::vector<compute::LightParts>& parts = perPatch ? moments[0].patches : moments[0].sensors;
    reportLux(run, parts);
    geometry::writeWholeText(arguments.output,
                             perPatch ? patchTable(scene, parts) : sensorTable(*sensors, parts));
    if (!arguments.plan.empty()) {
        std::vector<double> lux;
        for (const compute::LightParts& p : moments[0].sensors)
            lux.push_back(compute::photometric(p.total()));
        planChart(scene, sensors->points, sensors->normals, lux, luxScale(lux), "Illuminance")
            .write(arguments.plan);
    }
}

} // namespace heliodon::app
