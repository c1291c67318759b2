// How long does a building take to mesh, and how uniform are its triangles? Usage: meshing_bench
// SKETCH.json...
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "geometry/mesher.h"

using namespace heliodon::geometry;

namespace {

// Median of 21 runs, in milliseconds.
template<class Work> double medianMs(Work work) {
    std::vector<double> times;
    for (int run = 0; run < 21; ++run) {
        const auto start = std::chrono::steady_clock::now();
        work();
        times.push_back(
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    }
    std::ranges::sort(times);
    return times[times.size() / 2];
}

} // namespace

int main(int count, char** arguments) {
    std::printf("sketch,asked,triangles,close_ms,mesh_ms,min_angle_deg,area_deviation\n");
    for (int i = 1; i < count; ++i) {
        const Sketch sketch = readSketch(arguments[i]);
        const Closure closure = closeSketch(sketch);
        if (!closure.building) continue;
        const double closing = medianMs([&] { closeSketch(sketch); });
        for (const size_t asked : {500u, 1000u, 2000u, 5000u, 10000u, 20000u, 50000u}) {
            const double meshing = medianMs([&] { meshBuilding(*closure.building, {asked}); });
            const MeshQuality quality = measureMesh(meshBuilding(*closure.building, {asked}));
            std::printf("%s,%zu,%zu,%.2f,%.2f,%.1f,%.3f\n", sketch.id.c_str(), asked, quality.triangles,
                        closing, meshing, quality.minAngleDeg, quality.areaDeviation);
        }
    }
}
