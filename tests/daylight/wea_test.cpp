#include "compute/daylight/wea.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "compute/daylight/weather.h"
#include "tests/daylight/csv.h"
#include "tests/daylight/weather_file.h"

namespace heliodon::daylight {
namespace {

using test::refusalOf;
using test::weatherOf;

const std::string kHead = "place Chicago Ohare_USA\nlatitude 41.98\nlongitude 87.92\ntime_zone 90\n"
                          "site_elevation 201.0\nweather_data_file_units 1\n";

TEST(Wea, is_the_year_of_the_epw_that_it_was_made_from) {
    const Weather epw = readWeather(test::dataFile("chicago_tmy3.epw.gz"));
    std::string text = kHead;
    for (const WeatherHour& h : epw.hours)
        text += fmt::format("{} {} {:.3f} {:.0f} {:.0f}\r\n", h.date.month, h.date.day, h.clockHour,
                            h.irradiance.directNormal, h.irradiance.diffuseHorizontal);
    const Weather wea = weatherOf(text);
    EXPECT_TRUE(wea.warnings.empty()) << wea.warnings[0];
    EXPECT_EQ(wea.place, "Chicago Ohare_USA");
    EXPECT_EQ(wea.site.latitudeDeg, epw.site.latitudeDeg);
    EXPECT_EQ(wea.site.longitudeDeg, epw.site.longitudeDeg);
    EXPECT_EQ(wea.timeZoneHours, epw.timeZoneHours);
    EXPECT_EQ(wea.elevationM, epw.elevationM);
    EXPECT_EQ(wea.recordsPerHour, 1);
    ASSERT_EQ(wea.hours.size(), epw.hours.size());
    for (size_t k = 0; k < epw.hours.size(); ++k) {
        const WeatherHour &a = wea.hours[k], &b = epw.hours[k];
        ASSERT_EQ(a.clockHour, b.clockHour) << k;
        ASSERT_EQ(a.irradiance.directNormal, b.irradiance.directNormal) << k;
        ASSERT_EQ(a.irradiance.diffuseHorizontal, b.irradiance.diffuseHorizontal) << k;
        // Declinations of a day differ by the year's place in the leap cycle, by 0.3 degrees at most.
        ASSERT_NEAR(a.sun.trueAltitudeDeg, b.sun.trueAltitudeDeg, 0.35) << k;
    }
}

TEST(Wea, has_parts_of_hours_some_days_and_leap_days) {
    const Weather w = weatherOf(kHead + "# noon\n2 28 12.250 500 100\n2 28 12.750 510 9999\n\n"
                                        "2 29 11.750 520 120\n2 29 12.250 530 130\n");
    ASSERT_EQ(w.hours.size(), 4u);
    EXPECT_EQ(w.recordsPerHour, 2);
    EXPECT_EQ(w.hours[0].date, (Date{2004, 2, 28}));
    EXPECT_EQ(w.hours[2].date, (Date{2004, 2, 29}));
    EXPECT_EQ(w.hours[2].clockHour, 11.75);
    EXPECT_TRUE(w.hours[1].filled);
    EXPECT_FALSE(w.hours[3].filled);
}

// As they stand, with a warning; 24 o'clock says that records end there.
TEST(Wea, hours_may_be_whole) {
    const std::string day = "6 1 12 800 100\n6 1 12.25 800 100\n6 1 12.5 810 110\n";
    const Weather begins = weatherOf(kHead + day);
    ASSERT_EQ(begins.warnings.size(), 1u);
    EXPECT_EQ(begins.recordsPerHour, 4);
    EXPECT_EQ(begins.hours[1].clockHour, 12.375);
    EXPECT_EQ(begins.sunShiftHours, -0.125);
    const Weather ends = weatherOf(kHead + "6 1 12 800 100\n6 1 13 800 100\n6 1 24 0 0\n");
    EXPECT_EQ(ends.recordsPerHour, 1);
    EXPECT_EQ(ends.hours[0].clockHour, 11.5);
    EXPECT_EQ(ends.hours[2].clockHour, 23.5);
    EXPECT_EQ(ends.sunShiftHours, 0.5);
    for (const Weather& w : {begins, ends})
        EXPECT_EQ(w.hours[0].utc, static_cast<double>(daysSinceEpoch({2001, 6, 1})) * 86400.0 + 18 * 3600.0);
}

// Days of seven hours each: as many records aside as a day has hours there is another hour.
TEST(Wea, missing_values_are_those_of_the_same_hour_of_the_nearest_day) {
    std::string text = kHead;
    for (int day = 1; day <= 9; ++day)
        for (int hour = 8; hour < 15; ++hour)
            text +=
                fmt::format("6 {} {}.5 {} 100\n", day, hour, day == 5 && hour == 12 ? 9999 : 10 * hour + day);
    size_t filled = 0;
    for (const WeatherHour& h : weatherOf(text).hours) {
        if (!h.filled) continue;
        EXPECT_EQ(h.irradiance.directNormal, 124) << h.clockHour; // of 4 June
        ++filled;
    }
    EXPECT_EQ(filled, 1u);
}

TEST(Wea, of_the_sunny_hours_of_a_winter_is_dark_in_its_nights) {
    std::string text = kHead;
    text.replace(text.find("Chicago"), 17, "la Rochelle");
    for (const char* day : {"12 30", "12 31", "1 1", "1 2"})
        for (const char* hour : {"8.50", "12.50", "15.50"}) text += fmt::format("{} {} 300 80\n", day, hour);
    const Weather w = weatherOf(text);
    EXPECT_TRUE(w.warnings.empty()) << w.warnings[0];
    EXPECT_EQ(w.place, "la Rochelle");
    EXPECT_EQ(w.hours.size(), 12u);
    const auto at = [&](const Date& date, double hour) {
        return skyAt(w, static_cast<double>(daysSinceEpoch(date)) * 86400 + (hour + 6) * 3600);
    };
    EXPECT_FALSE(at({2001, 1, 1}, 12.5)->isDark());
    for (const double hour : {0.1, 7.2, 16.9, 23.9}) EXPECT_TRUE(at({2001, 1, 1}, hour)->isDark()) << hour;
    EXPECT_FALSE(at({2001, 1, 1}, 10)) << "a gap by day";
    EXPECT_FALSE(at({2001, 1, 3}, 23)) << "a day that it has not";
}

TEST(Wea, one_of_two_irradiances_is_kept) {
    const Weather w = weatherOf(kHead + "6 1 12.5 9999 40\n6 2 12.5 700 9999\n6 3 12.5 600 90\n");
    EXPECT_EQ(w.hours[0].irradiance.diffuseHorizontal, 40);
    EXPECT_EQ(w.hours[0].irradiance.directNormal, 600);
    EXPECT_EQ(w.hours[1].irradiance.directNormal, 700);
    EXPECT_EQ(w.hours[1].irradiance.diffuseHorizontal, 90);
}

TEST(Wea, days_without_light_are_named_without_fields_of_an_epw) {
    std::string zeros = kHead, faint = kHead;
    for (int day = 1; day <= 9; ++day) {
        zeros += fmt::format("6 {} 12.5 {} {}\n", day, day < 4 ? 0 : 700, day < 4 ? 0 : 100);
        faint += fmt::format("6 {} 12.5 0.7 0.1\n", day);
    }
    const auto warnings = weatherOf(zeros).warnings, units = weatherOf(faint).warnings;
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("3 days have no light at all, the first from line 7 on"), std::string::npos);
    ASSERT_EQ(units.size(), 1u);
    EXPECT_NE(units[0].find("is it in W/m2?"), std::string::npos) << units[0];
}

TEST(Wea, what_is_wrong_is_named_with_its_line) {
    const auto names = [](const std::string& content, const char* expected) {
        const std::string refusal = refusalOf(content);
        EXPECT_TRUE(refusal.starts_with(expected)) << refusal << " for " << expected;
    };
    std::string lux = kHead;
    lux.replace(lux.find("units 1"), 7, "units 3");
    names(lux + "1 1 0.5 0 0\n", ":6: weather_data_file_units is 3, expected 1 ");
    names("place Somewhere\nlatitude 40\n", ":2: the file ends before 'longitude'");
    names("place Somewhere\nlongitude 40\n", ":2: expected 'latitude'");
    names("place Somewhere\nlatitude 95\n", ":2: latitude is '95'");
    names(kHead, ":6: the file ends before a record");
    names(kHead + "1 1 0.5 0\n", ":7: has 4 numbers");
    names(kHead + "13 1 0.5 0 0\n", ":7: month is '13'");
    names(kHead + "2 30 0.5 0 0\n", ":7: day is '30'");
    names(kHead + "6 1 12 800 100\n6 1 13.1 800 100\n", ":8: hour is 13.1, expected 12 and");
    names(kHead + "6 1 12.3 800 100\n6 1 13.3 800 100\n", ":7: hour is 12.3, expected 12.5 and");
    names(kHead + "6 1 12.5 8000 100\n", ":7: direct normal irradiance is 8000 W/m2");
    names(kHead + "6 1 12.5 800 x\n", ":7: diffuse horizontal irradiance is 'x'");
    names("place Somewhere\nlatitude 41.9 S\n", ":2: has 'S' after its value");
    names(kHead + "6 1 12.5 9999 100\n", ":7: neither this record nor any other by day has both direct and");
    names(kHead + "12 31 12.5 8 1\n1 1 12.5 8 1\n12 31 12.5 8 1\n", ":9: does not follow");
    names(kHead + "6 2 12.5 800 100\n6 1 12.5 800 100\n", ":8: does not follow");
}

} // namespace
} // namespace heliodon::daylight
