// Question: how large is the error of illuminance at sensors, whole and part by part, for the time that it
// takes? illuminance_bench FOLDER [TRIANGLES,TRIANGLES... [KERNEL [ROW_ERROR]]]: every case in FOLDER
// (model.obj, sky.json where the sky lights it, sensors.csv with lux_ref), z up. Relative errors, beside the
// share of sensors whose true error lies within lux_error and the median of lux_error; `beyond noise`: less
// the reference's own random error (its variance; two standard errors); CPU seconds (all threads) beside wall
// seconds.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>

#include "benches/bench_main.h"
#include "compute/daylight_transport.h"
#include "compute/gpu/device.h"
#include "geometry/mesher.h"
#include "geometry/model_file.h"
#include "tests/compute/cases.h"

using namespace heliodon;

namespace {

double cpuSeconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double wallSeconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void runCase(gpu::Device& device, const std::filesystem::path& folder, size_t triangles,
             const compute::TransportOptions& options) {
    const test::DaylightCase room = test::readCase(folder);
    const geometry::PatchMesh mesh =
        geometry::meshBuilding(geometry::importModel(folder / "model.obj", geometry::UpAxis::z),
                               {.triangles = triangles, .ofModel = true});
    const double cpu = cpuSeconds(), wall = wallSeconds();
    compute::DaylightTransport transport(device, mesh, options);
    const double factors = cpuSeconds() - cpu;
    transport.setSensors(room.sensors);
    const double sensors = cpuSeconds() - cpu - factors;
    const compute::Moment moment = transport.light(room.sky);
    const double allCpu = cpuSeconds() - cpu, allWall = wallSeconds() - wall;
    const test::Deviation shade = test::deviation(room, moment), all = test::deviation(room, moment, true);
    std::vector<double> claimed;
    for (const compute::LightParts& parts : moment.sensors)
        claimed.push_back(parts.error / std::max(1e-9, compute::photometric(parts.total())));
    std::nth_element(claimed.begin(), claimed.begin() + static_cast<std::ptrdiff_t>(claimed.size() / 2),
                     claimed.end());
    std::printf(
        "| %-44s | %5zu | %5.2f | %5.2f | %5.2f | %5.2f | %+5.2f | %5.2f | %5.1f | %5.2f | %5.2f %5.2f "
        "%5.2f | %5.2f |\n",
        folder.filename().c_str(), mesh.patchCount(), 100 * shade.rms, 100 * shade.rmsBeyondNoise,
        100 * shade.worst, 100 * shade.worstBeyondNoise, 100 * shade.bias, 100 * all.rms, 100 * all.inside,
        100 * claimed[claimed.size() / 2], factors, sensors, allCpu - factors - sensors, allWall);
}

void bench(int argc, char** argv) {
    gpu::Device device;
    std::vector<std::filesystem::path> folders;
    for (const auto& entry : std::filesystem::directory_iterator(argv[1]))
        if (std::filesystem::exists(entry.path() / "sensors.csv")) folders.push_back(entry.path());
    if (folders.empty()) folders.push_back(argv[1]);
    std::sort(folders.begin(), folders.end());
    compute::TransportOptions options;
    if (argc > 3) options.formFactors.kernel = argv[3];
    if (argc > 4) options.formFactors.maxError = std::atof(argv[4]);
    std::printf("device \"%s\"\n", device.info().name.c_str());
    std::printf("| case | triangles | RMS %% | beyond noise | worst %% | beyond noise | mean %% | with sun: "
                "RMS | inside %% | median "
                "lux_error %% | CPU s: factors, sensors, light | wall s "
                "|\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    std::string list = argc > 2 ? argv[2] : "2000";
    for (const auto& folder : folders)
        for (const char* at = list.c_str(); at; at = std::strchr(at, ','), at = at ? at + 1 : nullptr)
            runCase(device, folder, static_cast<size_t>(std::atoi(at)), options);
}

} // namespace

int main(int argc, char** argv) {
    return benchMain(argc, argv, 1, "illuminance_bench FOLDER [TRIANGLES,TRIANGLES... [KERNEL [ROW_ERROR]]]",
                     bench);
}
