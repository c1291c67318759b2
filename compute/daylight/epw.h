// The text of an EPW file, or of a .wea (wea.h), as records, before anything is made of it (format:
// EnergyPlus, "Auxiliary Programs", weather file data dictionary). Only weather.cpp and tests need this.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "compute/daylight/time.h"

namespace heliodon::daylight {

struct EpwRecord {
    size_t line = 0;                 // of the file, from 1
    Date date;                       // the year is the record's own
    int hour = 1;                    // 1..24, ends at that hour, local standard time
    int part = 0;                    // 0 .. recordsPerHour - 1 within the hour
    std::optional<double> dewPointC; // (-90, 70); none where the file has no such number
    // W/m2, 0 .. 1500: global horizontal, direct normal, diffuse horizontal; none where missing (9999).
    std::optional<double> global, direct, diffuse;
};

// W/m2 as weather files have it: none where it is missing; noise of the night, slightly negative, is 0. What
// is no irradiance goes to `refuse` with what is wrong, which is to throw.
template<class Refuse> std::optional<double> irradianceFrom(double value, const Refuse& refuse) {
    constexpr double kMissing = 9999, kLeast = -50,
                     kGreatest = 1500; // above the sun's outside the atmosphere
    if (std::abs(value) >= kMissing) return std::nullopt;
    if (value < kLeast || value > kGreatest)
        refuse(fmt::format("is {:g} W/m2, expected 0 to {:g}, or 9999 where missing", value, kGreatest));
    return std::max(0.0, value);
}

struct EpwFile {
    std::string place; // city, region, country, as far as the file says
    double latitudeDeg = 0, longitudeDeg = 0, timeZoneHours = 0, elevationM = 0; // north, east, east, up
    int recordsPerHour = 1;                                                      // a divisor of 60
    std::optional<double> irradianceOffsetHours; // "Irradiance Time Offset (h)" of a comment
    std::optional<double> sunHours; // of a .wea: the sun's instant after the end of each interval
    std::vector<EpwRecord> records; // in order, without gaps over each data period of an EPW
    bool isWea = false;             // which has neither global irradiance nor dew points
    size_t directRefuted =
        0; // records whose negative direct irradiance counts as missing: the others say sun
    std::vector<std::string> warnings;
};

// Plain or gzip. Throws InputError with the line for a file that cannot be read, a number out of its range, a
// record out of order, and an end before the data period's. Less than the 0.2 s a year of readWeather.
EpwFile readEpw(const std::filesystem::path& file);

} // namespace heliodon::daylight
