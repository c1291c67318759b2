// Question: what does another moment of light cost, stage by stage, and what of that does the solver save
// once it has seen a few? relight_bench MODEL.obj [tinted]: faces of the model as they are; `tinted` makes
// its materials coloured, which takes three channels. CPU seconds (all threads of the process) stand beside
// wall seconds, since machines are shared. `difference`: the largest of exitance from what a solution from
// scratch to 1e-6 gives, over the largest exitance; it should be below `bound`.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <vector>

#include "benches/bench_main.h"
#include "compute/daylight_transport.h"
#include "compute/gpu/device.h"
#include "compute/stopwatch.h"
#include "geometry/model_file.h"

using namespace heliodon;

namespace {

daylight::Sky skyAt(glm::dvec3 sun, double normalLux) {
    daylight::Sky sky = daylight::cieClearSky(sun, 1700);
    daylight::lightGround(sky, 0.2);
    sky.sun = {sun, normalLux};
    return sky;
}

void print(const char* what, bool sun, size_t round, double wall, double cpu, double difference,
           const compute::MomentReport& r) {
    std::printf("%s sun=%d round=%zu wall_ms=%.2f cpu_ms=%.2f combine_ms=%.2f sun_ms=%.2f solve_ms=%.2f "
                "passes=%u bound=%.1e difference=%.1e\n",
                what, sun, round, 1e3 * wall, 1e3 * cpu, 1e3 * r.combineSeconds, 1e3 * r.sunSeconds,
                1e3 * r.solveSeconds, r.radiosity.passes, r.radiosity.bound, difference);
}

class Bench {
public:
    Bench(gpu::Device& device, const geometry::PatchMesh& mesh)
        : device_(device), mesh_(mesh), exact_(device, mesh, precise()) {}

    // The same moment again and again.
    void still(bool sun) {
        compute::DaylightTransport transport(device_, mesh_);
        const std::vector<daylight::Sky> skies{
            skyAt(glm::normalize(glm::dvec3(-0.258, 0.705, 0.661)), sun ? 72000 : 0)};
        for (size_t round = 0; round < 5; ++round) step("still", transport, skies, sun, round, true);
    }

    // A clear day, sun and sky moving on in steps of a quarter of a degree, eight moments at once: what a
    // time-lapse asks for.
    void sequence(bool sun) {
        compute::DaylightTransport transport(device_, mesh_);
        constexpr size_t kTogether = 8, kRounds = 48;
        for (size_t round = 0; round < kRounds; ++round) {
            std::vector<daylight::Sky> skies;
            for (size_t k = 0; k < kTogether; ++k) {
                const double angle = 0.3 + 0.00436 * static_cast<double>(round * kTogether + k);
                const glm::dvec3 at(-std::cos(angle), 0.8 * std::sin(angle), 0.6 * std::sin(angle));
                skies.push_back(skyAt(at, sun ? 72000 : 0));
            }
            step("sequence", transport, skies, sun, round, round % 8 == 0 || round + 1 == kRounds);
        }
    }

private:
    static compute::TransportOptions precise() {
        compute::TransportOptions options;
        options.radiosity.tolerance = 1e-6;
        return options;
    }

    void step(const char* what, compute::DaylightTransport& transport,
              const std::vector<daylight::Sky>& skies, bool sun, size_t round, bool shown) {
        const compute::Stopwatch watch;
        const std::clock_t cpu = std::clock();
        const std::vector<compute::Moment> moments = transport.light(skies);
        const double each = 1.0 / static_cast<double>(skies.size()), wall = each * watch.seconds(),
                     cpuSeconds = each * static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
        if (shown)
            print(what, sun, round, wall, cpuSeconds, difference(moments.back(), skies.back()),
                  moments.back().report);
    }

    double difference(const compute::Moment& moment, const daylight::Sky& sky) {
        exact_.setMaterials(mesh_.materials); // forgets what was solved before
        const compute::Moment exact = exact_.light(sky);
        float largest = 0, off = 0;
        for (size_t i = 0; i < mesh_.patchCount(); ++i)
            for (int c = 0; c < 3; ++c) {
                largest = std::max(largest, exact.lighting.exitance[i][c]);
                off = std::max(off, std::abs(moment.lighting.exitance[i][c] - exact.lighting.exitance[i][c]));
            }
        return largest > 0 ? static_cast<double>(off / largest) : 0;
    }

    gpu::Device& device_;
    const geometry::PatchMesh& mesh_;
    compute::DaylightTransport exact_;
};

void bench(int argc, char** argv) {
    const bool tinted = argc == 3 && std::strcmp(argv[2], "tinted") == 0;
    if (argc > 2 && !tinted) throw std::invalid_argument(std::string(argv[2]) + ": expected 'tinted'");
    gpu::Device device;
    std::printf("device \"%s\"\n", device.info().name.c_str());
    geometry::PatchMesh mesh = geometry::readPatches(argv[1]);
    if (tinted)
        for (geometry::Material& m : mesh.materials) m.reflectance *= glm::vec3(1, 0.9f, 0.8f);
    Bench bench(device, mesh);
    for (bool sun : {false, true}) {
        bench.still(sun);
        bench.sequence(sun);
    }
}

} // namespace

int main(int argc, char** argv) {
    return benchMain(argc, argv, 1, "relight_bench MODEL.obj [tinted]", bench);
}
