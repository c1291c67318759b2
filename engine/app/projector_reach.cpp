#include "engine/app/projector_reach.h"

#include <array>
#include <functional>
#include <map>
#include <numeric>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "engine/app/overlay_tags.h"
#include "geometry/projector_visibility.h"
#include "geometry/sketch.h"

namespace heliodon::app {

using nlohmann::json;

namespace {

std::vector<geometry::OpticalDevice> projectorsOf(const geometry::Rig& rig) {
    return {rig.projectors.begin(), rig.projectors.end()};
}

// Which surface is meant, in feet of building.
json surfaceEntry(const geometry::SurfaceReach& reach, const std::string& material, glm::dvec3 middle,
                  double worldPerBuilding) {
    const double foot = geometry::kMetresPerFoot * worldPerBuilding; // an inch on the table
    const glm::dvec3 feet = middle / foot;
    return {{"surface", reach.surface},
            {"material", material},
            {"middle", {feet.x, -feet.z, feet.y}}, // as in a sketch: x right, y up the table, then height
            {"area", reach.area / (foot * foot)},
            {"unreachable", reach.unreachable / (foot * foot)}};
}

// The triangles of projection surfaces, in world metres, that no projector reaches and the camera sees.
std::vector<std::array<glm::dvec3, 3>> unreachableTriangles(const Scene& scene) {
    std::vector<std::array<glm::dvec3, 3>> out;
    if (!scene.rig || scene.rig->projectors.empty()) return out;
    std::vector<geometry::OpticalDevice> devices = projectorsOf(*scene.rig);
    const uint32_t camera = 1u << devices.size();
    devices.push_back(scene.rig->camera);
    const geometry::ProjectorMesh split =
        geometry::splitByProjectorVisibility(scene.mesh, scene.occluders, devices, {.atAnyAngle = camera});
    for (size_t t = 0; t < split.triangleCount(); ++t)
        if (split.visible[t] == camera)
            out.push_back({split.vertices[split.triangles[3 * t]], split.vertices[split.triangles[3 * t + 1]],
                           split.vertices[split.triangles[3 * t + 2]]});
    return out;
}

} // namespace

uint32_t reachingProjectors(std::span<const uint32_t> visible) {
    return std::reduce(visible.begin(), visible.end(), 0u, std::bit_or());
}

void warnOfBlack(Run& run, const geometry::Rig& rig, uint32_t reaching) {
    for (size_t p = 0; p < rig.projectors.size(); ++p)
        if (!(reaching >> p & 1u))
            run.warn(
                fmt::format("projector '{}' reaches no wall and no floor, its picture is black: are its R "
                            "and t right?",
                            rig.projectors[p].id));
}

void reportReach(Run& run, const Scene& scene) {
    if (!scene.rig || scene.rig->projectors.empty()) return;
    const StageTimer timer(run, "visibility");
    const auto devices = projectorsOf(*scene.rig);
    const geometry::ProjectorMesh split =
        geometry::splitByProjectorVisibility(scene.mesh, scene.occluders, devices);
    warnOfBlack(run, *scene.rig, reachingProjectors(split.visible));
    struct Place {
        glm::dvec3 sum{0};
        double area = 0;
        uint32_t material = 0;
    };
    std::map<uint32_t, Place> places;
    for (size_t i = 0; i < scene.mesh.patchCount(); ++i) {
        Place& place = places[scene.mesh.surface[i]];
        const double area = geometry::patchArea(scene.mesh, i);
        place.sum += area * geometry::patchCentroid(scene.mesh, i);
        place.area += area;
        place.material = scene.mesh.material[i];
    }
    double area = 0, unreachable = 0;
    json surfaces = json::array();
    for (const geometry::SurfaceReach& reach : split.surfaces) {
        const Place& place = places.at(reach.surface);
        surfaces.push_back(surfaceEntry(reach, scene.mesh.materials[place.material].name,
                                        place.sum / place.area, scene.worldPerBuilding));
        area += surfaces.back()["area"].get<double>();
        unreachable += surfaces.back()["unreachable"].get<double>();
    }
    run.report()["projector_reach"] = {{"triangles", split.triangleCount()},
                                       {"area", area},
                                       {"unreachable", unreachable},
                                       {"surfaces", std::move(surfaces)}};
    if (unreachable > 0.01 * area)
        run.note(fmt::format("no projector reaches {:.0f} of {:.0f} ft2 of walls and floor ({:.0f} %)",
                             unreachable, area, 100 * unreachable / area));
}

void drawReachOverlay(const Scene& scene, const std::filesystem::path& photo,
                      const std::filesystem::path& png) {
    writeOverlay(vision::readPhotograph(photo), *scene.rig, *scene.sketch, png, unreachableTriangles(scene));
}

} // namespace heliodon::app
