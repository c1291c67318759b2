// The text of an EPW file as records, before anything is made of it. Only weather.cpp and tests need this.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "compute/daylight/time.h"

namespace heliodon::daylight {

struct EpwRecord {
    size_t line = 0;
    Date date;
    int hour = 1; // 1..24
    int part = 0; // 0 .. recordsPerHour - 1 within the hour
    std::optional<double> dewPointC;
    std::optional<double> global, direct, diffuse; // W/m2: GHI, DNI, DHI
};

struct EpwFile {
    std::string place;
    double latitudeDeg = 0, longitudeDeg = 0, timeZoneHours = 0, elevationM = 0;
    int recordsPerHour = 1;
    std::optional<double> irradianceOffsetHours; // "Irradiance Time Offset (h)" of a comment
    std::vector<EpwRecord> records;
    std::vector<std::string> warnings;
};

EpwFile readEpw(const std::filesystem::path& file);

} // namespace heliodon::daylight
