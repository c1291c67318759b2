// Question: does `lux_error` hold in rooms that nothing was set on? lux_error_bench [SCENES [TRIANGLES
// [FINE_TRIANGLES [FIRST_SEED]]]]: sketches at random (walls straight and curved, partitions that leave
// slots, a second room behind a door, windows, skylights, fabric, reflectances of 0.2 to 0.9), under an
// overcast sky and two suns each, against the same rooms in many more triangles. Per scene: values, how many
// lie inside, RMS and worst error, median lux_error, the worst error over lux_error and at which sky and
// sensor.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "benches/bench_main.h"
#include "compute/daylight_transport.h"
#include "compute/gpu/device.h"
#include "geometry/bounds.h"
#include "geometry/building.h"
#include "geometry/mesher.h"
#include "tests/compute/skies.h"

using namespace heliodon;

namespace {

using glm::dvec2;
using glm::dvec3;

class RandomScene {
public:
    explicit RandomScene(uint32_t seed) : random_(seed) {
        const double w = between(8, 18), d = between(8, 16);
        const dvec2 corners[] = {{-w / 2, -d / 2}, {w / 2, -d / 2}, {w / 2, d / 2}, {-w / 2, d / 2}};
        for (int k = 0; k < 4; ++k) {
            const dvec2 a = corners[k], b = corners[(k + 1) % 4];
            if (k == 1 && chance(0.3)) { // half a circle
                geometry::Arc arc;
                arc.center = 0.5 * (a + b), arc.radius = d / 2, arc.a0Deg = -90, arc.a1Deg = 90;
                sketch_.arcs.push_back(arc), name_ += " curved";
                continue;
            }
            addWall(a, b);
            if (k == 0 || chance(0.3)) addWindow(between(0.25, 0.75) * glm::length(b - a));
        }
        if (chance(0.4)) { // a wall with a door
            const double x = between(-0.1, 0.3) * w, door = between(2, 3);
            addWall({x, -d / 2}, {x, d / 2 - door - 1});
            addWall({x, d / 2 - 1}, {x, d / 2});
            name_ += " two rooms";
        }
        if (chance(0.5)) { // a partition near a wall: a slot
            const double gap = between(0.5, 1.2);
            addWall({-w / 2 + gap, -0.3 * d}, {-w / 2 + gap, 0.3 * d},
                    chance(0.5) ? geometry::HeightClass::blue : geometry::HeightClass::red);
            name_ += " slot";
        }
        if (chance(0.5)) {
            addWall({-0.15 * w, -0.1 * d}, {-0.15 * w, 0.3 * d}, geometry::HeightClass::green);
            name_ += " partition";
        }
        if (chance(0.4)) {
            geometry::Skylight light;
            light.center = {-0.2 * w, 0.2 * d}, light.size = {between(0.4, 3), between(1, 3)};
            light.angleDeg = between(0, 90);
            sketch_.skylights.push_back(light), name_ += " skylight";
        }
        if (chance(0.15)) {
            sketch_.windows[0].blind = geometry::parseBlind("fabric:0.3");
            name_ += " fabric";
        }
        int id = 0;
        for (auto& wall : sketch_.walls) wall.id = fmt::format("w{}", id++);
        for (auto& arc : sketch_.arcs) arc.id = fmt::format("a{}", id++);
        for (auto& window : sketch_.windows) window.id = fmt::format("win{}", id++);
        for (auto& light : sketch_.skylights) light.id = fmt::format("s{}", id++);
        const auto rho = [&] { return glm::vec3(static_cast<float>(between(0.2, 0.9))); };
        options_.wallReflectance = rho(), options_.floorReflectance = rho();
        options_.ceilingReflectance = rho();
    }

    const std::string& name() const { return name_; }
    geometry::Closure close(size_t triangles) {
        if (const double surface = geometry::surfaceOfRooms(sketch_, options_); surface > 0)
            options_.facetLength = geometry::fittingFacet(surface, {triangles});
        return geometry::closeSketch(sketch_, options_);
    }

    // A third on the work plane, a third anywhere looking anywhere, a third a hair from surfaces.
    std::vector<compute::Sensor> sensors(const geometry::PatchMesh& mesh) {
        std::vector<compute::Sensor> sensors;
        const auto [low, high] = geometry::boundsOf(mesh.vertices);
        for (int k = 0; k < 8; ++k) {
            const dvec3 at(between(low.x, high.x), low.y + 0.25 * (high.y - low.y), between(low.z, high.z));
            sensors.push_back({at, {0, 1, 0}});
        }
        for (int k = 0; k < 8; ++k) {
            dvec3 at, n;
            for (int axis = 0; axis < 3; ++axis)
                at[axis] = between(low[axis], high[axis]), n[axis] = between(-1, 1);
            sensors.push_back({at, glm::normalize(n)});
        }
        for (int k = 0; k < 8; ++k) {
            const auto patch = static_cast<size_t>(between(0, static_cast<double>(mesh.patchCount())));
            const dvec3 n = geometry::patchNormal(mesh, patch);
            sensors.push_back({geometry::patchCentroid(mesh, patch) + std::pow(10, between(-5, -3)) * n, n});
        }
        return sensors;
    }

    daylight::Sky sun() {
        const double angle = between(0, 2 * std::numbers::pi);
        return test::sunny({std::cos(angle), between(0.1, 1.5), std::sin(angle)});
    }

private:
    double between(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }
    bool chance(double p) { return between(0, 1) < p; }
    void addWall(dvec2 a, dvec2 b, geometry::HeightClass height = geometry::HeightClass::red) {
        geometry::Wall wall;
        wall.a = a, wall.b = b, wall.heightClass = height;
        sketch_.walls.push_back(wall);
    }
    void addWindow(double pos) {
        geometry::WindowMarker window;
        window.wall = fmt::format("w{}", sketch_.walls.size() - 1);
        window.pos = pos, window.width = between(1, 2.5);
        window.kind = chance(0.5) ? geometry::WindowKind::standard : geometry::WindowKind::picture;
        sketch_.windows.push_back(window);
    }

    std::mt19937 random_;
    geometry::Sketch sketch_;
    geometry::ClosureOptions options_;
    std::string name_;
};

size_t valuesOfAll = 0, insideOfAll = 0;

void runScene(gpu::Device& device, uint32_t seed, size_t triangles, size_t fine) {
    RandomScene scene(seed);
    const geometry::Closure closure = scene.close(triangles);
    if (!closure.building) {
        std::printf("| %u%s | refused: %s |\n", seed, scene.name().c_str(), closure.report.code.c_str());
        return;
    }
    const geometry::PatchMesh mesh = geometry::meshBuilding(*closure.building, {triangles});
    const std::vector<compute::Sensor> sensors = scene.sensors(mesh);
    const daylight::Sky skies[] = {test::overcast(), scene.sun(), scene.sun()};
    compute::TransportOptions options;
    options.errorByPlace = true; // as for tables
    const auto light = [&](const geometry::PatchMesh& of) {
        compute::DaylightTransport transport(device, of, options);
        transport.setSensors(sensors);
        return transport.light(skies);
    };
    const std::vector<compute::Moment> stated = light(mesh),
                                       there = light(geometry::meshBuilding(*closure.building, {fine}));
    std::vector<double> claims;
    double squares = 0, worst = 0, most = 0;
    size_t inside = 0, outside[3] = {}, worstSky = 0, worstSensor = 0;
    for (size_t k = 0; k < 3; ++k)
        for (size_t s = 0; s < sensors.size(); ++s) {
            const double lux = compute::photometric(stated[k].sensors[s].total()),
                         exact = compute::photometric(there[k].sensors[s].total()),
                         error = static_cast<double>(stated[k].sensors[s].error);
            if (exact < 0.5) continue; // in no room, or in the dark
            const double off = std::abs(lux / exact - 1);
            claims.push_back(error / exact);
            squares += off * off, worst = std::max(worst, off);
            std::abs(lux - exact) <= error ? ++inside : ++outside[s / 8];
            if (const double over = std::abs(lux - exact) / error; over > most)
                most = over, worstSky = k, worstSensor = s;
        }
    if (claims.empty()) return;
    std::ranges::nth_element(claims, claims.begin() + static_cast<std::ptrdiff_t>(claims.size() / 2));
    valuesOfAll += claims.size(), insideOfAll += inside;
    std::printf("| %u%s | %zu | %zu | %zu of %zu | %.2f | %.1f | %.2f | %.2f at %zu.%zu | %zu %zu %zu |\n",
                seed, scene.name().c_str(), mesh.patchCount(), there[0].patches.size(), inside, claims.size(),
                100 * std::sqrt(squares / static_cast<double>(claims.size())), 100 * worst,
                100 * claims[claims.size() / 2], most, worstSky, worstSensor, outside[0], outside[1],
                outside[2]);
}

void bench(int argc, char** argv) {
    const auto argument = [&](int k, int otherwise) { return argc > k ? std::atoi(argv[k]) : otherwise; };
    gpu::Device device;
    std::printf(
        "device \"%s\"\n| scene | triangles | fine | inside | RMS %% | worst %% | median lux_error %% | "
        "worst over lux_error | outside on the work plane, anywhere, by surfaces "
        "|\n|---|---|---|---|---|---|---|---|---|\n",
        device.info().name.c_str());
    const int first = argument(4, 1);
    for (int seed = first; seed < first + argument(1, 20); ++seed)
        runScene(device, static_cast<uint32_t>(seed), static_cast<size_t>(argument(2, 600)),
                 static_cast<size_t>(argument(3, 5000)));
    std::printf("all: %zu of %zu inside, %.2f %%\n", insideOfAll, valuesOfAll,
                100 * static_cast<double>(insideOfAll) /
                    static_cast<double>(std::max<size_t>(1, valuesOfAll)));
}

} // namespace

int main(int argc, char** argv) {
    return benchMain(argc, argv, 0, "lux_error_bench [SCENES [TRIANGLES [FINE_TRIANGLES [FIRST_SEED]]]]",
                     bench);
}
