#include <algorithm>
#include <cmath>
#include <functional>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "compute/form_factors.h"
#include "compute/parallel.h"
#include "compute/reference/form_factor_rows.h"
#include "compute/roofline.h"
#include "engine/app/bench_clock.h"
#include "engine/app/bench_gather.h"
#include "engine/app/bench_machine.h"
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

// What each kernel is asked for. One that is not named here is asked for `errors`.
std::vector<Setting> settingsOf(const std::string& kernel, const std::vector<double>& errors) {
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
        for (const uint32_t R : {32u, 64u, 128u}) add(std::to_string(R * R), R, 1, 0, R * R);
    } else {
        for (const double error : errors) add(errorText(error), 64, 1, error, 0);
    }
    return settings;
}

// Rows of the double-precision oracle, spread evenly over the patches.
struct Reference {
    std::vector<size_t> rows;
    std::vector<compute::reference::FormFactorRows::Row> values;
};

Reference referenceOf(const geometry::PatchMesh& mesh, size_t count) {
    Reference result;
    const size_t n = mesh.patchCount();
    for (size_t k = 0; k < std::min(count, n); ++k)
        result.rows.push_back((2 * k + 1) * n / (2 * std::min(count, n)));
    result.values.resize(result.rows.size());
    const compute::reference::FormFactorRows oracle(mesh);
    compute::inParallel(result.rows.size(), [&](size_t k) {
        throwIfInterrupted();
        result.values[k] = oracle.row(result.rows[k]);
    });
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
        const compute::reference::FormFactorRows::PairMix& mix = reference.values[k].mix;
        const double share = 1 / std::max(1.0, static_cast<double>((n - 1) * reference.rows.size()));
        result.pairsApart += share * static_cast<double>(mix.apart);
        result.pairsHidden += share * static_cast<double>(mix.hidden);
        result.pairsVisible += share * static_cast<double>(mix.visible);
        result.pairsPartial += share * static_cast<double>(mix.partial);
        result.rowErrorMax = std::max(result.rowErrorMax, std::sqrt(row));
    }
    result.rowError = std::sqrt(squares / static_cast<double>(reference.rows.size()));
    result.referenceError = std::sqrt(uncertain / static_cast<double>(reference.rows.size()));
}

// Neither method nor device can do with less than writing the matrix once and one product rule of a single
// point, about 60 operations, for each pair.
double leastSeconds(const compute::Roofline& roofline, double n) {
    return roofline.seconds(60 * n * n / 2, 4 * n * n);
}

constexpr double kMuchWork = 0.1; // of all cores

// How often a setting is run where --runs does not say.
constexpr int kRuns = 3;
constexpr double kLongRun = 2; // seconds; noise is small beside such a run, one counts

BenchResult::Seconds spread(std::vector<double> seconds) {
    std::ranges::sort(seconds);
    const size_t count = seconds.size();
    return {0.5 * (seconds[(count - 1) / 2] + seconds[count / 2]), seconds.front(), seconds.back()};
}

class Bench {
public:
    Bench(Run& run, const BenchArguments& arguments, const std::vector<BenchScene>& scenes)
        : run_(run), arguments_(arguments), scenes_(scenes),
          roofline_(compute::measureRoofline(run.device())) {}

    // All settings on all scenes; `sceneDone` after each. What throws leaves the results so far.
    void all(const std::function<void()>& sceneDone) {
        size_t total = 0, done = 0;
        double work = 0, finished = 0; // a setting's grows about as its patches do
        for (const BenchScene& scene : scenes_) {
            scene_ = &scene;
            total += steps().size();
            work += static_cast<double>(steps().size() * scene.mesh.patchCount());
        }
        Progress progress("bench", total, run_.showsProgress());
        for (const BenchScene& scene : scenes_) {
            scene_ = &scene;
            const auto patches = static_cast<double>(scene.mesh.patchCount());
            const std::vector<Step> planned = steps();
            for (size_t k = 0; k < planned.size();) {
                const StageTimer timer(run_, "bench");
                guarded(planned[k++]);
                if (reference_.rows.empty()) k = planned.size(); // nothing to hold the other steps against
                progress.advance(done + k, (finished + static_cast<double>(k) * patches) / work);
            }
            done += planned.size();
            finished += static_cast<double>(planned.size()) * patches;
            if (!results.empty()) sceneDone();
        }
    }

    const OtherWork otherWork;
    std::vector<BenchResult> results;
    std::vector<GatherResult> gathers;
    const compute::Roofline& roofline() const { return roofline_; }

private:
    struct Step {
        std::string kernel, setting;
        std::function<void()> work;
    };

    // Of the scene at hand.
    std::vector<Step> steps() {
        std::vector<Step> steps;
        steps.push_back({"reference", "rows", [this] { makeReference(); }});
        for (const std::string& kernel : arguments_.kernels)
            for (const Setting& setting : settingsOf(kernel, arguments_.errors))
                steps.push_back({kernel, setting.name, [this, setting] { ours(setting); }});
        if (arguments_.peers) addPeers(steps);
        steps.push_back({"gather", "", [this] { gather(); }});
        return steps;
    }

    // One setting that fails (memory, say) is a row less, not the end.
    void guarded(const Step& step) {
        throwIfInterrupted();
        try {
            step.work();
        } catch (const geometry::InputError&) {
            throw;
        } catch (const Interrupted&) {
            throw;
        } catch (const std::exception& error) {
            throwIfInterrupted(); // a peer's own program had the signal too
            warn(step.kernel, step.setting, error.what());
        }
    }

    void warn(const std::string& kernel, const std::string& setting, const std::string& what) {
        run_.warn(fmt::format("{}, {} patches: {} {}: {}", scene_->name, scene_->mesh.patchCount(), kernel,
                              setting, what));
    }

    // None where all rows are zero: every kernel would agree on that.
    void makeReference() {
        reference_ = {};
        Reference reference = referenceOf(scene_->mesh, arguments_.referenceRows);
        if (std::ranges::all_of(reference.values, [](const auto& row) {
                return std::ranges::all_of(row.factors, [](double f) { return f == 0; });
            }))
            throw std::runtime_error("all are zero, as no patch of them faces another: nothing to compare");
        reference_ = std::move(reference);
    }

    struct Times {
        double wall = 0, cpu = 0, device = 0; // seconds
    };

    // Medians of `once`, repeated. The first run pays for compilation and is not counted, except a long one
    // of another program, which is compiled already.
    void repeat(BenchResult& result, const std::function<Times()>& once) {
        std::vector<double> wall, cpu, device;
        result.runs = arguments_.runs.value_or(kRuns);
        for (int k = 0; k <= result.runs; ++k) {
            throwIfInterrupted();
            if (k <= 1) resetPeakMemory();
            const Times times = once();
            const bool isLong = k == 0 && !arguments_.runs && times.wall > kLongRun;
            if (isLong) result.runs = 1;
            if (k == 0 && !(isLong && result.peer)) continue;
            wall.push_back(times.wall), cpu.push_back(times.cpu), device.push_back(times.device);
            if (isLong) break;
        }
        result.peakBytes = peakMemory();
        result.wall = spread(wall);
        result.cpu = spread(cpu);
        result.deviceSeconds = spread(device).median;
    }

    void ours(const Setting& setting) {
        const auto n = static_cast<double>(scene_->mesh.patchCount());
        BenchResult result = begin(setting.kernel, setting.name);
        gpu::Device& device = run_.device();
        compute::FormFactors F;
        repeat(result, [&] {
            F = {};
            device.startTiming();
            const BenchClock clock;
            F = compute::computeFormFactors(device, scene_->mesh, setting.options);
            double wallSeconds = 0, cpuSeconds = 0, measureWall = 0, measureCpu = 0;
            clock.stop(wallSeconds, cpuSeconds);
            const double onClock = device.timedSeconds();
            const BenchClock measuring; // closure and reciprocity are not the kernel's work
            compute::measureFormFactors(device, scene_->mesh, F.values, F.report);
            measuring.stop(measureWall, measureCpu);
            return Times{F.report.seconds, std::max(0.0, cpuSeconds - measureCpu), onClock};
        });
        for (const std::string& warning : F.report.warnings) warn(setting.kernel, setting.name, warning);
        result.claimedRowError = F.report.claimedRowError;
        result.closureMax = F.report.closureMax;
        result.closureRms = F.report.closureRms;
        result.reciprocityRms = F.report.reciprocityRms.value();
        result.raysPerSecond = n * setting.raysPerPatch / result.wall.median;
        result.rooflineFraction = leastSeconds(roofline_, n) / result.wall.median;
        finish(std::move(result),
               F.values.download<float>(scene_->mesh.patchCount() * scene_->mesh.patchCount()));
    }

    void peer(BenchResult result, const std::function<PeerResult()>& work) {
        PeerResult peer;
        result.peer = true;
        repeat(result, [&] {
            peer = {};
            peer = work();
            return Times{peer.wallSeconds, peer.cpuSeconds, 0};
        });
        result.raysPerSecond = peer.rays / result.wall.median;
        gpu::Buffer values(run_.device(), peer.factors.size() * sizeof(float), "peer", gpu::Place::host);
        values.upload(peer.factors);
        compute::FormFactorReport report;
        compute::measureFormFactors(run_.device(), scene_->mesh, values, report);
        result.closureMax = report.closureMax;
        result.closureRms = report.closureRms;
        result.reciprocityRms = report.reciprocityRms.value();
        finish(std::move(result), peer.factors);
    }

    void addPeers(std::vector<Step>& steps) {
        const auto add = [&](const std::string& kernel, const std::string& setting,
                             const std::function<PeerResult()>& work) {
            steps.push_back({kernel, setting, [=, this] { peer(begin(kernel, setting), work); }});
        };
        if (hasEmbree()) {
            for (const uint32_t R : {32u, 64u, 128u})
                add("embree hemicube", fmt::format("{0}x{0}", R),
                    [this, R] { return embreeHemicube(scene_->mesh, R); });
            for (const uint32_t rays : {1024u, 4096u, 16384u})
                add("embree rays", std::to_string(rays),
                    [this, rays] { return embreeRays(scene_->mesh, rays); });
        }
        if (const std::string program = findView3d();
            !program.empty() && scene_->mesh.patchCount() <= kMostForView3d)
            for (const double epsilon : {1e-3, 1e-4, 1e-6})
                add("view3d", errorText(epsilon),
                    [this, program, epsilon] { return view3d(program, scene_->mesh, epsilon); });
    }

    void gather() {
        for (GatherResult& result : benchGather(run_.device(), scene_->mesh, roofline_)) {
            result.scene = scene_->name;
            run_.note(fmt::format(
                "{:<12} {:>6} patches  gather, {} column{}  {:.3f} ms, {:.2f} times native, error {:.1e}",
                result.scene, result.patches, result.columns, result.columns > 1 ? "s" : " ",
                1e3 * result.wallSeconds, result.wallSeconds / result.nativeSeconds, result.error));
            gathers.push_back(std::move(result));
        }
    }

    BenchResult begin(const std::string& kernel, const std::string& setting) {
        BenchResult result;
        result.scene = scene_->name;
        result.patches = scene_->mesh.patchCount();
        result.kernel = kernel;
        result.setting = setting;
        return result;
    }

    void finish(BenchResult result, const std::vector<float>& F) {
        const auto n = static_cast<double>(result.patches);
        result.pairsPerSecond = n * n / result.wall.median;
        result.bytesPerSecond = 4 * n * n / result.wall.median;
        judge(F, reference_, result);
        result.compared = arguments_.clock == "CPU" ? result.cpu : result.wall;
        run_.note(fmt::format(
            "{:<12} {:>6} patches  {:<16} {:<16} {:9.4f} s  {:9.4f} CPU s  row error {:.2e}  closure "
            "{:.1e}",
            result.scene, result.patches, result.kernel, result.setting, result.wall.median,
            result.cpu.median, result.rowError, result.closureMax));
        results.push_back(std::move(result));
    }

    static constexpr size_t kMostForView3d = 4000; // minutes beyond

    Run& run_;
    const BenchArguments& arguments_;
    const std::vector<BenchScene>& scenes_;
    compute::Roofline roofline_;
    const BenchScene* scene_ = nullptr;
    Reference reference_;
};

template<class Result> nlohmann::ordered_json listOf(const std::vector<Result>& results) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Result& result : results) list.push_back(jsonOf(result));
    return list;
}

void writeResults(Run& run, const BenchArguments& arguments, Bench& bench, bool complete) {
    const std::string device = run.device().info().name;
    markFront(bench.results);
    geometry::writeWholeText(arguments.output / "bench.csv", csvOf(bench.results));
    geometry::writeWholeText(arguments.output / "gather.csv", csvOf(bench.gathers));
    const nlohmann::ordered_json all{{"version", HELIODON_VERSION},
                                     {"complete", complete},
                                     {"device", device},
                                     {"driver", run.device().info().driver},
                                     {"processor", processorName()},
                                     {"cores", std::thread::hardware_concurrency()},
                                     {"cores_of_other_work", bench.otherWork.cores()},
                                     {"compared_by", arguments.clock + " time"},
                                     {"flops_per_second", bench.roofline().flopsPerSecond},
                                     {"bytes_per_second", bench.roofline().bytesPerSecond},
                                     {"reference_rows", arguments.referenceRows},
                                     {"form_factors", listOf(bench.results)},
                                     {"gather", listOf(bench.gathers)}};
    geometry::writeWholeText(arguments.output / "bench.json", geometry::jsonText(all));
    // Figures first: a plot that fails must not cost them.
    const Chart plot = plotOf(bench.results, device, arguments.clock);
    plot.write(arguments.output / "bench.svg");
    plot.write(arguments.output / "bench.png");
}

std::vector<std::string> filesOf(const BenchArguments& arguments) {
    std::vector<std::string> files{"bench.csv", "bench.json", "bench.svg", "bench.png", "gather.csv"};
    std::ranges::move(sceneFiles(arguments.scenes, arguments.sizes), std::back_inserter(files));
    return files;
}

template<class Value> std::vector<Value> eachOnce(const std::vector<Value>& given) {
    std::vector<Value> values;
    for (const Value& value : given)
        if (std::ranges::find(values, value) == values.end()) values.push_back(value);
    return values;
}

// Each once; "all" stands for `known`, beside others too.
template<class Names>
std::vector<std::string> expanded(const std::vector<std::string>& given, const Names& known) {
    std::vector<std::string> names;
    for (const std::string& name : given) {
        if (name != "all")
            names.push_back(name);
        else
            names.insert(names.end(), known.begin(), known.end());
    }
    return eachOnce(names);
}

BenchArguments completed(BenchArguments arguments) {
    const auto known = compute::formFactorKernels();
    arguments.kernels = expanded(arguments.kernels, known);
    for (const std::string& kernel : arguments.kernels)
        if (kernel != "auto" && std::find(known.begin(), known.end(), kernel) == known.end())
            throw geometry::InputError(
                "--kernels", kernel, fmt::format("unknown; expected all, auto, {}", fmt::join(known, ", ")));
    std::vector<std::string_view> scenes;
    for (const BuiltInScene& scene : builtInScenes()) scenes.emplace_back(scene.name);
    arguments.scenes = expanded(arguments.scenes, scenes);
    arguments.sizes = arguments.sizes.empty() ? std::vector<size_t>{500, 2000} : eachOnce(arguments.sizes);
    arguments.errors = eachOnce(arguments.errors);
    return arguments;
}

} // namespace

void execute(Run& run, const BenchArguments& given) {
    const BenchArguments arguments = completed(given);
    checkBenchScenes(arguments.scenes);
    run.device(); // where there is none, nothing is written
    OutputFolder folder(arguments.output);
    const std::vector<std::string> files = filesOf(arguments);
    folder.refuseUsed(run, "bench", files);
    folder.startFiles(run, "bench", files);
    const std::vector<BenchScene> scenes = [&] {
        const StageTimer timer(run, "scenes");
        return benchScenes(arguments.scenes, arguments.sizes, arguments.output);
    }();
    if (!given.sizes.empty() && sceneFiles(arguments.scenes, {}).empty())
        run.warn("--sizes is not used: models' faces are taken as they are");
    Bench bench(run, arguments, scenes);
    if (arguments.peers && !hasEmbree()) run.skipped("embree: the library was not there when this was built");
    if (arguments.peers && findView3d().empty()) run.skipped("view3d: no such program on the PATH");
    try {
        // After every scene: a system that runs out of memory asks nobody.
        bench.all([&] { writeResults(run, arguments, bench, false); });
    } catch (...) {
        if (!bench.results.empty()) {
            writeResults(run, arguments, bench, false);
            run.note(fmt::format("{} finished settings are in {}", bench.results.size(),
                                 arguments.output.string()));
        }
        throw;
    }
    if (bench.results.empty()) throw std::runtime_error("no setting has a result: the warnings say why");
    writeResults(run, arguments, bench, true);
    if (const double others = bench.otherWork.cores(),
        all = std::max(1u, std::thread::hardware_concurrency());
        arguments.clock != "CPU" && others > kMuchWork * all)
        run.warn(fmt::format(
            "other work had {:.1f} of {} cores: times on the wall are longer than they need be, and "
            "not all by as much; --clock CPU compares processor time",
            others, all));
    run.report()["results"] = (arguments.output / "bench.json").string();
}

} // namespace heliodon::app
