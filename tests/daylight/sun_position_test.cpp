#include "compute/daylight/sun_position.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/daylight/csv.h"

namespace heliodon::daylight {
namespace {

double angleBetween(double a, double b) {
    return std::abs(std::remainder(a - b, 360.0));
}

double utcOf(const std::string& text) {
    return clockSeconds(parseTime(text, "table"));
}

TEST(SunPosition, agrees_with_every_row_of_the_spa_table) {
    const test::Csv table("spa_positions.csv.gz");
    ASSERT_EQ(table.rows.size(), 432u);
    for (size_t i = 0; i < table.rows.size(); ++i) {
        SunOptions options;
        options.elevationM = table.number(i, "elev_m");
        options.pressureMbar = table.number(i, "pressure_mbar");
        options.temperatureC = table.number(i, "temp_C");
        options.deltaTSeconds = table.number(i, "delta_t_s");
        const SunPosition sun =
            sunPosition(utcOf(table.text(i, "utc")),
                        {table.number(i, "lat_deg"), table.number(i, "lon_deg_east")}, options);
        SCOPED_TRACE(table.text(i, "site") + " " + table.text(i, "utc"));
        // The table has six decimals, its delta T three and its pressure two.
        EXPECT_LT(angleBetween(sun.azimuthDeg, table.number(i, "azimuth_deg_N0_clockwise")), 1.5e-6);
        EXPECT_NEAR(sun.trueAltitudeDeg, table.number(i, "elevation_true_deg"), 1.5e-6);
        EXPECT_NEAR(sun.altitudeDeg, table.number(i, "elevation_refracted_deg"), 3e-6);
        EXPECT_NEAR(sun.declinationDeg, table.number(i, "declination_deg"), 1e-6);
        EXPECT_NEAR(sun.equationOfTimeMin, table.number(i, "equation_of_time_min"), 1e-6);
        EXPECT_NEAR(sun.earthSunAu, table.number(i, "earth_sun_AU"), 1e-9);
        EXPECT_NEAR(deltaTSeconds(std::stod(table.text(i, "utc").substr(0, 4)) +
                                  (std::stod(table.text(i, "utc").substr(5, 2)) - 0.5) / 12),
                    *options.deltaTSeconds, 0.05); // theirs is for the local month: a month apart
    }
}

TEST(SunPosition, gives_the_published_example_of_the_report) {
    SunOptions options{1830.14, 820, 11, 0.5667, 67.0};
    const SunPosition sun = sunPosition(utcOf("2003-10-17T12:30:30-07:00"), {39.742476, -105.1786}, options);
    // As printed in NREL/TP-560-34302, table A5.1.
    EXPECT_NEAR(90 - sun.altitudeDeg, 50.11162, 5e-6);
    EXPECT_NEAR(sun.azimuthDeg, 194.34024, 5e-6);
    EXPECT_NEAR(sun.equationOfTimeMin, 14.641503, 1e-4);
    EXPECT_NEAR(sun.earthSunAu, 0.9965422974, 1e-9);
}

TEST(SunDay, rise_transit_and_set_agree_with_the_table) {
    const test::Csv table("spa_sunrise_transit_sunset.csv.gz");
    ASSERT_EQ(table.rows.size(), 216u);
    double worst = 0;
    for (size_t i = 0; i < table.rows.size(); ++i) {
        const double noon = utcOf(table.text(i, "utc_date") + "T12:00Z");
        const double latitude = table.number(i, "lat_deg");
        const SunDay day = sunDay(noon, {latitude, table.number(i, "lon_deg_east")});
        SCOPED_TRACE(table.text(i, "site") + " " + table.text(i, "utc_date"));
        // The table interpolates right ascension and declination over three days (1 s and more where the sun
        // grazes the horizon) and is rounded to a second.
        EXPECT_NEAR(day.transitUtc, utcOf(table.text(i, "transit_utc")), 1.0);
        const bool rises = !table.text(i, "sunrise_utc").empty();
        ASSERT_EQ(day.kind == DayKind::risesAndSets, rises);
        if (!rises) continue;
        // The report folds times of day into the UTC date before it solves (m mod 1): a set after midnight
        // UTC is there the evening before plus 24 h, a rise before midnight the morning after less 24 h. Ours
        // belong to the transit.
        const double midnight = noon - 43200;
        const double rise = utcOf(table.text(i, "sunrise_utc")), set = utcOf(table.text(i, "sunset_utc"));
        const Site site{latitude, table.number(i, "lon_deg_east")};
        const double ourRise =
            rise < midnight ? sunDay(noon + 86400, site).sunriseUtc - 86400 : day.sunriseUtc;
        const double ourSet =
            set >= midnight + 86400 ? sunDay(noon - 86400, site).sunsetUtc + 86400 : day.sunsetUtc;
        // Its single step of interpolation is coarse where the sun sinks slowly: 98 s at 78 degrees south.
        const double tolerance = std::abs(latitude) > 70 ? 120.0 : std::abs(latitude) > 60 ? 15.0 : 2.0;
        EXPECT_NEAR(ourRise, rise, tolerance);
        EXPECT_NEAR(ourSet, set, tolerance);
        worst = std::max({worst, std::abs(ourRise - rise), std::abs(ourSet - set)});
        EXPECT_NEAR(sunPosition(day.sunriseUtc, {latitude, table.number(i, "lon_deg_east")}).trueAltitudeDeg,
                    -0.8333,
                    0.003); // parallax, 0.0024 degrees
    }
    RecordProperty("worst_seconds", std::to_string(worst));
}

TEST(SunDay, polar_day_and_night_are_told_apart) {
    const Site tromso{69.68, 18.92};
    EXPECT_EQ(sunDay(utcOf("2026-06-21T12:00Z"), tromso).kind, DayKind::alwaysUp);
    EXPECT_EQ(sunDay(utcOf("2026-12-21T12:00Z"), tromso).kind, DayKind::alwaysDown);
    EXPECT_EQ(sunDay(utcOf("2026-12-21T12:00Z"), {-77.85, 166.67}).kind, DayKind::alwaysUp);
    EXPECT_EQ(sunDay(utcOf("2026-06-21T12:00Z"), {90, 0}).kind, DayKind::alwaysUp);
}

TEST(SolarTime, noon_is_the_transit_and_hours_are_fifteen_degrees) {
    const Site albany{42.73, -73.68};
    for (const char* text : {"2026-03-21T12:00solar", "2026-06-21T08:30solar", "2026-11-03T17:00solar",
                             "2026-12-31T23:59solar", "2026-01-01T00:00solar"}) {
        const Moment moment = parseTime(text, "test");
        const SunPosition sun = sunPosition(utcSeconds(moment, albany.longitudeDeg), albany);
        EXPECT_LT(angleBetween(sun.hourAngleDeg, (moment.second - 43200) / 240), 1e-8)
            << text; // 2 us of clock
    }
    const double noon = utcSeconds(parseTime("2026-03-21T12:00solar", "test"), albany.longitudeDeg);
    EXPECT_NEAR(noon, sunDay(noon, albany).transitUtc, 1e-4);
    EXPECT_NEAR(sunPosition(noon, albany).azimuthDeg, 180, 1e-3);
}

TEST(SolarTime, an_instant_reads_back_as_the_same_solar_moment) {
    for (const double longitude : {-179.9, -73.68, 0.0, 100.0, 179.9})
        for (const char* text : {"2024-02-29T00:00solar", "2026-03-21T13:00solar",
                                 "2026-11-03T23:59:59.5solar", "2026-01-01T00:00:01solar"}) {
            const Moment moment = parseTime(text, "test");
            const Moment back = solarMoment(utcSeconds(moment, longitude), longitude);
            EXPECT_TRUE(back.solar);
            EXPECT_NEAR(clockSeconds(back), clockSeconds(moment), 1e-5) << text << " at " << longitude;
        }
}

TEST(SunPosition, equinox_solstice_and_equator_are_as_they_must_be) {
    // The equinox of 2026: 20 March 14:46 UTC (published to the minute; the sun crosses at 0.0165 degrees an
    // hour).
    EXPECT_NEAR(sunPosition(utcOf("2026-03-20T14:46Z"), {0, 0}).declinationDeg, 0, 0.0165 / 60 * 1.5);
    EXPECT_NEAR(sunPosition(utcOf("2026-06-21T08:24Z"), {0, 0}).declinationDeg, 23.436,
                0.003); // mean obliquity; nutation moves it by 0.0026
    // Mirrored latitudes have mirrored noons: altitudes differ from 90 - |lat -+ decl| by refraction and
    // parallax only.
    const double noon = utcSeconds(parseTime("2026-06-21T12:00solar", "test"), 10);
    EXPECT_NEAR(sunPosition(noon, {40, 10}).trueAltitudeDeg, 90 - 40 + 23.437, 0.004);
    EXPECT_NEAR(sunPosition(noon, {-40, 10}).trueAltitudeDeg, 90 - 40 - 23.437, 0.004);
    // At the poles azimuth is conventional but everything stays finite.
    EXPECT_TRUE(std::isfinite(sunPosition(noon, {90, 0}).azimuthDeg));
    EXPECT_TRUE(std::isfinite(sunPosition(noon, {-90, 0}).altitudeDeg));
}

} // namespace
} // namespace heliodon::daylight
