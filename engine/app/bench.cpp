#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <thread>

#include <fmt/format.h>

#include "compute/form_factors.h"
#include "compute/parallel.h"
#include "compute/radiosity_gather.h"
#include "compute/reference/form_factor_rows.h"
#include "compute/roofline.h"
#include "compute/stopwatch.h"
#include "engine/app/bench_clock.h"
#include "engine/app/bench_peers.h"
#include "engine/app/bench_plot.h"
#include "engine/app/bench_results.h"
#include "engine/app/bench_scenes.h"
#include "engine/app/commands.h"
#include "engine/app/interrupt.h"
#include "engine/app/output_folder.h"
#include "engine/app/progress.h"
#include "geometry/input_error.h"
#include "geometry/text_file.h"
#include "geometry/whole_file.h"

namespace heliodon::app {

namespace {

struct Setting {
    std::string kernel, name;
    compute::FormFactorOptions options;
    double raysPerPatch = 0;
};

// What each kernel is asked for. One that is not named here is asked for errors.
std::vector<Setting> settingsOf(const std::string& kernel) {
    std::vector<Setting> settings;
    const auto add = [&](const std::string& name, uint32_t resolution, uint32_t points, double maxError,
                         double rays) {
        compute::FormFactorOptions options;
        options.kernel = kernel;
        options.resolution = resolution;
        options.points = points;
        options.maxError = maxError;
        settings.push_back({kernel, name, options, rays});
    };
    if (kernel == "hemicube") {
        for (const uint32_t R : {32u, 64u, 128u}) add(fmt::format("{0}x{0}", R), R, 1, 0, 3.0 * R * R);
        add("64x64, 4 points", 64, 4, 0, 4 * 3.0 * 64 * 64);
    } else if (kernel == "montecarlo") {
        for (const uint32_t R : {16u, 32u, 64u, 128u}) add(std::to_string(R * R), R, 1, 0, R * R);
    } else {
        for (const int decade : {-2, -3, -4, -5})
            add(fmt::format("1e{}", decade), 64, 1, std::pow(10, decade), 0);
    }
    return settings;
}

// Rows of the double-precision oracle, spread evenly over the patches.
struct Reference {
    std::vector<size_t> rows;
    std::vector<compute::reference::FormFactorRows::Row> values;
};

Reference referenceOf(Run& run, const BenchScene& scene, size_t count) {
    Reference result;
    const size_t n = scene.mesh.patchCount();
    for (size_t k = 0; k < std::min(count, n); ++k)
        result.rows.push_back((2 * k + 1) * n / (2 * std::min(count, n)));
    result.values.resize(result.rows.size());
    const compute::reference::FormFactorRows oracle(scene.mesh);
    Progress progress("reference of " + scene.name, result.rows.size(), run.showsProgress());
    compute::inParallel(
        result.rows.size(), [&](size_t k) { result.values[k] = oracle.row(result.rows[k]); },
        [&](size_t done) { progress.advance(done); });
    return result;
}

void judge(const std::vector<float>& F, const Reference& reference, BenchResult& result) {
    const size_t n = result.patches;
    double squares = 0, uncertain = 0;
    for (size_t k = 0; k < reference.rows.size(); ++k) {
        double row = 0;
        uncertain += reference.values[k].error * reference.values[k].error;
        for (size_t j = 0; j < n; ++j) {
            const double d = double{F[reference.rows[k] * n + j]} - reference.values[k].factors[j];
            row += d * d;
            result.entryMax = std::max(result.entryMax, std::abs(d));
        }
        squares += row;
        result.rowErrorMax = std::max(result.rowErrorMax, std::sqrt(row));
    }
    result.rowError = std::sqrt(squares / static_cast<double>(reference.rows.size()));
    result.referenceError = std::sqrt(uncertain / static_cast<double>(reference.rows.size()));
}

// The process's own peak from now on, where the system keeps one.
void resetPeakMemory() {
    std::ofstream("/proc/self/clear_refs") << "5";
}
double peakMemory() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) return 1024 * std::stod(line.substr(6));
    return 0;
}

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
}

// Neither method nor device can do with less than writing the matrix once and one product rule of a single
// point, about 60 operations, for each pair.
double leastSeconds(const compute::Roofline& roofline, double n) {
    return roofline.seconds(60 * n * n / 2, 4 * n * n);
}

class Bench {
public:
    Bench(Run& run, const BenchArguments& arguments)
        : run_(run), arguments_(arguments), roofline_(compute::measureRoofline(run.device())) {}

    void scene(const BenchScene& scene) {
        scene_ = &scene;
        reference_ = referenceOf(run_, scene, arguments_.referenceRows);
        for (const std::string& kernel : arguments_.kernels)
            for (const Setting& setting : settingsOf(kernel))
                guarded(setting.kernel, setting.name, [&] { ours(setting); });
        if (arguments_.peers) peers();
        guarded("gather", "", [&] { gather(); });
    }

    std::vector<BenchResult> results;
    std::vector<GatherResult> gathers;
    const compute::Roofline& roofline() const { return roofline_; }

private:
    // One setting that fails (memory, say) is a row less, not the end.
    void guarded(const std::string& kernel, const std::string& setting, const std::function<void()>& work) {
        throwIfInterrupted();
        try {
            work();
        } catch (const geometry::InputError&) {
            throw;
        } catch (const Interrupted&) {
            throw;
        } catch (const std::exception& error) {
            run_.warn(fmt::format("{}, {} patches: {} {}: {}", scene_->name, scene_->mesh.patchCount(),
                                  kernel, setting, error.what()));
        }
    }

    void ours(const Setting& setting) {
        const auto n = static_cast<double>(scene_->mesh.patchCount());
        BenchResult result = begin(setting.kernel, setting.name);
        gpu::Device& device = run_.device();
        std::vector<double> wall, cpu, onDevice;
        compute::FormFactors F;
        // The first run pays for compilation and is not counted.
        for (int k = 0; k <= arguments_.runs; ++k) {
            F = {};
            if (k == 1) resetPeakMemory();
            device.startTiming();
            const BenchClock clock;
            F = compute::computeFormFactors(device, scene_->mesh, setting.options);
            double wallSeconds = 0, cpuSeconds = 0, measureWall = 0, measureCpu = 0;
            clock.stop(wallSeconds, cpuSeconds);
            const double onClock = device.timedSeconds();
            const BenchClock measuring; // closure and reciprocity are not the kernel's work
            compute::measureFormFactors(scene_->mesh, F.values, F.report);
            measuring.stop(measureWall, measureCpu);
            if (k == 0) continue;
            wall.push_back(F.report.seconds);
            cpu.push_back(std::max(0.0, cpuSeconds - measureCpu));
            onDevice.push_back(onClock);
        }
        result.peakBytes = peakMemory();
        result.wallSeconds = median(wall);
        result.cpuSeconds = median(cpu);
        result.deviceSeconds = median(onDevice);
        result.claimedRowError = F.report.claimedRowError;
        result.closureMax = F.report.closureMax;
        result.closureRms = F.report.closureRms;
        result.reciprocityRms = F.report.reciprocityRms.value();
        result.raysPerSecond = n * setting.raysPerPatch / result.wallSeconds;
        result.rooflineFraction = leastSeconds(roofline_, n) / result.wallSeconds;
        finish(std::move(result),
               F.values.download<float>(scene_->mesh.patchCount() * scene_->mesh.patchCount()));
    }

    void peers() {
        const auto add = [&](const std::string& kernel, const std::string& setting,
                             const std::function<PeerResult()>& work) {
            guarded(kernel, setting, [&] {
                BenchResult result = begin(kernel, setting);
                result.peer = true;
                PeerResult peer = work();
                result.wallSeconds = peer.wallSeconds;
                result.cpuSeconds = peer.cpuSeconds;
                result.raysPerSecond = peer.rays / peer.wallSeconds;
                gpu::Buffer values(run_.device(), peer.factors.size() * sizeof(float), "peer",
                                   gpu::Place::host);
                values.upload(peer.factors);
                compute::FormFactorReport report;
                compute::measureFormFactors(scene_->mesh, values, report);
                result.closureMax = report.closureMax;
                result.closureRms = report.closureRms;
                result.reciprocityRms = report.reciprocityRms.value();
                finish(std::move(result), peer.factors);
            });
        };
        if (hasEmbree()) {
            for (const uint32_t R : {32u, 64u, 128u})
                add("embree hemicube", fmt::format("{0}x{0}", R),
                    [&, R] { return embreeHemicube(scene_->mesh, R); });
            for (const uint32_t rays : {1024u, 4096u, 16384u})
                add("embree rays", std::to_string(rays),
                    [&, rays] { return embreeRays(scene_->mesh, rays); });
        }
        if (const std::string program = findView3d();
            !program.empty() && scene_->mesh.patchCount() <= kMostForView3d)
            for (const int decade : {-3, -4, -6})
                add("view3d", fmt::format("1e{}", decade),
                    [&, decade] { return view3d(program, scene_->mesh, std::pow(10, decade)); });
    }

    void gather();

    BenchResult begin(const std::string& kernel, const std::string& setting) {
        BenchResult result;
        result.scene = scene_->name;
        result.patches = scene_->mesh.patchCount();
        result.kernel = kernel;
        result.setting = setting;
        resetPeakMemory();
        return result;
    }

    void finish(BenchResult result, const std::vector<float>& F) {
        const auto n = static_cast<double>(result.patches);
        if (result.peakBytes == 0) result.peakBytes = peakMemory();
        result.pairsPerSecond = n * n / result.wallSeconds;
        result.bytesPerSecond = 4 * n * n / result.wallSeconds;
        judge(F, reference_, result);
        result.comparedSeconds = arguments_.clock == "CPU" ? result.cpuSeconds : result.wallSeconds;
        run_.note(fmt::format(
            "{:<12} {:>6} patches  {:<16} {:<16} {:9.4f} s  {:9.4f} CPU s  row error {:.2e}  closure "
            "{:.1e}",
            result.scene, result.patches, result.kernel, result.setting, result.wallSeconds,
            result.cpuSeconds, result.rowError, result.closureMax));
        results.push_back(std::move(result));
    }

    static constexpr size_t kMostForView3d = 4000; // minutes beyond

    Run& run_;
    const BenchArguments& arguments_;
    compute::Roofline roofline_;
    const BenchScene* scene_ = nullptr;
    Reference reference_;
};

// F B as the processor itself does it best: eight floats at a time, four sums, rows spread over all cores.
typedef float Float8 __attribute__((vector_size(32)));

[[gnu::always_inline]] inline void multiplyRows(const float* F, const float* B, float* out, size_t n,
                                                size_t columns, size_t first, size_t last) {
    for (size_t i = first; i < last; ++i)
        for (size_t c = 0; c < columns; ++c) {
            const float *row = F + i * n, *light = B + c * n;
            Float8 sums[4]{}, f, b;
            size_t j = 0;
            for (; j + 32 <= n; j += 32)
                for (size_t k = 0; k < 4; ++k) {
                    std::memcpy(&f, row + j + 8 * k, sizeof f);
                    std::memcpy(&b, light + j + 8 * k, sizeof b);
                    sums[k] += f * b;
                }
            float sum = 0;
            for (; j < n; ++j) sum += row[j] * light[j];
            for (const Float8& part : sums)
                for (int k = 0; k < 8; ++k) sum += part[k];
            out[c * n + i] = sum;
        }
}

using MultiplyRows = void (*)(const float*, const float*, float*, size_t, size_t, size_t, size_t);

#if defined(__x86_64__)
[[gnu::target("avx2,fma")]] void multiplyRowsWide(const float* F, const float* B, float* out, size_t n,
                                                  size_t columns, size_t first, size_t last) {
    multiplyRows(F, B, out, n, columns, first, last);
}
#endif

void multiplyRowsPlain(const float* F, const float* B, float* out, size_t n, size_t columns, size_t first,
                       size_t last) {
    multiplyRows(F, B, out, n, columns, first, last);
}

MultiplyRows bestMultiplyRows() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return multiplyRowsWide;
#endif
    return multiplyRowsPlain;
}

double nativeSeconds(const std::vector<float>& F, const std::vector<float>& B, size_t n, size_t columns) {
    std::vector<float> out(n * columns);
    const size_t workers = std::max(1u, std::thread::hardware_concurrency());
    const auto repeats = std::max<size_t>(3, 400'000'000 / (n * n * columns));
    const MultiplyRows multiply = bestMultiplyRows();
    const compute::Stopwatch watch;
    compute::inParallel(workers, [&](size_t w) {
        for (size_t k = 0; k < repeats; ++k)
            multiply(F.data(), B.data(), out.data(), n, columns, w * n / workers, (w + 1) * n / workers);
    });
    return watch.seconds() / static_cast<double>(repeats);
}

void Bench::gather() {
    gpu::Device& device = run_.device();
    const auto n = static_cast<uint32_t>(scene_->mesh.patchCount());
    compute::FormFactorOptions options; // any matrix of the scene will do
    options.kernel = "hemicube";
    options.resolution = 32;
    const compute::FormFactors F = compute::computeFormFactors(device, scene_->mesh, options);
    const std::vector<float> matrix = F.values.download<float>(size_t{n} * n);
    compute::RadiosityGather gather(device, F.values, n);
    for (const uint32_t columns : {1u, 3u}) {
        std::vector<float> B(size_t{n} * columns), out(B.size());
        for (size_t k = 0; k < B.size(); ++k) B[k] = 1 + static_cast<float>(k % 17) / 16;
        std::vector<double> seconds;
        for (int k = 0; k < 22; ++k) {
            const compute::Stopwatch watch;
            gather.gather(B, out, columns);
            if (k > 0) seconds.push_back(watch.seconds());
        }
        GatherResult result{scene_->name, n, columns, median(seconds), nativeSeconds(matrix, B, n, columns)};
        result.bytesPerSecond = 4.0 * n * n / result.wallSeconds;
        result.rooflineFraction = roofline_.seconds(2.0 * n * n * columns, 4.0 * n * n) / result.wallSeconds;
        for (size_t i = 0; i < n; ++i)
            for (uint32_t c = 0; c < columns; ++c) {
                double sum = 0;
                for (size_t j = 0; j < n; ++j) sum += double{matrix[i * n + j]} * double{B[c * n + j]};
                if (sum > 0) result.error = std::max(result.error, std::abs(out[c * n + i] - sum) / sum);
            }
        run_.note(fmt::format(
            "{:<12} {:>6} patches  gather, {} column{}  {:.3f} ms, {:.2f} of native, error {:.1e}",
            result.scene, n, columns, columns > 1 ? "s" : " ", 1e3 * result.wallSeconds,
            result.wallSeconds / result.nativeSeconds, result.error));
        gathers.push_back(result);
    }
}

template<class Result> nlohmann::ordered_json listOf(const std::vector<Result>& results) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Result& result : results) list.push_back(jsonOf(result));
    return list;
}

// Each once; "all" stands for `known`, beside others too.
template<class Names>
std::vector<std::string> expanded(const std::vector<std::string>& given, const Names& known) {
    std::vector<std::string> names;
    const auto add = [&](std::string_view name) {
        if (std::ranges::find(names, name) == names.end()) names.emplace_back(name);
    };
    for (const std::string& name : given) {
        if (name != "all")
            add(name);
        else
            std::ranges::for_each(known, add);
    }
    return names;
}

BenchArguments completed(BenchArguments arguments) {
    const auto known = compute::formFactorKernels();
    arguments.kernels = expanded(arguments.kernels, known);
    for (const std::string& kernel : arguments.kernels)
        if (kernel != "auto" && std::find(known.begin(), known.end(), kernel) == known.end()) {
            std::string names = "all, auto";
            for (const std::string_view name : known) names += ", " + std::string(name);
            throw geometry::InputError("--kernels", kernel, "unknown; expected " + names);
        }
    std::vector<std::string_view> scenes;
    for (const BuiltInScene& scene : builtInScenes()) scenes.emplace_back(scene.name);
    arguments.scenes = expanded(arguments.scenes, scenes);
    return arguments;
}

} // namespace

void execute(Run& run, const BenchArguments& given) {
    const BenchArguments arguments = completed(given);
    checkBenchScenes(arguments.scenes);
    const OutputFolder folder(arguments.output);
    const std::vector<BenchScene> scenes = [&] {
        const StageTimer timer(run, "scenes");
        return benchScenes(arguments.scenes, arguments.sizes, arguments.output);
    }();
    Bench bench(run, arguments);
    if (arguments.peers && !hasEmbree()) run.skipped("embree: the library was not there when this was built");
    if (arguments.peers && findView3d().empty()) run.skipped("view3d: no such program on the PATH");
    const std::string device = run.device().info().name;
    Progress progress("bench", scenes.size(), run.showsProgress());
    for (size_t k = 0; k < scenes.size(); ++k) {
        const StageTimer timer(run, "bench");
        bench.scene(scenes[k]);
        markFront(bench.results);
        // After every scene, so that a long bench that is stopped has something to show.
        geometry::writeWholeText(arguments.output / "bench.csv", csvOf(bench.results));
        geometry::writeWholeText(arguments.output / "gather.csv", csvOf(bench.gathers));
        const Chart plot = plotOf(bench.results, device, arguments.clock);
        plot.write(arguments.output / "bench.svg");
        plot.write(arguments.output / "bench.png");
        const nlohmann::ordered_json all{{"version", HELIODON_VERSION},
                                         {"device", device},
                                         {"compared_by", arguments.clock + " time"},
                                         {"flops_per_second", bench.roofline().flopsPerSecond},
                                         {"bytes_per_second", bench.roofline().bytesPerSecond},
                                         {"reference_rows", arguments.referenceRows},
                                         {"runs", arguments.runs},
                                         {"form_factors", listOf(bench.results)},
                                         {"gather", listOf(bench.gathers)}};
        geometry::writeWholeText(arguments.output / "bench.json", geometry::jsonText(all));
        progress.advance(k + 1);
    }
    run.report()["results"] = (arguments.output / "bench.json").string();
}

} // namespace heliodon::app
