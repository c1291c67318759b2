// Question: what do form factors, gather and relight cost on this device, and how large is the error that the
// time buys? transport_bench MODEL.obj [REFERENCE.f32]: faces of the model as they are; the reference is an
// exact float32 matrix. CPU seconds (all threads of the process) stand beside wall seconds, since machines
// are shared.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <functional>
#include <vector>

#include "compute/daylight_transport.h"
#include "compute/form_factors.h"
#include "compute/gpu/device.h"
#include "compute/radiosity_gather.h"
#include "compute/stopwatch.h"
#include "geometry/model_file.h"

using namespace heliodon;

namespace {

struct Time {
    double wall = 0, cpu = 0;
};

// Median of `runs` by wall time, after one run that pays for compilation.
Time timed(int runs, const std::function<void()>& work) {
    work();
    std::vector<Time> times;
    for (int k = 0; k < runs; ++k) {
        const compute::Stopwatch watch;
        const std::clock_t cpu = std::clock();
        work();
        times.push_back({watch.seconds(), static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC});
    }
    std::sort(times.begin(), times.end(), [](const Time& a, const Time& b) { return a.wall < b.wall; });
    return times[times.size() / 2];
}

std::vector<float> readReference(const char* path, size_t n) {
    std::vector<float> values(n * n);
    std::ifstream in(path, std::ios::binary);
    in.read(reinterpret_cast<char*>(values.data()),
            static_cast<std::streamsize>(values.size() * sizeof(float)));
    return values;
}

double rowError(const std::vector<float>& F, const std::vector<float>& reference, size_t n) {
    double sum = 0;
    for (size_t k = 0; k < F.size(); ++k) sum += std::pow(double{F[k]} - reference[k], 2);
    return std::sqrt(sum / static_cast<double>(n));
}

void benchFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh, const char* reference) {
    const size_t n = mesh.patchCount();
    std::vector<float> exact;
    if (reference) exact = readReference(reference, n);
    for (uint32_t points : {1u, 4u})
        for (uint32_t resolution : {32u, 64u, 128u}) {
            compute::FormFactorOptions options;
            options.kernel = "hemicube";
            options.resolution = resolution;
            options.points = points;
            compute::FormFactors F;
            const Time time = timed(1, [&] { F = compute::computeFormFactors(device, mesh, options); });
            std::printf(
                "formfactors hemicube n=%zu resolution=%u points=%u wall_s=%.4f cpu_s=%.4f closure_max=%.2e "
                "reciprocity=%.2e row_error=%.3e\n",
                n, resolution, points, time.wall, time.cpu, F.report.closureMax,
                F.report.reciprocityRms.value(),
                reference ? rowError(F.values.download<float>(n * n), exact, n) : std::nan(""));
        }
}

void benchGather(gpu::Device& device, const geometry::PatchMesh& mesh) {
    const auto n = static_cast<uint32_t>(mesh.patchCount());
    const compute::FormFactors F = compute::computeFormFactors(device, mesh);
    const std::vector<float> matrix = F.values.download<float>(size_t{n} * n);
    compute::RadiosityGather gather(device, F.values, n);
    for (uint32_t columns : {1u, 3u, 4u}) {
        std::vector<float> in(size_t{n} * columns, 1.0f), out(in.size());
        const Time time = timed(21, [&] { gather.gather(in, out, columns); });
        const Time native = timed(21, [&] { // one thread, sixteen partial sums
            for (uint32_t c = 0; c < columns; ++c)
                for (uint32_t i = 0; i < n; ++i) {
                    float parts[16]{};
                    for (uint32_t j = 0; j + 16 <= n; j += 16)
                        for (uint32_t k = 0; k < 16; ++k)
                            parts[k] += matrix[size_t{i} * n + j + k] * in[size_t{c} * n + j + k];
                    out[size_t{c} * n + i] = parts[0] + parts[5] + parts[10] + parts[15];
                }
        });
        std::printf("gather n=%u columns=%u wall_ms=%.3f cpu_ms=%.3f GB/s=%.1f native_1_thread_ms=%.3f\n", n,
                    columns, 1e3 * time.wall, 1e3 * time.cpu, 4e-9 * n * n / time.wall, 1e3 * native.wall);
    }
}

void benchRelight(gpu::Device& device, const geometry::PatchMesh& mesh) {
    compute::DaylightTransport transport(device, mesh);
    daylight::Sky sky = daylight::cieClearSky({-0.258, 0.705, 0.661}, 1700);
    daylight::lightGround(sky, 0.2);
    for (double sun : {0.0, 72000.0}) {
        sky.sun = {{-0.2588, 0.7047, 0.6606}, sun};
        compute::Moment moment;
        const Time time = timed(21, [&] { moment = transport.light(sky); });
        std::printf("relight n=%zu sun=%d wall_ms=%.2f cpu_ms=%.2f combine_ms=%.2f sun_ms=%.2f solve_ms=%.2f "
                    "passes=%u "
                    "bound=%.1e\n",
                    mesh.patchCount(), sun > 0, 1e3 * time.wall, 1e3 * time.cpu,
                    1e3 * moment.report.combineSeconds, 1e3 * moment.report.sunSeconds,
                    1e3 * moment.report.solveSeconds, moment.report.radiosity.passes,
                    moment.report.radiosity.bound);
    }
}

// A clear day, sun and sky moving on in steps of a quarter of a degree, eight moments at once: what a
// time-lapse asks for. The first steps teach the solver.
void benchSequence(gpu::Device& device, const geometry::PatchMesh& mesh, bool sun) {
    compute::DaylightTransport transport(device, mesh);
    constexpr size_t kTogether = 8, kRounds = 48;
    for (size_t round = 0; round < kRounds; ++round) {
        std::vector<daylight::Sky> skies;
        for (size_t k = 0; k < kTogether; ++k) {
            const double angle = 0.3 + 0.00436 * static_cast<double>(round * kTogether + k);
            const glm::dvec3 at(-std::cos(angle), 0.8 * std::sin(angle), 0.6 * std::sin(angle));
            skies.push_back(daylight::cieClearSky(at, 1700));
            daylight::lightGround(skies.back(), 0.2);
            if (sun) skies.back().sun = {at, 72000.0};
        }
        const std::clock_t cpu = std::clock();
        const std::vector<compute::Moment> moments = transport.light(skies);
        if (round % 8 != 0 && round + 1 != kRounds) continue;
        const compute::MomentReport& r = moments.back().report;
        std::printf(
            "sequence n=%zu sun=%d round=%zu cpu_ms_each=%.2f combine_ms=%.2f sun_ms=%.2f solve_ms=%.2f "
            "passes=%u bound=%.1e\n",
            mesh.patchCount(), sun, round,
            1e3 * static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC / kTogether,
            1e3 * r.combineSeconds, 1e3 * r.sunSeconds, 1e3 * r.solveSeconds, r.radiosity.passes,
            r.radiosity.bound);
    }
}

} // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "transport_bench MODEL.obj [REFERENCE.f32]\n");
        return 2;
    }
    gpu::Device device;
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    std::printf("device \"%s\"\n", device.info().name.c_str());
    geometry::PatchMesh mesh = geometry::readPatches(argv[1]);
    if (argc > 3) // colours
        for (geometry::Material& m : mesh.materials) m.reflectance *= glm::vec3(1, 0.9f, 0.8f);
    if (argc > 2) benchFormFactors(device, mesh, argv[2]);
    benchGather(device, mesh);
    benchRelight(device, mesh);
    for (bool sun : {false, true}) benchSequence(device, mesh, sun);
}
