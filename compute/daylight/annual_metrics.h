// What a year of hourly illuminance says about a room. Every metric comes with the interval that the stated
// error of the illuminances leaves open: low <= true value <= high.
//
// clang-format off
//   DA    share of occupied hours with at least 300 lux (Reinhart, Walkenhorst 2001)
//   cDA   as DA, hours below counting in proportion E / 300 (Rogers 2006)
//   UDI   shares below 100, in [100, 300), [300, 3000], and above 3000 lux (Nabil, Mardaljevic 2006, 2012)
//   sDA   share of sensors with DA of at least 50 % (IES LM-83: sDA300/50%)
//   ASE   share of sensors with more than 1000 lux of direct sun for more than 250 occupied hours (LM-83:
//         ASE1000,250h)
// clang-format on
//
// Hours are records of the weather file, weighed by their length.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace heliodon::daylight {

struct AnnualOptions {
    double targetLux = 300;
    double udiLowLux = 100, udiHighLux = 3000; // the middle of UDI is targetLux
    double sdaShare = 0.5;
    double aseLux = 1000, aseHours = 250;
    double recordHours = 1; // length of a record
    // Where metrics are made of parts of the year and then added: occupied records of all of it.
    size_t occupiedRecords = 0; // 0: of what is given
};

struct Range {
    double value = 0, low = 0, high = 0;
};

// Percent of the occupied hours, but for the last two.
struct SensorMetrics {
    Range da, cda;
    Range udiBelow, udiSupplementary, udiAutonomous, udiUseful,
        udiAbove;        // useful = supplementary + autonomous
    Range sunHours;      // occupied hours with direct sun above aseLux
    double luxHours = 0; // over all records, occupied or not

    SensorMetrics& operator+=(const SensorMetrics& part); // of other records (AnnualOptions::occupiedRecords)
};

struct AnnualSummary {
    size_t sensors = 0;
    double occupiedHours = 0;
    Range sda, ase;                                                      // percent of sensors
    double meanDa = 0, meanCda = 0, meanUdiUseful = 0, meanUdiAbove = 0; // percent
    double meanLux = 0;                                                  // over occupied hours and sensors
};

struct AnnualMetrics {
    std::vector<SensorMetrics> sensors;
    AnnualSummary summary;
};

// All arrays hold sensor after sensor, one value per record: lux[sensor * records + record]. `occupied` has
// one flag per record. `sunLux` (direct sun alone, for ASE) and `luxError` (half-width of each illuminance's
// interval, lux; taken for the sun's part too, where there is any) may be empty. `sunEdges`: by place in
// these arrays, the direct sun that may be there where `sunLux` is 0, just beside a beam; the low end of
// sunHours' interval needs none, as luxError has it. Throws std::invalid_argument when sizes do not fit.
// About 2 ns a value.
AnnualMetrics annualMetrics(std::span<const float> lux, std::span<const float> sunLux,
                            std::span<const uint8_t> occupied, const AnnualOptions& options = {},
                            std::span<const float> luxError = {},
                            const std::map<size_t, float>& sunEdges = {});

// Summary of sensors whose metrics were made in several calls, all with the same `occupied` and options; its
// meanLux is left 0.
AnnualMetrics summarized(std::vector<SensorMetrics> sensors, std::span<const uint8_t> occupied,
                         const AnnualOptions& options = {});

} // namespace heliodon::daylight
