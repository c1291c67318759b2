#include "engine/app/light_report.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "compute/daylight/glazing.h"
#include "compute/point_view.h"
#include "engine/app/finite_light.h"
#include "engine/app/first_few.h"
#include "engine/app/scene_input.h"
#include "engine/app/table_file.h"
#include "engine/app/work_plane.h"
#include "engine/passes/weighted_quantile.h"
#include "geometry/bounds.h"
#include "geometry/input_error.h"

namespace heliodon::app {

using nlohmann::json;

namespace {

// "x 0 to 4, y 0 to 3, z 0 to 5", in the model's axes.
std::string extentOf(std::span<const glm::dvec3> points, geometry::UpAxis up) {
    const geometry::Bounds box = geometry::boundsOf(points);
    const glm::dvec3 a = modelFromWorld(box.low, up), b = modelFromWorld(box.high, up);
    const glm::dvec3 low = glm::min(a, b), high = glm::max(a, b);
    return fmt::format("x {:.4g} to {:.4g}, y {:.4g} to {:.4g}, z {:.4g} to {:.4g}", low.x, high.x, low.y,
                       high.y, low.z, high.z);
}

void warnOfTolerance(Run& run, const compute::MomentReport& r) {
    if (!r.radiosity.converged)
        run.warn("the radiosity solution did not reach its tolerance; see radiosity.bound in the report");
}

// Lumens of the building, whose areas are not the mesh's.
void reportRadiosity(Run& run, const compute::MomentReport& r, double worldPerBuilding) {
    const double lumens = 1 / (worldPerBuilding * worldPerBuilding);
    run.report()["radiosity"] = {
        {"passes", r.radiosity.passes},         {"residual", r.radiosity.residual},
        {"bound", r.radiosity.bound},           {"converged", r.radiosity.converged},
        {"lumens_in", lumens * r.lumensIn},     {"lumens_absorbed", lumens * r.lumensAbsorbed},
        {"lumens_lost", lumens * r.lumensLost}, {"energy_imbalance", r.energyImbalance}};
    warnOfTolerance(run, r);
}

} // namespace

void refuseAllOutside(const std::filesystem::path& file, const SensorTable& sensors, const Scene& scene,
                      const SceneArguments& arguments) {
    if (sensors.points.empty()) return;
    for (size_t s = 0; s < sensors.points.size(); ++s)
        if (compute::roomOfPoint(scene.mesh, sensors.points[s], glm::normalize(sensors.normals[s])) !=
            geometry::kNoRoom)
            return;
    throw geometry::InputError(
        file.string(), "",
        fmt::format(
            "none of its {} sensors lies in a room of {}: they are at {}, the model at {}, expected the "
            "model's units and axes",
            sensors.points.size(), arguments.input.filename().string(), extentOf(sensors.points, scene.up),
            extentOf(scene.mesh.vertices, scene.up)));
}

void warnOfSensorsOutside(Run& run, const std::vector<size_t>& outside, size_t count) {
    if (outside.empty()) return;
    run.warn(fmt::format("{} of {} sensors lie in no room and stay dark: row{} {}, counted from 0",
                         outside.size(), count, outside.size() == 1 ? "" : "s", firstFew(outside, 5)));
}

void reportFormFactors(Run& run, size_t patches, const compute::FormFactorReport& report) {
    run.report()["form_factors"] = {{"patches", patches},
                                    {"kernel", report.kernel},
                                    {"why", report.why},
                                    {"resolution", report.resolution},
                                    {"points", report.points},
                                    {"seconds", report.seconds},
                                    {"closure_max", report.closureMax},
                                    {"closure_rms", report.closureRms},
                                    {"reciprocity_rms", nullptr},
                                    {"claimed_row_error", nullptr}};
    if (report.claimedRowError > 0 || report.kernel != "hemicube") // which claims nothing unless it refines
        run.report()["form_factors"]["claimed_row_error"] = report.claimedRowError;
    if (report.reciprocityRms) run.report()["form_factors"]["reciprocity_rms"] = *report.reciprocityRms;
    if (report.claimedRadiosityError > 0)
        run.report()["form_factors"]["claimed_radiosity_error"] = report.claimedRadiosityError;
    if (report.claimedRowSumError > 0)
        run.report()["form_factors"]["claimed_row_sum_error"] = report.claimedRowSumError;
    for (const std::string& reason : report.skipped) run.skipped(reason);
    for (const std::string& warning : report.warnings) run.warn(warning);
}

std::function<void(double)> noteOfLongWork(Run& run, const std::string& remedy) {
    return [&run, remedy](double secondsLeft) {
        const bool minutes = secondsLeft > 90;
        run.note(fmt::format("form factors: patches see one another past many blockers: about {:.0f} {} "
                             "more; {}",
                             minutes ? secondsLeft / 60 : secondsLeft, minutes ? "minutes" : "s", remedy));
    };
}

std::unique_ptr<compute::DaylightTransport> makeTransport(Run& run, const geometry::PatchMesh& mesh,
                                                          const compute::TransportOptions& options) {
    gpu::Device& device = run.device();
    run.noteAssumed();
    return makeTransport(run, device, mesh, options);
}

std::unique_ptr<compute::DaylightTransport> makeTransport(Run& run, gpu::Device& device,
                                                          const geometry::PatchMesh& mesh,
                                                          const compute::TransportOptions& options) {
    std::unique_ptr<compute::DaylightTransport> transport;
    {
        const StageTimer timer(run, "formfactors");
        compute::TransportOptions told = options;
        if (!told.formFactors.longWork)
            told.formFactors.longWork =
                noteOfLongWork(run, "fewer faces in the model, or a smaller --triangles, would take less");
        transport = std::make_unique<compute::DaylightTransport>(device, mesh, told);
    }
    const compute::TransportReport& t = transport->report();
    reportFormFactors(run, mesh.patchCount(), t.formFactors);
    run.report()["form_factors"]["sky_elements"] = t.skyElements;
    run.report()["form_factors"]["channels"] = t.channels;
    for (const std::string& reason : t.skipped) run.skipped(reason);
    for (const geometry::Material& m : mesh.materials)
        if (m.isOpening() && !daylight::isPossible(m))
            run.warn(fmt::format(
                "material {}: no pane of refractive index {:.3g} passes more than {:.3f}; taken for "
                "one that does not absorb",
                m.name, m.refractiveIndex, daylight::maximumTransmittance(m.refractiveIndex)));
    if (!mayBeLit(mesh))
        run.warn(
            "there is no window, no skylight and nothing that emits light: everything is dark (in models, "
            "glass is what has a transmittance, Tf)");
    return transport;
}

bool mayBeLit(const geometry::PatchMesh& mesh) {
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const geometry::Material& material = mesh.materials[mesh.material[i]];
        if ((material.isOpening() && mesh.twin[i] == geometry::kNoTwin) || material.exitance != glm::vec3(0))
            return true;
    }
    return false;
}

compute::Moment solveLight(Run& run, compute::DaylightTransport& transport, const daylight::Sky& sky,
                           double worldPerBuilding) {
    compute::Moment moment = std::move(solveLights(run, transport, std::span(&sky, 1))[0]);
    reportMoment(run, moment.report, worldPerBuilding);
    if (const size_t count = transport.report().sensorsNearWalls; count > 0)
        run.modelled(fmt::format("walls beside {} sensors, taken apart", count));
    return moment;
}

std::vector<compute::Moment> solveLights(Run& run, compute::DaylightTransport& transport,
                                         std::span<const daylight::Sky> skies) {
    const StageTimer timer(run, "solve");
    std::vector<compute::Moment> moments = transport.light(skies);
    for (const compute::Moment& moment : moments) {
        expectFinite(moment);
        warnOfTolerance(run, moment.report);
    }
    return moments;
}

void reportMoment(Run& run, const compute::MomentReport& r, double worldPerBuilding) {
    reportRadiosity(run, r, worldPerBuilding);
    for (const std::string& what : r.modelled) run.modelled(what);
    for (const std::string& what : r.skipped) run.skipped(what);
}

void FrameTally::add(const compute::MomentReport& report) {
    if (frames_++ == 0 || !(report.radiosity.bound <= worst_.radiosity.bound)) worst_ = report;
    for (const std::string& what : report.modelled) ++modelled_[what];
    for (const std::string& what : report.skipped) ++skipped_[what];
}

void FrameTally::report(Run& run, double worldPerBuilding) const {
    if (frames_ == 0) return;
    reportRadiosity(run, worst_, worldPerBuilding);
    for (const auto& [what, count] : modelled_)
        run.modelled(count == frames_ ? what : fmt::format("{}: {} frames", what, count));
    for (const auto& [what, count] : skipped_)
        run.skipped(count == frames_ ? what : fmt::format("{} frames: {}", count, what));
}

LightFigures lightFigures(const geometry::PatchMesh& mesh, const compute::Moment& moment) {
    std::vector<std::pair<double, double>> exitanceAndArea;
    LightFigures figures;
    double areaSum = 0, fluxSum = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        if (mesh.role[i] != geometry::Role::projection || mesh.materials[mesh.material[i]].isOpening())
            continue;
        const double area = geometry::patchArea(mesh, i);
        const double lux = compute::photometric(moment.patches[i].total());
        exitanceAndArea.emplace_back(compute::photometric(moment.lighting.exitance[i]), area);
        areaSum += area;
        fluxSum += area * lux;
        figures.maxLux = std::max(figures.maxLux, lux);
    }
    if (areaSum <= 0) return figures;
    figures.meanLux = fluxSum / areaSum;
    std::ranges::sort(exitanceAndArea, {}, &std::pair<double, double>::first);
    const auto percentile = [&](double share) {
        return passes::weightedQuantile(exitanceAndArea, areaSum, share);
    };
    const double dark = percentile(0.05);
    figures.glareRatio = dark > 0 ? percentile(0.95) / dark : 0;
    return figures;
}

} // namespace heliodon::app
