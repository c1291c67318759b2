// G. Ward: gendaymtx, epw2wea (Radiance), whose manual pages describe the format.
#include "compute/daylight/wea.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "geometry/input_error.h"
#include "geometry/number_text.h"
#include "geometry/text_file.h"

namespace heliodon::daylight {

namespace {

using Words = std::vector<std::string_view>;

constexpr std::string_view kBlanks = " \t\r\x1a";
constexpr std::array<const char*, 6> kHead{"place",     "latitude",       "longitude",
                                           "time_zone", "site_elevation", "weather_data_file_units"};
constexpr double kOnTime = 6e-3; // hours: they are rounded, to two decimals at least

Words wordsOf(std::string_view line) {
    Words words;
    for (size_t at = line.find_first_not_of(kBlanks); at != line.npos;) {
        const size_t end = std::min(line.find_first_of(kBlanks, at), line.size());
        words.push_back(line.substr(at, end - at));
        at = line.find_first_not_of(kBlanks, end);
    }
    return words;
}

struct WeaLine {
    const std::string& file;
    size_t number;
    std::string_view text;
    Words words;

    [[noreturn]] void refuse(const std::string& what) const {
        throw geometry::InputError(file, std::to_string(number), what);
    }
    double within(size_t word, const char* name, double low, double high) const {
        const auto value = geometry::signedNumberFrom(words[word]);
        if (!value || *value < low || *value > high)
            refuse(
                fmt::format("{} is '{}', expected {:g} to {:g}", name, words[word].substr(0, 30), low, high));
        return *value;
    }
    int whole(size_t word, const char* name, int low, int high) const {
        const double value = within(word, name, low, high);
        if (value != std::floor(value)) refuse(fmt::format("{} is {}, expected a whole number", name, value));
        return static_cast<int>(value);
    }
    std::optional<double> irradiance(size_t word, const char* name) const {
        return irradianceFrom(within(word, name, -1e6, 1e6),
                              [&](const std::string& what) { refuse(fmt::format("{} {}", name, what)); });
    }
};

// Line `k` of the head.
void readHead(const WeaLine& line, size_t k, EpwFile& wea) {
    if (line.words[0] != kHead[k] || line.words.size() < 2)
        line.refuse(fmt::format("expected '{}' and its value, line {} of a .wea", kHead[k], k + 1));
    if (k > 0 && line.words.size() > 2)
        line.refuse(fmt::format("has '{}' after its value, expected one number; west is positive",
                                line.words[2].substr(0, 30)));
    switch (k) {
    case 0:
        wea.place = geometry::asUtf8(std::string(line.words[1].data(), line.words.back().end()));
        break;
    case 1:
        wea.latitudeDeg = line.within(1, "latitude", -90, 90);
        break;
    case 2:
        wea.longitudeDeg = -line.within(1, "longitude, west positive,", -180, 180);
        break;
    case 3:
        wea.timeZoneHours = -line.within(1, "time_zone, degrees west,", -225, 210) / 15;
        break;
    case 4:
        wea.elevationM = line.within(1, "site_elevation", -1000, 9999.9);
        break;
    default:
        if (line.words[1] != "1")
            line.refuse(fmt::format("weather_data_file_units is {}, expected 1 (direct normal and diffuse "
                                    "horizontal irradiance, W/m2)",
                                    line.words[1].substr(0, 30)));
    }
}

struct Reading {
    EpwRecord record;
    double clock = 0; // hour of the day
};

Reading readReading(const WeaLine& line) {
    if (line.words.size() < 5)
        line.refuse(fmt::format("has {} numbers, expected 5: month, day, hour, direct and diffuse irradiance",
                                line.words.size()));
    Reading reading;
    reading.record.line = line.number;
    reading.record.date = {2001, line.whole(0, "month", 1, 12), 1};
    reading.record.date.day = line.whole(1, "day", 1, daysInMonth(2000, reading.record.date.month));
    reading.clock = line.within(2, "hour", 0, 24);
    reading.record.direct = line.irradiance(3, "direct normal irradiance");
    reading.record.diffuse = line.irradiance(4, "diffuse horizontal irradiance");
    return reading;
}

// By the least time between two readings of a day; 1 where there are none.
int recordsPerHour(const std::vector<Reading>& readings) {
    double least = 1;
    for (size_t k = 1; k < readings.size(); ++k)
        if (const double step = readings[k].clock - readings[k - 1].clock;
            readings[k].record.date == readings[k - 1].record.date && step > 0)
            least = std::min(least, step);
    return static_cast<int>(std::lround(std::min(60.0, 1 / least)));
}

// How far into its interval a reading stands, as a share of it: 0.5 as Radiance's own programs write hours;
// 0 or 1 on the hour, as others do, where 24 o'clock tells that intervals end there.
double placeInInterval(const std::vector<Reading>& readings, int perHour) {
    const double part = readings[0].clock * perHour;
    if (std::abs(part - std::round(part)) > kOnTime * perHour) return 0.5;
    return std::ranges::any_of(readings, [](const Reading& r) { return r.clock == 24; }) ? 1 : 0;
}

void place(const std::string& file, std::vector<Reading>& readings, EpwFile& wea) {
    const int perHour = wea.recordsPerHour = recordsPerHour(readings);
    const double within = placeInInterval(readings, perHour);
    wea.sunHours = (within - 1) / perHour;
    if (within != 0.5)
        wea.warnings.emplace_back("hours are no middles of records, as 12.5 is: the sun is taken at them; "
                                  "where they are an EPW's, ends of hours, write 0.5 less");
    const bool leap = std::ranges::any_of(
        readings, [](const Reading& r) { return r.record.date.month == 2 && r.record.date.day == 29; });
    const auto refuse = [&](const Reading& reading, const std::string& what) {
        throw geometry::InputError(file, std::to_string(reading.record.line), what);
    };
    double first = 0, last = -1;
    int month = 12;
    bool nextYear = false; // from November to February
    for (Reading& reading : readings) {
        const double part = reading.clock * perHour - within, whole = std::round(part);
        if (60 % perHour != 0 || whole < 0 || whole >= 24 * perHour ||
            std::abs(part - whole) > kOnTime * perHour)
            refuse(reading, fmt::format("hour is {:g}, expected {:g} and so on, {} an hour", reading.clock,
                                        12 + within / perHour, perHour));
        EpwRecord& record = reading.record;
        record.hour = static_cast<int>(whole) / perHour + 1;
        record.part = static_cast<int>(whole) % perHour;
        record.date.year = leap ? 2004 : 2001;
        const double at = static_cast<double>(daysSinceEpoch(record.date)) * 24 * perHour + whole;
        if (last < 0) first = at;
        const bool turns = !nextYear && at <= last && month == 12 && record.date.month == 1;
        nextYear |= turns;
        if ((at <= last && !turns) || (nextYear && at >= first))
            refuse(reading, "does not follow the record before it, expected records in order");
        month = record.date.month;
        last = at;
        wea.records.push_back(record);
    }
}

} // namespace

bool isWea(std::string_view text) {
    const Words words = wordsOf(text.substr(0, text.find('\n')));
    return !words.empty() && words[0] == kHead[0];
}

EpwFile readWea(const std::string& file, std::string_view text) {
    EpwFile wea;
    wea.isWea = true;
    std::vector<Reading> readings;
    size_t number = 0, head = 0;
    while (!text.empty()) {
        const size_t end = text.find('\n');
        const std::string_view content = text.substr(0, end);
        text.remove_prefix(end == text.npos ? text.size() : end + 1);
        const WeaLine line{file, ++number, content, wordsOf(content)};
        if (line.words.empty() || line.words[0].starts_with('#')) continue;
        if (head < kHead.size())
            readHead(line, head++, wea);
        else
            readings.push_back(readReading(line));
    }
    if (readings.empty())
        throw geometry::InputError(
            file, std::to_string(number),
            head < kHead.size()
                ? fmt::format("the file ends before '{}', line {} of a .wea", kHead[head], head + 1)
                : "the file ends before a record: month, day, hour, direct and diffuse irradiance");
    place(file, readings, wea);
    return wea;
}

} // namespace heliodon::daylight
