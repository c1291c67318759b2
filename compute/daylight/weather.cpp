// D. Erbs, S. Klein, J. Duffie: Estimation of the diffuse radiation fraction for hourly, daily and
// monthly-average global radiation. Solar Energy 28, 1982 (components from global alone).
#include "compute/daylight/weather.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "compute/daylight/epw.h"
#include "compute/daylight/frame.h"
#include "geometry/input_error.h"

namespace heliodon::daylight {

namespace {

constexpr double kSolarConstant = 1367.0;
constexpr double kMiddle = -0.5; // hours from the end of a record's hour

double sineOf(double altitudeDeg) {
    return std::sin(radians(altitudeDeg));
}

SunOptions sunOptions(double elevationM) {
    SunOptions options;
    options.elevationM = elevationM;
    // The standard atmosphere's pressure there.
    options.pressureMbar = 1013.25 * std::pow(1.0 - 2.25577e-5 * elevationM, 5.25588);
    return options;
}

// "1 daylit record lacks", "3 daylit records lack"
std::string daylitThatLack(size_t count) {
    return fmt::format("{} daylit record{}", count, count == 1 ? " lacks" : "s lack");
}

// The instant `shift` hours after the end of the record's interval.
double instantOf(const EpwFile& epw, const EpwRecord& record, double shift) {
    Date date = record.date;
    if (date.year < 1900 || date.year > 2100) date.year = 2001;
    const double end = record.hour - 1 + (record.part + 1.0) / epw.recordsPerHour;
    return static_cast<double>(daysSinceEpoch(date)) * 86400.0 + (end - epw.timeZoneHours + shift) * 3600.0;
}

// Sunny records that state all three irradiances, at most about 300 spread over the file.
std::vector<const EpwRecord*> closureRecords(const EpwFile& epw) {
    std::vector<const EpwRecord*> sunny;
    for (const auto& r : epw.records)
        if (r.global && r.direct && r.diffuse && *r.direct > 200) sunny.push_back(&r);
    const size_t step = sunny.size() / 300 + 1;
    std::vector<const EpwRecord*> some;
    for (size_t i = 0; i < sunny.size(); i += step) some.push_back(sunny[i]);
    return some;
}

// Root mean square of (GHI - DHI) / DNI - sin h with the sun `shift` hours after the records' ends.
double closureError(const EpwFile& epw, const std::vector<const EpwRecord*>& records, double shift) {
    const Site site{epw.latitudeDeg, epw.longitudeDeg};
    double sum = 0;
    for (const auto* r : records) {
        const double implied = (*r->global - *r->diffuse) / *r->direct;
        const double difference =
            implied - sineOf(sunPosition(instantOf(epw, *r, shift), site).trueAltitudeDeg);
        sum += difference * difference;
    }
    return std::sqrt(sum / static_cast<double>(std::max<size_t>(records.size(), 1)));
}

// Where in (or beside) its interval a record's sun is taken, hours from the interval's end.
double chooseShift(EpwFile& epw, std::vector<std::string>& warnings) {
    if (epw.sunHours) return *epw.sunHours;
    const double middle = kMiddle / epw.recordsPerHour;
    const auto records = closureRecords(epw);
    const bool enough = records.size() >= 50;
    if (epw.irradianceOffsetHours) {
        // PVGIS counts in UTC whatever its header's time zone says: the irradiances tell which of the two is
        // meant.
        const double local = *epw.irradianceOffsetHours, utc = local + epw.timeZoneHours;
        const bool inUtc = enough && closureError(epw, records, utc) < closureError(epw, records, local);
        warnings.push_back(fmt::format("states an irradiance time offset of {:g} h; the sun is taken there{}",
                                       local, inUtc ? "; its hours count in UTC, against its header" : ""));
        if (inUtc) epw.timeZoneHours = 0;
        return local;
    }
    if (!enough) return middle;
    const double atMiddle = closureError(epw, records, middle);
    double best = middle, least = atMiddle;
    for (double shift = -2.0; shift <= 2.01; shift += 0.25) {
        const double error = closureError(epw, records, shift);
        if (error < least) {
            least = error;
            best = shift;
        }
    }
    if (std::abs(best - middle) > 0.2 && least < 0.5 * atMiddle)
        warnings.push_back(fmt::format(
            "the irradiances fit a sun {:+.2f} h from the middle of each hour better than the EPW "
            "convention (rms {:.3f} instead of {:.3f} in sin h); the convention is kept",
            best - middle, least, atMiddle));
    return middle;
}

// Diffuse share of global radiation from the clearness index.
double erbsFraction(double kt) {
    if (kt <= 0.22) return 1.0 - 0.09 * kt;
    if (kt > 0.80) return 0.165;
    return 0.9511 + kt * (-0.1604 + kt * (4.388 + kt * (-16.638 + kt * 12.336)));
}

enum class Gap { none, derived, open };

// Fills the hour's irradiances from what the record has of them.
Gap fillFromRecord(const EpwRecord& record, WeatherHour& hour) {
    const double sine = std::max(0.0, sineOf(hour.sun.altitudeDeg));
    const double outside = kSolarConstant / (hour.sun.earthSunAu * hour.sun.earthSunAu);
    // Below 3 degrees the quotient is noise.
    const auto beam = [&](double horizontal) {
        return sine > 0.05 ? std::clamp(horizontal / sine, 0.0, outside) : 0.0;
    };
    auto& [direct, diffuse] = hour.irradiance;
    if (record.direct && record.diffuse) {
        direct = *record.direct;
        diffuse = *record.diffuse;
        hour.globalHorizontal = record.global.value_or(direct * sine + diffuse);
        return Gap::none;
    }
    if (!hour.sun.isUp()) {
        direct = 0;
        diffuse = record.diffuse.value_or(0);
        hour.globalHorizontal = record.global.value_or(diffuse);
        return Gap::none;
    }
    if (!record.global) {
        hour.irradiance = {record.direct.value_or(0), record.diffuse.value_or(0)};
        return Gap::open;
    }
    hour.globalHorizontal = *record.global;
    if (record.direct) {
        direct = *record.direct;
        diffuse = std::max(0.0, *record.global - direct * sine);
    } else {
        diffuse = record.diffuse
                      ? *record.diffuse
                      : *record.global * erbsFraction(*record.global / std::max(outside * sine, 1.0));
        direct = beam(*record.global - diffuse);
    }
    return Gap::derived;
}

// A place for each record of a leap year.
size_t placeOf(const Date& date, double clockHour, int recordsPerHour) {
    const int day = dayOfYear({2000, date.month, date.day}) - 1;
    const auto part = static_cast<size_t>(std::max(0.0, std::floor(clockHour * recordsPerHour)));
    const size_t aDay = 24 * static_cast<size_t>(recordsPerHour);
    return static_cast<size_t>(day) * aDay + std::min(part, aDay - 1);
}

// What the record lacks, from the same hour of the nearest day within a week, of the (typical) year, that has
// a record of its own.
bool borrow(Weather& weather, const EpwRecord& record, const std::vector<Gap>& gaps, size_t i) {
    WeatherHour& hour = weather.hours[i];
    for (int days = 1; days <= 7; ++days)
        for (const int aside : {-days, days}) {
            const Date date = dateFromDays(daysSinceEpoch(hour.date) + aside);
            const uint32_t other = weather.byPlace.at(placeOf(date, hour.clockHour, weather.recordsPerHour));
            if (other == kNoRecord || gaps[other] == Gap::open || !weather.hours[other].sun.isUp()) continue;
            const WeatherHour& there = weather.hours[other];
            auto& [direct, diffuse] = hour.irradiance;
            if (!record.direct) direct = there.irradiance.directNormal;
            if (!record.diffuse) diffuse = there.irradiance.diffuseHorizontal;
            hour.globalHorizontal = record.direct || record.diffuse
                                        ? direct * std::max(0.0, sineOf(hour.sun.altitudeDeg)) + diffuse
                                        : there.globalHorizontal;
            return true;
        }
    return false;
}

void fillGaps(const EpwFile& epw, Weather& weather, const std::vector<Gap>& gaps) {
    size_t derived = 0, borrowed = 0, lost = 0;
    for (size_t i = 0; i < gaps.size(); ++i) {
        if (gaps[i] == Gap::none) continue;
        weather.hours[i].filled = true;
        if (gaps[i] == Gap::derived)
            ++derived;
        else if (borrow(weather, epw.records[i], gaps, i))
            ++borrowed;
        else
            ++lost;
    }
    if (derived)
        weather.warnings.push_back(daylitThatLack(derived) +
                                   " an irradiance; it was derived from the others");
    if (borrowed)
        weather.warnings.push_back(daylitThatLack(borrowed) +
                                   " irradiance; it was taken from the nearest day");
    if (lost)
        weather.warnings.push_back(daylitThatLack(lost) +
                                   " irradiance and no day within a week has it: dark");
}

// Where no record by day has an irradiance, all would be dark.
void refuseWithoutLight(const std::filesystem::path& file, const EpwFile& epw, const Weather& weather,
                        const std::vector<Gap>& gaps) {
    const auto byDay = std::ranges::find_if(weather.hours, [](const WeatherHour& h) { return h.sun.isUp(); });
    if (byDay == weather.hours.end()) return;
    for (size_t i = 0; i < gaps.size(); ++i)
        if (weather.hours[i].sun.isUp() && gaps[i] != Gap::open) return;
    const EpwRecord& first = epw.records[static_cast<size_t>(byDay - weather.hours.begin())];
    throw geometry::InputError(
        file.string(), std::to_string(first.line),
        fmt::format("neither this record nor any other by day has {}, expected W/m2",
                    epw.isWea ? "both direct and diffuse irradiance"
                              : "global, or direct and diffuse, irradiance (fields 14 to 16)"));
}

// Light all through whose interval the sun is too low for it: direct sun well below the horizon, or diffuse
// light beyond twilight.
bool shinesAtNight(const EpwFile& epw, const EpwRecord& record, double shift) {
    constexpr double kSurelySun = 50, kSurelySky = 20; // W/m2
    const bool sun = record.direct && *record.direct >= kSurelySun,
               sky = record.diffuse && *record.diffuse >= kSurelySky;
    if (!sun && !sky) return false;
    const double lowest = sun ? -1 : kTwilightDeg;
    const Site site{epw.latitudeDeg, epw.longitudeDeg};
    const double half = 0.5 / epw.recordsPerHour;
    return std::ranges::all_of(std::array{0.0, -half, half}, [&](double aside) {
        return sunPosition(instantOf(epw, record, shift + aside), site).trueAltitudeDeg < lowest;
    });
}

// What a month's records that state all three irradiances have in global, and in direct and diffuse together.
struct MonthOfLight {
    double global = 0, components = 0; // Wh/m2
};

// Real files' months close within 4 %; skies are made from direct and diffuse, whatever global says.
void warnOfComponents(const EpwFile& epw, Weather& weather) {
    constexpr double kApart = 0.15;   // of the larger
    constexpr double kEnough = 20000; // Wh/m2; few days, or low suns, say little
    constexpr size_t kLong = 28 * 24; // hours that cannot all be dark
    std::array<MonthOfLight, 12> months{};
    double total = 0;
    for (size_t i = 0; i < epw.records.size(); ++i) {
        const EpwRecord& r = epw.records[i];
        const WeatherHour& hour = weather.hours[i];
        total += hour.irradiance.directNormal + hour.irradiance.diffuseHorizontal;
        if (!(r.global && r.direct && r.diffuse && hour.sun.isUp())) continue;
        MonthOfLight& month = months.at(static_cast<size_t>(r.date.month - 1));
        month.global += *r.global * weather.recordHours();
        month.components += (*r.direct * sineOf(hour.sun.altitudeDeg) + *r.diffuse) * weather.recordHours();
    }
    const auto difference = [](const MonthOfLight& m) { return std::abs(m.components - m.global); };
    const auto apart = std::ranges::count_if(months, [&](const MonthOfLight& m) {
        const double most = std::max(m.global, m.components);
        return most > kEnough && difference(m) > kApart * most;
    });
    const auto worst = std::ranges::max_element(months, {}, difference);
    if (apart)
        weather.warnings.push_back(
            fmt::format("direct and diffuse irradiance (fields 15 and 16) do not add up to the global (field "
                        "14) in {} month{}: "
                        "{:.0f} against {:.0f} kWh/m2 in month {}; light is made from direct and diffuse",
                        apart, apart == 1 ? "" : "s", worst->components / 1000, worst->global / 1000,
                        worst - months.begin() + 1));
    else if (total == 0 && epw.records.size() >= kLong * static_cast<size_t>(epw.recordsPerHour))
        weather.warnings.push_back(fmt::format("no record has direct or diffuse irradiance{}: all is dark",
                                               epw.isWea ? "" : " (fields 15 and 16)"));
}

// Zeros where 9999 was meant, or kW/m2: under a sun so high, the heaviest cloud lets some W/m2 through.
void warnOfDarkDays(const EpwFile& epw, Weather& weather) {
    constexpr double kHigh = 10; // degrees
    constexpr double kLeast = 2; // W/m2
    const auto isLight = [](const std::optional<double>& v) { return !v || *v > kLeast; };
    size_t dark = 0, first = 0, lit = 0;
    bool faint = false;
    const size_t count = epw.records.size();
    for (size_t begin = 0, end = 0; begin < count; begin = end) {
        bool light = false, high = false;
        for (; end < count && epw.records[end].date == epw.records[begin].date; ++end) {
            const EpwRecord& r = epw.records[end];
            light |= (!epw.isWea && isLight(r.global)) || isLight(r.direct) || isLight(r.diffuse);
            faint |= r.global > 0.0 || r.direct > 0.0 || r.diffuse > 0.0;
            high |= weather.hours[end].sun.trueAltitudeDeg > kHigh;
        }
        lit += light;
        if (!light && high && dark++ == 0) first = epw.records[begin].line;
    }
    if (dark && lit)
        weather.warnings.push_back(
            fmt::format("{} day{} no light at all, the first from line {} on, though the sun is over {:g} "
                        "degrees high: missing values are 9999, these stay dark",
                        dark, dark == 1 ? " has" : "s have", first, kHigh));
    else if (dark && faint)
        weather.warnings.push_back(fmt::format(
            "no irradiance is over {:g} W/m2 though the sun is over {:g} degrees high: {} in W/m2?", kLeast,
            kHigh, epw.isWea ? "is it" : "are fields 14 to 16"));
}

} // namespace

Weather readWeather(const std::filesystem::path& file) {
    EpwFile epw = readEpw(file);
    Weather weather;
    weather.warnings = epw.warnings;
    const double shift = chooseShift(epw, weather.warnings);
    weather.sunShiftHours = shift - kMiddle / epw.recordsPerHour;
    weather.place = epw.place;
    weather.site = {epw.latitudeDeg, epw.longitudeDeg};
    weather.timeZoneHours = epw.timeZoneHours;
    weather.elevationM = epw.elevationM;
    weather.recordsPerHour = epw.recordsPerHour;
    const SunOptions options = sunOptions(epw.elevationM);

    std::vector<Gap> gaps;
    size_t withoutDewPoint = 0, atNight = 0;
    weather.hours.reserve(epw.records.size());
    weather.byPlace.assign(size_t{366} * 24 * static_cast<size_t>(weather.recordsPerHour), kNoRecord);
    for (const EpwRecord& record : epw.records) {
        WeatherHour hour;
        hour.date = record.date;
        hour.clockHour = record.hour - 1 + (record.part + 0.5) / epw.recordsPerHour;
        hour.utc = instantOf(epw, record, shift);
        hour.sun = sunPosition(hour.utc, weather.site, options);
        if (record.dewPointC)
            hour.precipitableWaterCm = precipitableWaterCm(*record.dewPointC);
        else if (hour.sun.isUp() && !epw.isWea)
            ++withoutDewPoint;
        if (!hour.sun.isUp() && shinesAtNight(epw, record, shift)) ++atNight;
        gaps.push_back(fillFromRecord(record, hour));
        uint32_t& there = weather.byPlace[placeOf(hour.date, hour.clockHour, weather.recordsPerHour)];
        if (there == kNoRecord) there = static_cast<uint32_t>(weather.hours.size());
        weather.hours.push_back(hour);
    }
    if (atNight)
        weather.warnings.push_back(fmt::format(
            "{} of {} records have light of the sun while it is below the horizon: are place and "
            "time zone ({:+g} h at longitude {:.2f} east) of line{} right?",
            atNight, epw.records.size(), epw.timeZoneHours, epw.longitudeDeg, epw.isWea ? "s 2 to 4" : " 1"));
    if (epw.directRefuted)
        weather.warnings.push_back(fmt::format(
            "{} negative direct irradiance{} counted as missing: global and diffuse say that the sun shone",
            epw.directRefuted, epw.directRefuted == 1 ? " is" : "s are"));
    refuseWithoutLight(file, epw, weather, gaps);
    fillGaps(epw, weather, gaps);
    warnOfComponents(epw, weather);
    warnOfDarkDays(epw, weather);
    if (withoutDewPoint)
        weather.warnings.push_back(daylitThatLack(withoutDewPoint) +
                                   " the dew point; 2 cm of precipitable water is taken");
    for (std::string& warning : weather.warnings) warning = file.string() + ": " + warning;
    return weather;
}

Sky skyOfHour(const WeatherHour& hour, const WeatherSky& options) {
    SkySetting setting = options.setting;
    if (options.waterFromDewPoint) setting.precipitableWaterCm = hour.precipitableWaterCm;
    return skyFromIrradiance(hour.irradiance, hour.sun, setting);
}

namespace {

// Local standard time such that a record's sun stands at the middle of its interval.
struct Clock {
    Date date;
    double hour; // [0, 24)
};

Clock clockOf(const Weather& weather, double utc) {
    const double local = utc + (weather.timeZoneHours - weather.sunShiftHours) * 3600.0,
                 day = std::floor(local / 86400.0);
    return {dateFromDays(static_cast<int64_t>(day)), (local - day * 86400.0) / 3600.0};
}

// The record of that day and clock, whatever its year; 29 February stands in for nothing and falls back to
// the 28th.
std::optional<size_t> recordAt(const Weather& weather, double utc) {
    const Clock clock = clockOf(weather, utc);
    const Date& date = clock.date;
    const auto found = [&](const Date& day) -> std::optional<size_t> {
        const uint32_t record = weather.byPlace.at(placeOf(day, clock.hour, weather.recordsPerHour));
        return record == kNoRecord ? std::nullopt : std::optional<size_t>(record);
    };
    const auto here = found(date);
    return here || date.month != 2 || date.day != 29 ? here : found({date.year, 2, 28});
}

// Whether that day has records, all of them before or all after this instant, and the sun is down or about to
// be so: files may leave out nights.
bool isNightLeftOut(const Weather& weather, const SunPosition& sun, double utc) {
    constexpr double kLow = 8; // degrees; the hour whose middle is in the night ends so at most
    if (sun.altitudeDeg > kLow) return false;
    const Clock clock = clockOf(weather, utc);
    const size_t aDay = 24 * static_cast<size_t>(weather.recordsPerHour),
                 first = placeOf(clock.date, 0, weather.recordsPerHour),
                 now = placeOf(clock.date, clock.hour, weather.recordsPerHour) - first;
    const auto records = std::span(weather.byPlace).subspan(first, aDay);
    const auto any = [&](size_t from, size_t to) {
        return std::ranges::any_of(records.subspan(from, to - from),
                                   [](uint32_t r) { return r != kNoRecord; });
    };
    return any(0, now) != any(now, aDay);
}

} // namespace

std::optional<Sky> skyAt(const Weather& weather, double utc, const WeatherSky& options) {
    const SunPosition sun = sunPosition(utc, weather.site, sunOptions(weather.elevationM));
    const auto here = recordAt(weather, utc);
    if (!here && isNightLeftOut(weather, sun, utc)) return skyFromIrradiance({}, sun, options.setting);
    if (!here) return std::nullopt;
    const WeatherHour& hour = weather.hours[*here];
    const double ahead = (clockOf(weather, utc).hour - hour.clockHour) / weather.recordHours(); // -0.5 .. 0.5
    const double toNext = (ahead < 0 ? -3600.0 : 3600.0) * weather.recordHours();
    const size_t next = recordAt(weather, utc + toNext).value_or(*here);
    const double share = std::abs(ahead);
    const auto mix = [&](double a, double b) { return (1.0 - share) * a + share * b; };
    const WeatherHour& other = weather.hours[next];

    WeatherHour now = hour;
    now.irradiance.directNormal = mix(hour.irradiance.directNormal, other.irradiance.directNormal);
    now.irradiance.diffuseHorizontal =
        mix(hour.irradiance.diffuseHorizontal, other.irradiance.diffuseHorizontal);
    now.precipitableWaterCm = mix(hour.precipitableWaterCm, other.precipitableWaterCm);
    now.sun = sun;
    return skyOfHour(now, options);
}

bool isOccupied(const WeatherHour& hour, double fromHour, double toHour) {
    return hour.clockHour >= fromHour && hour.clockHour < toHour;
}

} // namespace heliodon::daylight
