#include "compute/daylight/annual_metrics.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <span>
#include <utility>

#include <gtest/gtest.h>

#include "tests/daylight/csv.h"

namespace heliodon::daylight {
namespace {

// Sensors x 8760 hours from rows month,day,hour,s0,s1,...; hours without a row are 0.
std::vector<float> yearOf(const std::string& name, size_t& sensors) {
    const test::Csv table(name);
    sensors = table.columns.size() - 3;
    constexpr int before[12] = {0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334};
    std::vector<float> year(sensors * 8760, 0.0f);
    for (size_t r = 0; r < table.rows.size(); ++r) {
        const auto day =
            static_cast<size_t>(before[std::stoi(table.rows[r][0]) - 1] + std::stoi(table.rows[r][1]) - 1);
        const auto hour = static_cast<size_t>(std::stod(table.rows[r][2]));
        for (size_t s = 0; s < sensors; ++s)
            year[s * 8760 + day * 24 + hour] = std::stof(table.rows[r][s + 3]);
    }
    return year;
}

std::vector<uint8_t> officeHours() {
    std::vector<uint8_t> occupied(8760);
    for (size_t i = 0; i < 8760; ++i) occupied[i] = i % 24 >= 8 && i % 24 < 18;
    return occupied;
}

TEST(AnnualMetrics, of_a_stored_year_are_those_of_the_table) {
    size_t sensors = 0, sunSensors = 0;
    const auto lux = yearOf("illuminance_lux_glz.csv.gz", sensors);
    const auto sun = yearOf("direct_sun_lux_glz.csv.gz", sunSensors);
    ASSERT_EQ(sensors, 78u);
    ASSERT_EQ(sunSensors, 78u);
    const AnnualMetrics metrics = annualMetrics(lux, sun, officeHours());
    const test::Csv table("metrics_glz.csv");
    ASSERT_EQ(table.rows.size(), sensors);
    for (size_t s = 0; s < sensors; ++s) {
        const SensorMetrics& m = metrics.sensors[s];
        // The table has four decimals.
        EXPECT_NEAR(m.da.value, table.number(s, "DA300_pct"), 5.1e-5);
        EXPECT_NEAR(m.cda.value, table.number(s, "cDA300_pct"), 5.1e-5);
        EXPECT_NEAR(m.udiBelow.value, table.number(s, "UDI_lt100_pct"), 5.1e-5);
        EXPECT_NEAR(m.udiSupplementary.value, table.number(s, "UDI_100_300_pct"), 5.1e-5);
        EXPECT_NEAR(m.udiAutonomous.value, table.number(s, "UDI_300_3000_pct"), 5.1e-5);
        EXPECT_NEAR(m.udiUseful.value, table.number(s, "UDI_100_3000_pct"), 5.1e-5);
        EXPECT_NEAR(m.udiAbove.value, table.number(s, "UDI_gt3000_pct"), 5.1e-5);
        EXPECT_EQ(m.sunHours.value, table.number(s, "direct_gt1000lx_hours"));
        EXPECT_EQ(m.luxHours, table.number(s, "annual_lux_hours"));
        EXPECT_EQ(m.da.low, m.da.high);
    }
    const test::Csv summary("annual_summary.csv");
    const size_t glz = summary.text(0, "case") == "glz" ? 0 : 1;
    EXPECT_EQ(metrics.summary.occupiedHours, summary.number(glz, "occupied_hours"));
    EXPECT_NEAR(metrics.summary.sda.value, summary.number(glz, "sDA300_50_pct"), 5.1e-5);
    EXPECT_NEAR(metrics.summary.ase.value, summary.number(glz, "ASE1000_250_pct"), 5.1e-5);
    EXPECT_NEAR(metrics.summary.meanDa, summary.number(glz, "mean_DA300"), 5.1e-5);
    EXPECT_NEAR(metrics.summary.meanCda, summary.number(glz, "mean_cDA"), 5.1e-5);
    EXPECT_NEAR(metrics.summary.meanUdiUseful, summary.number(glz, "mean_UDI_100_3000"), 5.1e-5);
    EXPECT_NEAR(metrics.summary.meanUdiAbove, summary.number(glz, "mean_UDI_gt3000"), 5.1e-5);
}

TEST(AnnualMetrics, limits_belong_to_the_band_that_the_definition_says) {
    const std::vector<float> lux{99.99f, 100, 299.99f, 300, 3000, 3000.5f, 0, 1e6f};
    const AnnualMetrics metrics = annualMetrics(lux, {}, std::vector<uint8_t>(8, 1));
    const SensorMetrics& m = metrics.sensors[0];
    EXPECT_DOUBLE_EQ(m.udiBelow.value, 25);         // 99.99 and 0
    EXPECT_DOUBLE_EQ(m.udiSupplementary.value, 25); // 100 and 299.99
    EXPECT_DOUBLE_EQ(m.udiAutonomous.value, 25);    // 300 and 3000
    EXPECT_DOUBLE_EQ(m.udiAbove.value, 25);
    EXPECT_DOUBLE_EQ(m.da.value, 50);
    EXPECT_DOUBLE_EQ(metrics.summary.sda.value, 100); // exactly half the hours is enough
}

TEST(AnnualMetrics, intervals_hold_every_truth_within_the_error) {
    std::minstd_rand random(5);
    std::lognormal_distribution<float> level(5.5f, 1.5f);
    std::uniform_real_distribution<float> share(-1, 1);
    const size_t sensors = 9, records = 500;
    std::vector<float> lux(sensors * records), sun(sensors * records), error(sensors * records);
    std::map<size_t, float> beside;
    for (size_t i = 0; i < lux.size(); ++i) {
        lux[i] = level(random);
        sun[i] = i % 3 ? 0 : level(random) * 4;
        error[i] = 0.05f * lux[i];
        if (i % 3 == 0 && i % 7 == 0) beside[i] = sun[i], sun[i] = 0; // of a beam that is there or not
    }
    const std::vector<uint8_t> occupied(records, 1);
    AnnualOptions options;
    options.aseHours = 40;
    const AnnualMetrics stated = annualMetrics(lux, sun, occupied, options, error, beside);
    EXPECT_LT(stated.sensors[0].da.low, stated.sensors[0].da.high);
    for (int trial = 0; trial < 50; ++trial) {
        std::vector<float> truth = lux, trueSun = sun;
        for (size_t i = 0; i < lux.size(); ++i) {
            truth[i] += 0.999f * share(random) * error[i];
            if (sun[i] > 0) trueSun[i] = std::max(0.0f, sun[i] + 0.999f * share(random) * error[i]);
        }
        for (const auto& [at, there] : beside) trueSun[at] = share(random) > -0.8f ? there : 0;
        const AnnualMetrics real = annualMetrics(truth, trueSun, occupied, options);
        const auto inside = [](const Range& r, double v) { return v >= r.low - 1e-9 && v <= r.high + 1e-9; };
        for (size_t s = 0; s < sensors; ++s)
            for (const auto metric :
                 {&SensorMetrics::da, &SensorMetrics::cda, &SensorMetrics::udiBelow,
                  &SensorMetrics::udiSupplementary, &SensorMetrics::udiAutonomous, &SensorMetrics::udiUseful,
                  &SensorMetrics::udiAbove, &SensorMetrics::sunHours})
                ASSERT_TRUE(inside(stated.sensors[s].*metric, (real.sensors[s].*metric).value));
        ASSERT_TRUE(inside(stated.summary.sda, real.summary.sda.value));
        ASSERT_TRUE(inside(stated.summary.ase, real.summary.ase.value));
    }
}

TEST(AnnualMetrics, parts_of_the_year_add_up) {
    std::minstd_rand random(6);
    std::lognormal_distribution<float> level(5.5f, 1.5f);
    const size_t records = 500, first = 180;
    std::vector<float> lux(records), sun(records), error(records);
    std::vector<uint8_t> occupied(records);
    for (size_t r = 0; r < records; ++r) {
        lux[r] = level(random), sun[r] = level(random), error[r] = 0.05f * lux[r];
        occupied[r] = r % 3 != 0;
    }
    AnnualOptions options;
    options.recordHours = 0.25;
    const SensorMetrics whole = annualMetrics(lux, sun, occupied, options, error).sensors[0];
    options.occupiedRecords = static_cast<size_t>(std::count(occupied.begin(), occupied.end(), 1));
    SensorMetrics sum;
    double meanLux = 0;
    for (const auto& [from, count] : {std::pair(size_t{0}, first), {first, records - first}}) {
        const auto part = [&, from = from, count = count](const auto& all) {
            return std::span(&all[from], count);
        };
        const AnnualMetrics of = annualMetrics(part(lux), part(sun), part(occupied), options, part(error));
        sum += of.sensors[0], meanLux += of.summary.meanLux;
    }
    for (const auto metric :
         {&SensorMetrics::da, &SensorMetrics::cda, &SensorMetrics::udiBelow, &SensorMetrics::udiSupplementary,
          &SensorMetrics::udiAutonomous, &SensorMetrics::udiUseful, &SensorMetrics::udiAbove,
          &SensorMetrics::sunHours}) {
        EXPECT_NEAR((sum.*metric).value, (whole.*metric).value, 1e-9);
        EXPECT_NEAR((sum.*metric).low, (whole.*metric).low, 1e-9);
        EXPECT_NEAR((sum.*metric).high, (whole.*metric).high, 1e-9);
    }
    EXPECT_NEAR(sum.luxHours, whole.luxHours, 1e-6);
    EXPECT_NEAR(meanLux, annualMetrics(lux, sun, occupied, options, error).summary.meanLux, 1e-6);
}

TEST(AnnualMetrics, empty_and_misfit_arrays_are_handled) {
    const std::vector<float> lux(20, 500.0f);
    const AnnualMetrics nobody = annualMetrics(lux, {}, std::vector<uint8_t>(10, 0));
    EXPECT_EQ(nobody.sensors.size(), 2u);
    EXPECT_EQ(nobody.sensors[1].da.value, 0);
    EXPECT_EQ(nobody.sensors[1].luxHours, 5000);
    EXPECT_EQ(annualMetrics({}, {}, std::vector<uint8_t>(10, 1)).summary.sensors, 0u);
    EXPECT_THROW(annualMetrics(lux, {}, {}), std::invalid_argument);
    EXPECT_THROW(annualMetrics(lux, {}, std::vector<uint8_t>(7, 1)), std::invalid_argument);
    EXPECT_THROW(annualMetrics(lux, std::vector<float>(3), std::vector<uint8_t>(10, 1)),
                 std::invalid_argument);
    EXPECT_THROW(annualMetrics(lux, {}, std::vector<uint8_t>(10, 1), {}, std::vector<float>(3)),
                 std::invalid_argument);
}

TEST(AnnualMetrics, two_thousand_sensors_take_a_fraction_of_a_second) {
    const std::vector<float> lux(200 * 8760, 350.0f);
    const auto start = std::chrono::steady_clock::now();
    const AnnualMetrics metrics = annualMetrics(lux, lux, officeHours());
    const double ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    EXPECT_NEAR(metrics.summary.sda.value, 100, 1e-9);
    std::printf("200 sensors: %.1f ms\n", ms);
}

} // namespace
} // namespace heliodon::daylight
