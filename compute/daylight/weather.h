// A year (or part) of weather from an EPW file (EnergyPlus/ESP-r weather) or a .wea (Radiance, wea.h), plain
// or gzip: where the sun stood and what it and the sky gave, hour by hour.
//
// Time: an EPW record "hour h" is the mean over the hour that ends at h o'clock, local standard time (no
// summer time). The sun is taken at the middle of that hour, h - 0.5, as epw2wea and gendaymtx do. Files that
// say otherwise in a comment ("Irradiance Time Offset", PVGIS) are believed; where the three irradiances of a
// file contradict the convention, a warning says which shift would close them. The year is each record's own
// (a typical year is put together from several).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "compute/daylight/sky.h"
#include "compute/daylight/sun_position.h"

namespace heliodon::daylight {

struct WeatherHour {
    Date date;              // local standard time
    double clockHour = 0.5; // middle of the record's interval, (0, 24)
    double utc = 0;         // the instant that the sun is taken at
    SunPosition sun;
    Irradiance irradiance;          // gaps filled, see Weather::warnings
    double globalHorizontal = 0;    // W/m2 as in the file, or from the other two
    double precipitableWaterCm = 2; // from the dew point; 2 where that is missing
    bool filled = false;            // irradiance was missing in the file and derived or borrowed
};

inline constexpr uint32_t kNoRecord = ~uint32_t{0};

struct Weather {
    std::string place; // "Chicago Ohare Intl Ap, IL, USA"
    Site site;
    double timeZoneHours = 0; // of the records' clock, east of Greenwich positive
    double elevationM = 0;
    int recordsPerHour = 1;
    double sunShiftHours =
        0; // of the sun's instant from the middle of a record's interval; not 0 only where stated
    std::vector<WeatherHour> hours;    // in the file's order
    std::vector<std::string> warnings; // naming the file: gaps, odd conventions

    double recordHours() const { return 1.0 / recordsPerHour; }
    // Of each record of a leap year: its place in `hours`, or kNoRecord where the file does not cover it, so
    // that a moment's is found at once.
    std::vector<uint32_t> byPlace;
};

// Accepts gzip, CRLF, a byte-order mark, blank and '#' lines, lines of commas, Windows-1252, a missing
// elevation (0 m), capitals or not in the header, its dates as spreadsheets write them, leap days, hours 0
// to 23, clocks at the records' ends (midnight the next day's 0 o'clock, hours as 13:00), several records
// an hour and partial years. The header's summer time is not asked, minutes only to tell such clocks:
// records follow one another. 9999 and above, and a blank, is missing: one missing irradiance is derived
// from the other two (GHI = DNI sin h + DHI), both components from GHI alone by Erbs, Klein and Duffie
// 1982, all three borrowed from the same hour of the nearest day within a week. A negative direct
// irradiance is 0 (noise of the night), or missing where global less diffuse says that the sun shone;
// light of the sun in the night is warned of and left out, whole days without light are warned of, and
// months are warned of whose direct and diffuse irradiance do not add up to the global. Throws
// InputError(file, line, ...): a wrong number, a record out of order, an end before the data period's, no
// irradiance by day at all. 0.2 s a year.
Weather readWeather(const std::filesystem::path& file);

struct WeatherSky {
    SkySetting setting;
    // Take the efficacies' precipitable water from each record's dew point, as the model was meant. Off: the
    // setting's 2 cm for every hour, as Radiance's gendaymtx does; direct light then differs by 6 % rms in a
    // continental climate.
    bool waterFromDewPoint = false;
};

// Perez sky of one record.
Sky skyOfHour(const WeatherHour& hour, const WeatherSky& options = {});

// For any instant: the sun's exact position with the irradiance interpolated linearly between the middles of
// the records of that day of the (typical) year, from December on to January. Dark in nights that the file
// leaves out of days that it has; none elsewhere outside the period that it covers.
std::optional<Sky> skyAt(const Weather& weather, double utcSeconds, const WeatherSky& options = {});

// Whether someone is there: the middle of the record lies in [from, to) o'clock. All days of the week (LM-83
// uses 8 to 18).
bool isOccupied(const WeatherHour& hour, double fromHour = 8, double toHour = 18);

} // namespace heliodon::daylight
