// Question: what error is left for the time that another moment of light, a year and a film take?
// daylight_bench MODEL WEATHER.epw[.gz] [TRIANGLES,TRIANGLES... [RIG.json]]: a model (z up) or a sketch; a
// sketch with a rig is drawn too. One reference for all: twice the most triangles, form factors to 1e-4,
// solution to 1e-6. Errors are RMS over sensors of a work plane, relative, without the beam at the sensor
// itself; CPU seconds (all threads) beside wall seconds.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <functional>
#include <sstream>
#include <thread>

#include "benches/bench_main.h"
#include "compute/annual_daylight.h"
#include "compute/daylight/annual_metrics.h"
#include "compute/daylight/weather.h"
#include "compute/gpu/device.h"
#include "compute/parallel.h"
#include "engine/app/work_plane.h"
#include "engine/passes/frame_renderer.h"
#include "geometry/building.h"
#include "geometry/mesher.h"
#include "geometry/model_file.h"
#include "geometry/rig.h"
#include "geometry/sketch.h"

using namespace heliodon;

namespace {

constexpr size_t kTogether = 8;                // moments that share passes over F
constexpr size_t kChecked[]{70, 95, 127, 160}; // moments of the day

struct Time {
    double wall = 0, cpu = 0;
};

Time timed(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpu = std::clock();
    work();
    return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
            static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC};
}

geometry::Building buildingOf(const std::filesystem::path& input) {
    if (input.extension() != ".json") return geometry::importModel(input, geometry::UpAxis::z);
    geometry::Closure closure = geometry::closeSketch(geometry::readSketch(input));
    if (!closure.building) throw std::runtime_error(closure.report.message);
    return std::move(*closure.building);
}

// A clear day, a moment every `step` degrees of the sun from 17 degrees on.
daylight::Sky skyAt(double step, size_t k) {
    const double angle = 0.3 + step * 0.0174532925 * static_cast<double>(k);
    const glm::dvec3 at(-std::cos(angle), 0.8 * std::sin(angle), 0.6 * std::sin(angle));
    daylight::Sky sky = daylight::cieClearSky(at, 1700);
    daylight::lightGround(sky, 0.2);
    sky.sun = {at, 72000};
    return sky;
}

double indirect(const compute::LightParts& parts) {
    return compute::photometric(parts.total() - parts.sun);
}

class Error {
public:
    void add(double value, double reference) {
        if (!(reference > 0)) return;
        sum_ += (value / reference - 1) * (value / reference - 1);
        ++count_;
    }
    double rms() const { return count_ > 0 ? std::sqrt(sum_ / count_) : 0; }

private:
    double sum_ = 0, count_ = 0;
};

struct Bench {
    gpu::Device device;
    std::filesystem::path input;
    geometry::Building building;
    daylight::Weather weather;
    std::vector<daylight::Sky> year;
    std::vector<compute::Sensor> sensors;
    std::vector<size_t> checked; // hours of the year
    std::vector<std::vector<double>> yearLux,
        dayLux; // of the reference: per checked hour, or moment of kChecked

    std::unique_ptr<compute::DaylightTransport> transport(const geometry::PatchMesh& mesh,
                                                          const compute::TransportOptions& options = {}) {
        auto made = std::make_unique<compute::DaylightTransport>(device, mesh, options);
        made->setSensors(sensors);
        return made;
    }

    void prepare(size_t most) {
        compute::TransportOptions sharp;
        sharp.formFactors.maxError = 1e-4;
        sharp.radiosity.tolerance = 1e-6;
        const geometry::PatchMesh mesh = geometry::meshBuilding(building, {2 * most});
        app::WorkPlane plane;
        if (input.extension() == ".json") plane.worldPerBuilding = 1.0 / 12;
        const app::SensorTable table = app::workPlaneSensors(mesh, geometry::UpAxis::z, plane);
        for (size_t s = 0; s < table.points.size(); ++s)
            sensors.push_back({table.points[s], table.normals[s]});
        const auto reference = transport(mesh, sharp);
        const auto luxOf = [&](const daylight::Sky& sky) {
            std::vector<double> lux;
            for (const compute::LightParts& parts : reference->light(sky).sensors)
                lux.push_back(indirect(parts));
            return lux;
        };
        year.resize(weather.hours.size());
        daylight::WeatherSky options;
        options.setting.northDeg = building.northDeg;
        compute::inParallel(year.size(),
                            [&](size_t h) { year[h] = daylight::skyOfHour(weather.hours[h], options); });
        for (size_t h = 0; h < year.size(); h += 97)
            if (!year[h].isDark()) checked.push_back(h), yearLux.push_back(luxOf(year[h]));
        for (const size_t k : kChecked) dayLux.push_back(luxOf(skyAt(0.25, k)));
        std::printf("reference triangles=%zu sensors=%zu hours_checked=%zu\n", mesh.patchCount(),
                    sensors.size(), checked.size());
    }

    // Moments one after another, eight together; the first ones teach the solver and do not count.
    void relight(const geometry::PatchMesh& mesh, double tolerance) {
        constexpr size_t kRounds = 24, kFirst = 8;
        compute::TransportOptions options;
        options.radiosity.tolerance = tolerance;
        const auto t = transport(mesh, options);
        Time time;
        Error error;
        for (size_t round = 0; round < kRounds; ++round) {
            std::vector<daylight::Sky> skies;
            for (size_t k = 0; k < kTogether; ++k) skies.push_back(skyAt(0.25, round * kTogether + k));
            std::vector<compute::Moment> moments;
            const Time one = timed([&] { moments = t->light(skies); });
            if (round < kFirst) continue;
            time.wall += one.wall, time.cpu += one.cpu;
            for (size_t c = 0; c < std::size(kChecked); ++c)
                if (kChecked[c] / kTogether == round)
                    for (size_t s = 0; s < sensors.size(); ++s)
                        error.add(indirect(moments[kChecked[c] % kTogether].sensors[s]), dayLux[c][s]);
        }
        const double count = kTogether * (kRounds - kFirst);
        std::printf(
            "relight triangles=%zu sensors=%zu tolerance=%.0e cpu_ms=%.2f wall_ms=%.2f rms_error=%.3f%%\n",
            mesh.patchCount(), sensors.size(), tolerance, 1e3 * time.cpu / count, 1e3 * time.wall / count,
            100 * error.rms());
    }

    void annual(const geometry::PatchMesh& mesh) {
        std::unique_ptr<compute::DaylightTransport> t;
        std::vector<float> lux(sensors.size() * year.size()), sun(lux.size()), error(lux.size());
        compute::YearReport report;
        const Time time = timed([&] {
            t = std::make_unique<compute::DaylightTransport>(device, mesh);
            compute::AnnualDaylight annual(*t, year, sensors.size());
            annual.sensors(sensors, lux, sun, error);
            report = annual.report();
        });
        Error off;
        for (size_t k = 0; k < checked.size(); ++k)
            for (size_t s = 0; s < sensors.size(); ++s) {
                const size_t at = s * year.size() + checked[k];
                off.add(double{lux[at]} - double{sun[at]}, yearLux[k][s]);
            }
        std::printf(
            "annual triangles=%zu sensors=%zu cpu_s=%.2f wall_s=%.2f rms_error=%.3f%% check_rms=%.3f%%\n",
            mesh.patchCount(), sensors.size(), time.cpu, time.wall, 100 * off.rms(), 100 * report.checkRms);
    }

    // A sensor on every patch: what the product of coefficients with a year costs, and the metrics.
    void product(const geometry::PatchMesh& mesh) {
        constexpr size_t kAtOnce = 256;
        compute::DaylightTransport t(device, mesh);
        std::vector<compute::Sensor> all;
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            const glm::dvec3 normal = geometry::patchNormal(mesh, i);
            all.push_back({geometry::patchCentroid(mesh, i) + 1e-3 * normal, normal});
        }
        compute::AnnualDaylight annual(t, year, all.size());
        std::vector<uint8_t> occupied;
        for (const daylight::WeatherHour& hour : weather.hours)
            occupied.push_back(daylight::isOccupied(hour));
        Time metrics;
        for (size_t first = 0; first < all.size(); first += kAtOnce) {
            const std::span<const compute::Sensor> block(&all[first], std::min(kAtOnce, all.size() - first));
            std::vector<float> lux(block.size() * year.size()), sun(lux.size()), error(lux.size());
            annual.sensors(block, lux, sun, error);
            const Time one = timed([&] { daylight::annualMetrics(lux, sun, occupied, {}, error); });
            metrics.wall += one.wall, metrics.cpu += one.cpu;
        }
        const compute::YearReport& r = annual.report();
        std::printf("product hours=%zu patches=%zu wall_s=%.2f (skies %.2f, sun on patches %.2f, responses "
                    "%.2f, check %.2f "
                    "are apart) metrics_s=%.2f bytes=%zu\n",
                    year.size(), all.size(), r.productSeconds, r.skySeconds, r.sunSeconds, r.sensorSeconds,
                    r.checkSeconds, metrics.wall, r.bytes);
    }

    // Frames of a day by the minute: solved alone, drawn alone, and both at once as a time-lapse does.
    void timelapse(const geometry::PatchMesh& mesh, const geometry::Rig* rig) {
        constexpr size_t kFrames = 240;
        compute::DaylightTransport t(device, mesh);
        std::vector<compute::Moment> moments;
        Error error;
        const auto solveAll = [&] {
            moments.clear();
            for (size_t k = 0; k < kFrames; k += kTogether) {
                std::vector<daylight::Sky> skies;
                for (size_t j = 0; j < kTogether; ++j) skies.push_back(skyAt(0.25, k + j));
                for (compute::Moment& m : t.light(skies)) moments.push_back(std::move(m));
            }
        };
        const Time solve = timed(solveAll);
        compute::TransportOptions sharp;
        sharp.radiosity.tolerance = 1e-6;
        compute::DaylightTransport fresh(device, mesh, sharp);
        for (size_t k = 7; k < kFrames; k += 40) {
            const compute::Moment exact = fresh.light(skyAt(0.25, k));
            for (size_t i = 0; i < mesh.patchCount(); ++i)
                error.add(compute::photometric(moments[k].lighting.exitance[i]),
                          compute::photometric(exact.lighting.exitance[i]));
        }
        std::printf(
            "timelapse triangles=%zu frames=%zu solve_cpu_ms=%.2f solve_wall_ms=%.2f frames_per_s=%.0f "
            "rms_error_of_solution=%.4f%%\n",
            mesh.patchCount(), kFrames, 1e3 * solve.cpu / kFrames, 1e3 * solve.wall / kFrames,
            kFrames / solve.wall, 100 * error.rms());
        if (!rig) return;
        gpu::Device other; // drawing and solving do not share one
        passes::FrameRenderer renderer(other, mesh, building.occluders, rig);
        passes::ProjectorOptions options;
        options.tone.whiteLux = renderer.autoWhite(moments[kFrames / 2].lighting);
        const std::vector<compute::Moment> solved = moments;
        renderer.projectors(solved[0].lighting, options); // pays for compilation
        const auto drawAll = [&] {
            for (const compute::Moment& m : solved) renderer.projectors(m.lighting, options);
        };
        const Time draw = timed(drawAll), both = timed([&] {
                                              std::thread ahead(solveAll);
                                              drawAll();
                                              ahead.join();
                                          });
        std::printf("timelapse projectors=%zu draw_cpu_ms=%.2f draw_wall_ms=%.2f both_cpu_ms=%.2f "
                    "both_wall_ms=%.2f over_drawing=%.2f\n",
                    rig->projectors.size(), 1e3 * draw.cpu / kFrames, 1e3 * draw.wall / kFrames,
                    1e3 * both.cpu / kFrames, 1e3 * both.wall / kFrames, both.wall / draw.wall);
    }
};

void bench(int count, char** arguments) {
    std::vector<size_t> sizes;
    std::istringstream list(count > 3 ? arguments[3] : "500,1000,2000");
    for (std::string size; std::getline(list, size, ',');) sizes.push_back(std::stoul(size));
    Bench bench;
    bench.input = arguments[1];
    bench.building = buildingOf(bench.input);
    bench.weather = daylight::readWeather(arguments[2]);
    std::optional<geometry::Rig> rig;
    if (count > 4) rig = geometry::readRig(arguments[4]);
    std::printf("device \"%s\"\n", bench.device.info().name.c_str());
    bench.prepare(*std::max_element(sizes.begin(), sizes.end()));
    for (const size_t size : sizes) {
        const geometry::PatchMesh mesh = geometry::meshBuilding(bench.building, {size});
        for (const double tolerance : {1e-2, 1e-3, 1e-4}) bench.relight(mesh, tolerance);
        bench.annual(mesh);
        bench.timelapse(mesh, rig ? &*rig : nullptr);
        if (size == sizes.back()) bench.product(mesh);
    }
}

} // namespace

int main(int argc, char** argv) {
    return benchMain(argc, argv, 2,
                     "daylight_bench MODEL WEATHER.epw[.gz] [TRIANGLES,TRIANGLES... [RIG.json]]", bench);
}
