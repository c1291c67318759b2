#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numeric>
#include <optional>
#include <span>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "compute/annual_daylight.h"
#include "compute/daylight/annual_metrics.h"
#include "compute/daylight/weather.h"
#include "compute/parallel.h"
#include "engine/app/commands.h"
#include "engine/app/finite_light.h"
#include "engine/app/interrupt.h"
#include "engine/app/light_report.h"
#include "engine/app/output_folder.h"
#include "engine/app/plan_chart.h"
#include "engine/app/progress.h"
#include "engine/app/scene_input.h"
#include "engine/app/table_file.h"
#include "engine/app/temporal_chart.h"
#include "engine/app/work_plane.h"
#include "geometry/input_error.h"
#include "geometry/text_file.h"
#include "geometry/whole_file.h"

namespace heliodon::app {

namespace {

using daylight::Range;
using nlohmann::json;

constexpr const char* kHoursFile = "illuminance.npy"; // sensors x records
// Of sensors and records at once five arrays are held, 36 MB each at most, and the records' skies: 82 MB.
constexpr size_t kSensorsAtOnce = 256, kRecordsAtOnce = 4 * 8784, // quarter hours of a year
    kValuesAtOnce = kSensorsAtOnce * kRecordsAtOnce;

struct ClockHours {
    double from = 8, to = 18;
};

// "8", "8.5" or "8:30"; what follows it, null where there is no hour.
const char* readHour(const char* text, const char* end, double& hour) {
    const auto whole = std::from_chars(text, end, hour);
    if (whole.ec != std::errc()) return nullptr;
    if (whole.ptr == end || *whole.ptr != ':') return whole.ptr;
    unsigned minutes = 0;
    const auto part = std::from_chars(whole.ptr + 1, end, minutes);
    if (part.ptr - whole.ptr != 3 || minutes > 59 || hour != std::floor(hour)) return nullptr;
    hour += minutes / 60.0;
    return part.ptr;
}

ClockHours parseOccupied(const std::string& text) {
    ClockHours hours;
    const char* const end = text.data() + text.size();
    const char* const dash = readHour(text.data(), end, hours.from);
    const char* const last =
        dash && dash != end && *dash == '-' ? readHour(dash + 1, end, hours.to) : nullptr;
    if (last != end || !(hours.from >= 0) || !(hours.to <= 24) || !(hours.from < hours.to))
        throw geometry::InputError(
            "--occupied", "",
            fmt::format("'{}' are no hours, expected FROM-TO within 0-24, such as 8-18 or 8:30-17", text));
    return hours;
}

std::vector<daylight::Sky> skiesOf(std::span<const daylight::WeatherHour> hours,
                                   const AnnualArguments& arguments, double northDeg) {
    daylight::WeatherSky options;
    options.setting.northDeg = northDeg;
    options.setting.groundAlbedo = arguments.groundAlbedo;
    std::vector<daylight::Sky> skies(hours.size());
    compute::inParallel(skies.size(), [&](size_t h) { skies[h] = daylight::skyOfHour(hours[h], options); });
    return skies;
}

// What a year is computed from.
struct Job {
    const AnnualArguments& arguments;
    ClockHours occupied;
    daylight::Weather weather;
    std::vector<uint8_t> occupiedRecords; // of the weather
    daylight::AnnualOptions options;
    Scene scene;
    SensorTable sensors;
    std::vector<size_t> mapped; // sensors with a map of their own

    size_t records() const { return weather.hours.size(); }
    void take(daylight::Weather read) {
        weather = std::move(read);
        for (const daylight::WeatherHour& hour : weather.hours)
            occupiedRecords.push_back(daylight::isOccupied(hour, occupied.from, occupied.to));
        options.recordHours = weather.recordHours();
        options.occupiedRecords = static_cast<size_t>(std::ranges::count(occupiedRecords, 1));
    }
};

// Metrics of all sensors, added up from parts of the year.
struct Year {
    std::vector<daylight::SensorMetrics> sensors;
    std::vector<size_t> outside; // of these, in no room: dark, and not counted in any mean
    std::vector<float> meanLux;  // of every record over the sensors in rooms
    double occupiedLux = 0;
    compute::YearReport report;

    size_t inRooms() const { return sensors.size() - outside.size(); }
};

// `block`: of some records, of sensors from `first` on.
void addMetrics(Year& year, size_t first, const daylight::AnnualMetrics& block) {
    const auto count = static_cast<double>(block.sensors.size());
    year.occupiedLux += block.summary.meanLux * count;
    for (size_t s = 0; s < block.sensors.size(); ++s) year.sensors[first + s] += block.sensors[s];
}

// Sensors of `--temporal`.
std::vector<size_t> temporalRows(const std::string& text, size_t count) {
    std::vector<size_t> rows;
    if (text == "all") {
        rows.resize(count);
        std::iota(rows.begin(), rows.end(), size_t{0});
        return rows;
    }
    for (size_t from = 0; from < text.size();) {
        const size_t comma = std::min(text.find(',', from), text.size());
        size_t row = 0;
        const auto end = std::from_chars(text.data() + from, text.data() + comma, row);
        if (end.ec != std::errc() || end.ptr != text.data() + comma || row >= count)
            throw geometry::InputError(
                "--temporal", "",
                fmt::format("'{}' is no row of the {} sensors, expected all or rows such as "
                            "0,5,17",
                            text.substr(from, comma - from), count));
        rows.push_back(row);
        from = comma + 1;
    }
    return rows;
}

// Lines `month day hour lux lux ...`, the hour at the record's middle. `lux`: sensors x records; text goes
// the other way round, so some records of all sensors are held at a time.
void writeIll(const std::filesystem::path& file, const daylight::Weather& weather, size_t sensors,
              MatrixFile& lux) {
    const size_t records = weather.hours.size(),
                 atOnce = std::clamp<size_t>(kValuesAtOnce / sensors, 1, records);
    geometry::writeWhole(file, [&](const std::filesystem::path& aside) {
        std::ofstream out(aside, std::ios::binary);
        fmt::memory_buffer line;
        for (size_t first = 0; first < records; first += atOnce) {
            const size_t count = std::min(atOnce, records - first);
            const std::vector<float> block = lux.read(0, sensors, first, count);
            for (size_t k = 0; k < count; ++k) {
                const daylight::WeatherHour& hour = weather.hours[first + k];
                line.clear();
                fmt::format_to(fmt::appender(line), "{} {} {:.3f}", hour.date.month, hour.date.day,
                               hour.clockHour);
                for (size_t s = 0; s < sensors; ++s)
                    fmt::format_to(fmt::appender(line), " {:.0f}", block[s * count + k]);
                line.push_back('\n');
                out.write(line.data(), std::streamsize(line.size()));
            }
        }
        if (!out.flush()) throw std::runtime_error(file.string() + ": could not be written (disk full?)");
    });
}

std::string temporalName(size_t row) {
    return fmt::format("temporal-{:04}", row);
}

void drawYear(Run& run, const Job& job, const Year& year) {
    const StageTimer timer(run, "draw");
    const AnnualArguments& arguments = job.arguments;
    const daylight::Weather& weather = job.weather;
    const SensorTable& sensors = job.sensors;
    const std::string extension = arguments.svg ? ".svg" : ".png";
    const ValueScale lux = luxScale({year.meanLux.begin(), year.meanLux.end()});
    temporalChart(weather, year.meanLux, lux, fmt::format("Illuminance, mean of {} sensors", year.inRooms()))
        .write(arguments.output / ("temporal-mean" + extension));
    MatrixFile hours(arguments.output / kHoursFile, sensors.points.size(), job.records());
    for (const size_t row : job.mapped)
        temporalChart(weather, hours.read(row, 1, 0, job.records()), lux,
                      fmt::format("Illuminance at sensor {}", row))
            .write(arguments.output / (temporalName(row) + extension));
    const std::string when = fmt::format("{} o'clock, weather of {}{}", arguments.occupied, weather.place,
                                         arguments.sensors.empty() ? "; " + WorkPlane().inWords() : "");
    const auto plan = [&](const char* name, const std::string& title,
                          Range daylight::SensorMetrics::*metric) {
        std::vector<double> values;
        for (const daylight::SensorMetrics& m : year.sensors) values.push_back((m.*metric).value);
        const Plan drawn =
            planChart(job.scene, {sensors.points, sensors.normals, values}, percentScale(), title, when);
        drawn.chart.write(arguments.output / (name + extension));
        return drawn.shown;
    };
    if (plan("plan-da", "Daylight autonomy, 300 lux", &daylight::SensorMetrics::da) == 0)
        run.warn(kEmptyPlan);
    plan("plan-udi", "Useful daylight, 100 to 3000 lux", &daylight::SensorMetrics::udiUseful);
}

std::vector<std::string> filesOf(const AnnualArguments& arguments, const std::vector<size_t>& mapped) {
    const std::string extension = arguments.svg ? ".svg" : ".png";
    std::vector<std::string> files{kHoursFile, "metrics.csv", "summary.json"};
    if (arguments.ill) files.emplace_back("illuminance.ill");
    for (const char* drawing : {"temporal-mean", "plan-da", "plan-udi"}) files.push_back(drawing + extension);
    for (const size_t row : mapped) files.push_back(temporalName(row) + extension);
    return files;
}

json rangeJson(const Range& range) {
    return {{"value", range.value}, {"low", range.low}, {"high", range.high}};
}

// `name,name_low,name_high` for each metric.
std::string metricsTable(const SensorTable& sensors, const std::vector<daylight::SensorMetrics>& metrics) {
    using daylight::SensorMetrics;
    constexpr std::pair<const char*, Range SensorMetrics::*> kColumns[]{
        {"DA300_pct", &SensorMetrics::da},
        {"cDA300_pct", &SensorMetrics::cda},
        {"UDI_lt100_pct", &SensorMetrics::udiBelow},
        {"UDI_100_300_pct", &SensorMetrics::udiSupplementary},
        {"UDI_300_3000_pct", &SensorMetrics::udiAutonomous},
        {"UDI_100_3000_pct", &SensorMetrics::udiUseful},
        {"UDI_gt3000_pct", &SensorMetrics::udiAbove},
        {"direct_gt1000lx_hours", &SensorMetrics::sunHours}};
    std::string text = sensors.header;
    for (const auto& [name, member] : kColumns) text += fmt::format(",{}", name);
    text += ",annual_lux_hours";
    for (const auto& [name, member] : kColumns) text += fmt::format(",{0}_low,{0}_high", name);
    text += '\n';
    for (size_t s = 0; s < metrics.size(); ++s) {
        text += sensors.rows[s];
        for (const auto& [name, member] : kColumns)
            text += fmt::format(",{:.4f}", (metrics[s].*member).value);
        text += fmt::format(",{:.0f}", metrics[s].luxHours);
        for (const auto& [name, member] : kColumns)
            text += fmt::format(",{:.4f},{:.4f}", (metrics[s].*member).low, (metrics[s].*member).high);
        text += '\n';
    }
    return text;
}

// What records are called.
const char* recordsOf(const daylight::Weather& weather) {
    return weather.recordHours() == 1 ? "hours" : "records";
}

// `records`: what they are called.
void reportYear(Run& run, const compute::YearReport& year, const char* records) {
    const auto model = [&](size_t count, const char* what) {
        if (count > 0) run.modelled(fmt::format("{}: {} {}", what, count, records));
    };
    const auto skip = [&](size_t count, const char* what) {
        if (count > 0) run.skipped(fmt::format("{} {}: {}", count, records, what));
    };
    model(year.lit, "sky and ground");
    model(year.withSun, "sun at its exact place, clipped by the openings");
    model(year.solved, "skies with a ribbon of light at the horizon, each solved in full");
    skip(year.hours - year.lit, "sky and sun: no light outside, or no opening");
    skip(year.sunless, "sun: behind cloud or below the horizon");
    skip(year.sunOutside, "sun: shines on no opening from outside");
    run.report()["year"] = {{"hours", year.hours},
                            {"lit", year.lit},
                            {"with_sun", year.withSun},
                            {"sun_outside", year.sunOutside},
                            {"without_sun", year.sunless},
                            {"solved_in_full", year.solved},
                            {"sky_seconds", year.skySeconds},
                            {"sun_seconds", year.sunSeconds},
                            {"sensor_seconds", year.sensorSeconds},
                            {"product_seconds", year.productSeconds},
                            {"check_seconds", year.checkSeconds},
                            {"solved_seconds", year.solvedSeconds},
                            {"bytes", year.bytes},
                            {"sun_bytes", year.sunBytes},
                            {"sun_blocks", year.sunBlocks},
                            {"checked_hours", year.checkedHours},
                            {"check_rms", year.checkRms}};
}

json summaryJson(const daylight::AnnualMetrics& metrics, const daylight::Weather& weather,
                 const ClockHours& occupied) {
    const daylight::AnnualSummary& s = metrics.summary;
    return {{"place", weather.place},
            {"latitude", weather.site.latitudeDeg},
            {"longitude", weather.site.longitudeDeg},
            {"records", weather.hours.size()},
            {"sensors", s.sensors},
            {"occupied", {{"from", occupied.from}, {"to", occupied.to}, {"hours", s.occupiedHours}}},
            {"sDA300/50", s.sda.value},
            {"ASE1000,250", s.ase.value},
            {"sDA300/50_interval", rangeJson(s.sda)},
            {"ASE1000,250_interval", rangeJson(s.ase)},
            {"mean_DA", s.meanDa},
            {"mean_cDA", s.meanCda},
            {"mean_UDI_100_3000", s.meanUdiUseful},
            {"mean_UDI_above_3000", s.meanUdiAbove},
            {"mean_lux", s.meanLux},
            {"unit", "percent of sensors (sDA, ASE), percent of occupied hours (DA, cDA, UDI), lux"}};
}

SensorTable sensorsFor(Run& run, const AnnualArguments& arguments, const Scene& scene) {
    WorkPlane plane;
    plane.worldPerBuilding = scene.worldPerBuilding;
    SensorTable table = workPlaneSensors(scene.mesh, scene.up, plane);
    if (table.points.empty())
        throw geometry::InputError(arguments.scene.input.string(), "",
                                   "has no floor to put sensors over, expected --sensors S.csv");
    run.note(fmt::format("{} sensors on a {}", table.points.size(), plane.inWords()));
    return table;
}

daylight::Weather weatherFor(Run& run, const AnnualArguments& arguments) {
    const StageTimer timer(run, "weather");
    daylight::Weather weather = daylight::readWeather(arguments.weather);
    for (const std::string& warning : weather.warnings) run.warn(warning);
    const double days = static_cast<double>(weather.hours.size()) * weather.recordHours() / 24;
    if (days < 365 || days > 366)
        run.warn(fmt::format("{}: covers {:g} days: hours of direct sun, ASE and lux hours are of these, "
                             "not of a year",
                             arguments.weather.string(), days));
    return weather;
}

// Computes the year's records from `firstRecord` on, kRecordsAtOnce of them, and writes them.
void computePart(Run& run, const Job& job, compute::DaylightTransport& transport, size_t firstRecord,
                 Progress& progress, Year& year, NpyWriter& out) {
    const size_t count = job.sensors.points.size(),
                 records = std::min(kRecordsAtOnce, job.records() - firstRecord);
    std::optional<compute::AnnualDaylight> annual;
    {
        const StageTimer timer(run, "sky");
        const std::span hours(&job.weather.hours[firstRecord], records);
        annual.emplace(
            transport, skiesOf(hours, job.arguments, job.scene.northDeg), count, [&](double share) {
                const double done = static_cast<double>(firstRecord) + share * static_cast<double>(records);
                progress.advance(static_cast<size_t>(std::lround(done)),
                                 done / static_cast<double>(job.records()));
            });
    }
    std::vector<float> lux, sun, error;
    for (size_t first = 0; first < count; first += kSensorsAtOnce) {
        throwIfInterrupted();
        std::vector<compute::Sensor> points;
        for (size_t s = first; s < std::min(first + kSensorsAtOnce, count); ++s)
            points.push_back({job.sensors.points[s], job.sensors.normals[s]});
        for (auto* values : {&lux, &sun, &error}) values->resize(points.size() * records);
        {
            const StageTimer timer(run, "solve");
            annual->sensors(points, lux, sun, error);
        }
        for (const auto* values : {&lux, &sun, &error}) expectFinite(*values, first, records);
        if (firstRecord == 0)
            for (const size_t s : transport.report().sensorsOutside) year.outside.push_back(first + s);
        const StageTimer timer(run, "metrics");
        addMetrics(year, first,
                   daylight::annualMetrics(lux, sun, std::span(&job.occupiedRecords[firstRecord], records),
                                           job.options, error, annual->beamEdges()));
        for (size_t at = 0; at < lux.size(); ++at) year.meanLux[firstRecord + at % records] += lux[at];
        out.put(first, points.size(), firstRecord, records, lux);
    }
    year.report += annual->report();
}

// Computes the year, and writes it part by part.
Year computeYear(Run& run, const Job& job, OutputFolder& folder) {
    const size_t records = job.records(), count = job.sensors.points.size();
    const std::filesystem::path& output = job.arguments.output;
    const auto transport =
        makeTransport(run, job.scene.mesh,
                      compute::TransportOptions{.errorByPlace = true, .sunDisc = job.arguments.sunDisc});
    Progress progress(fmt::format("{} of the year", recordsOf(job.weather)), records, run.showsProgress());
    Year year;
    year.meanLux.assign(records, 0);
    year.sensors.resize(count);
    NpyWriter::writeWhole(output / kHoursFile, count, records, [&](NpyWriter& out) {
        for (size_t first = 0; first < records; first += kRecordsAtOnce)
            computePart(run, job, *transport, first, progress, year, out);
        folder.startFiles(run, "annual", filesOf(job.arguments, job.mapped));
    });
    for (float& lux : year.meanLux) lux /= static_cast<float>(std::max<size_t>(year.inRooms(), 1));
    warnOfSensorsOutside(run, year.outside, count);
    reportYear(run, year.report, recordsOf(job.weather));
    const compute::OutsideReflection& outside = transport->parts().reflection;
    outside.isEmpty() ? run.skipped(outside.inWords()) : run.modelled(outside.inWords());
    if (job.arguments.ill) {
        MatrixFile hours(output / kHoursFile, count, records);
        writeIll(output / "illuminance.ill", job.weather, count, hours);
    }
    return year;
}

// Shares of no hours would all be 0.
void refuseUnoccupied(const Job& job) {
    if (job.options.occupiedRecords > 0) return;
    throw geometry::InputError(
        "--occupied", "",
        fmt::format(
            "no record of {} has its middle in {} o'clock, expected longer hours (records are of {:g} h)",
            job.arguments.weather.filename().string(), job.arguments.occupied, job.weather.recordHours()));
}

// Of the sensors in rooms: one in a wall or beyond it is no dark place of a room.
daylight::AnnualMetrics metricsInRooms(const Job& job, const Year& year) {
    std::vector<daylight::SensorMetrics> inRooms;
    for (size_t s = 0, next = 0; s < year.sensors.size(); ++s)
        if (next < year.outside.size() && year.outside[next] == s)
            ++next;
        else
            inRooms.push_back(year.sensors[s]);
    daylight::AnnualMetrics metrics =
        daylight::summarized(std::move(inRooms), job.occupiedRecords, job.options);
    metrics.summary.meanLux = year.occupiedLux / static_cast<double>(std::max<size_t>(year.inRooms(), 1));
    return metrics;
}

void writeMetrics(Run& run, const Job& job, const Year& year) {
    const std::filesystem::path& output = job.arguments.output;
    const daylight::AnnualMetrics all = metricsInRooms(job, year);
    geometry::writeWholeText(output / "metrics.csv", metricsTable(job.sensors, year.sensors));
    json summary = summaryJson(all, job.weather, job.occupied);
    summary["sensors_outside"] = year.outside.size();
    geometry::writeWholeText(output / "summary.json", geometry::jsonText(summary));
    run.report()["summary"] = summary;
    run.note(fmt::format("sDA300/50 {:.1f} %, ASE1000,250 {:.1f} %, mean DA {:.1f} %", all.summary.sda.value,
                         all.summary.ase.value, all.summary.meanDa));
}

} // namespace

void execute(Run& run, const AnnualArguments& arguments) {
    // Small files first: a typing error there should not cost the form factors.
    Job job{arguments, parseOccupied(arguments.occupied), {}, {}, {}, {}, {}, {}};
    std::optional<SensorTable> given;
    if (!arguments.sensors.empty()) given = readSensors(arguments.sensors, upAxisOf(arguments.scene));
    job.take(weatherFor(run, arguments));
    refuseUnoccupied(job);
    OutputFolder folder(arguments.output);
    job.scene = loadScene(run, arguments.scene);
    if (!job.scene.assumedNorth.empty()) run.assume(job.scene.assumedNorth);
    job.sensors = given ? std::move(*given) : sensorsFor(run, arguments, job.scene);
    if (!arguments.sensors.empty())
        refuseAllOutside(arguments.sensors, job.sensors, job.scene, arguments.scene);
    job.mapped = temporalRows(arguments.temporal, job.sensors.points.size());
    folder.refuseUsed(run, "annual", filesOf(arguments, job.mapped));
    const Year year = computeYear(run, job, folder);
    drawYear(run, job, year);
    writeMetrics(run, job, year);
}

} // namespace heliodon::app
