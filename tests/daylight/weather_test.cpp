#include "compute/daylight/weather.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include <gtest/gtest.h>

#include "compute/daylight/epw.h"
#include "compute/daylight/frame.h"
#include "geometry/input_error.h"
#include "tests/daylight/csv.h"
#include "tests/daylight/weather_file.h"

namespace heliodon::daylight {
namespace {

using test::refusalOf;
using test::TemporaryFile;
using test::weatherOf;

const std::string kHeader =
    "LOCATION,Washington, DC,DC,USA,TMY3,724050,38.87,-77.03,-5.0,1.0\r\nDESIGN CONDITIONS,0\r\n"
    "COMMENTS 1,made by a test\r\nCOMMENTS 2,\r\n";

std::string periods(const char* first, const char* last, int perHour = 1) {
    return "DATA PERIODS,1," + std::to_string(perHour) + ",Data,Sunday, " + first + "," + last + "\r\n";
}

struct Row {
    int month = 6, day = 1, hour = 1;
    const char* global = "0";
    const char* direct = "0";
    const char* diffuse = "0";
    const char* dewPoint = "7.0";
};

std::string text(const Row& r) {
    return "1999," + std::to_string(r.month) + "," + std::to_string(r.day) + "," + std::to_string(r.hour) +
           ",60,?9?9,15.0," + r.dewPoint + ",87,101300,0,0,305," + r.global + "," + r.direct + "," +
           r.diffuse + ",0,0,0,0,130,2.6,4,4,24.1,77777,9\r\n";
}

// Days of 24 rows, equal but for the light, which is there from 7 to 18 o'clock; what is missing is so by
// night, too.
std::string days(int month, int first, int last, Row row = {}) {
    std::string all;
    row.month = month;
    const Row day = row;
    for (row.day = first; row.day <= last; ++row.day)
        for (row.hour = 1; row.hour <= 24; ++row.hour) {
            const auto at = [&](const char* value) {
                return (row.hour < 8 || row.hour > 18) && *value != 0 && std::strlen(value) < 4 ? "0" : value;
            };
            row.global = at(day.global), row.direct = at(day.direct), row.diffuse = at(day.diffuse);
            all += text(row);
        }
    return all;
}

TEST(Weather, reads_a_year_of_tmy3) {
    const Weather w = readWeather(test::dataFile("chicago_tmy3.epw.gz"));
    EXPECT_EQ(w.place, "Chicago Ohare Intl Ap, IL, USA");
    EXPECT_EQ(w.hours.size(), 8760u);
    EXPECT_DOUBLE_EQ(w.site.latitudeDeg, 41.98);
    EXPECT_DOUBLE_EQ(w.timeZoneHours, -6);
    EXPECT_TRUE(w.warnings.empty()) << w.warnings[0];
    EXPECT_EQ(w.hours[12].clockHour, 12.5);
    double direct = 0, diffuse = 0;
    for (const auto& h : w.hours) {
        direct += h.irradiance.directNormal;
        diffuse += h.irradiance.diffuseHorizontal;
    }
    // Sums over the file's columns 15 and 16.
    double expectedDirect = 0, expectedDiffuse = 0;
    size_t number = 0;
    for (const auto& line : test::split(test::readAll(test::dataFile("chicago_tmy3.epw.gz")), '\n'))
        if (++number > 8 && !line.empty()) {
            const auto cells = test::split(line, ',');
            expectedDirect += std::stod(cells[14]);
            expectedDiffuse += std::stod(cells[15]);
        }
    EXPECT_DOUBLE_EQ(direct, expectedDirect);
    EXPECT_DOUBLE_EQ(diffuse, expectedDiffuse);
}

// The direct sun on a desk by the window of the stored office, open window: Radiance's gendaymtx made it with
// its own, simpler sun. Put in our chain that sun reproduces it to rounding; with the exact sun the
// difference is that formula's error.
TEST(Weather, direct_sun_of_a_year_is_that_of_gendaymtx) {
    const test::Csv table("direct_sun_lux_open.csv.gz");
    std::map<std::string, double> expected;
    for (const auto& row : table.rows) {
        double most = 0;
        for (size_t k = 3; k < row.size(); ++k) most = std::max(most, std::stod(row[k]));
        expected[row[0] + "," + row[1] + "," + row[2]] = most;
    }
    const Weather w = readWeather(test::dataFile("chicago_tmy3.epw.gz"));
    double simpleSquares = 0, exactSquares = 0;
    size_t n = 0;
    for (const auto& h : w.hours) {
        char key[32];
        std::snprintf(key, sizeof key, "%d,%d,%g", h.date.month, h.date.day, h.clockHour);
        const auto row = expected.find(key);
        if (row == expected.end() || row->second < 2000) continue; // rounded to a lux
        WeatherHour simple = h;
        const double jd = dayOfYear({2001, h.date.month, h.date.day}), latitude = radians(41.98);
        const double declination = 0.4093 * std::sin(2 * kPi / 365 * (jd - 81));
        const double solar = h.clockHour + 0.170 * std::sin(4 * kPi / 373 * (jd - 80)) -
                             0.129 * std::sin(2 * kPi / 355 * (jd - 8)) + 12 / kPi * radians(90 - 87.92);
        simple.sun.altitudeDeg =
            degrees(std::asin(std::sin(latitude) * std::sin(declination) -
                              std::cos(latitude) * std::cos(declination) * std::cos(solar * kPi / 12)));
        const double angle = 2 * kPi / 365 * (jd - 1);
        simple.sun.earthSunAu =
            1 / std::sqrt(1.00011 + 0.034221 * std::cos(angle) + 0.00128 * std::sin(angle) +
                          0.000719 * std::cos(2 * angle) + 0.000077 * std::sin(2 * angle));
        const double a = directHorizontalIlluminance(skyOfHour(simple)) / row->second - 1;
        const double b = directHorizontalIlluminance(skyOfHour(h)) / row->second - 1;
        simpleSquares += a * a;
        exactSquares += b * b;
        ++n;
    }
    ASSERT_GT(n, 1500u);
    EXPECT_LT(std::sqrt(simpleSquares / static_cast<double>(n)), 3e-4);
    EXPECT_LT(std::sqrt(exactSquares / static_cast<double>(n)), 0.035); // half a degree of sun
}

TEST(Weather, an_irradiance_offset_stated_in_a_comment_is_believed) {
    const Weather w = readWeather(test::dataFile("pvgis_45N_8E.epw.gz"));
    ASSERT_EQ(w.warnings.size(), 2u);
    EXPECT_NE(w.warnings[1].find("2 days have no light at all"), std::string::npos); // 17 and 18 May 2008
    EXPECT_NEAR(w.sunShiftHours, -0.8239 + 0.5, 1e-12);
    // The three irradiances close with that sun: GHI = DNI sin h + DHI, each rounded to 0.01 W/m2.
    double squares = 0;
    size_t n = 0;
    for (const auto& h : w.hours) {
        if (h.irradiance.directNormal < 200) continue;
        const double implied =
            (h.globalHorizontal - h.irradiance.diffuseHorizontal) / h.irradiance.directNormal;
        squares += std::pow(implied - std::sin(radians(h.sun.trueAltitudeDeg)), 2);
        ++n;
    }
    EXPECT_LT(std::sqrt(squares / static_cast<double>(n)), 0.006); // 0.06 with the plain convention
}

TEST(Weather, sky_between_records_is_interpolated_and_at_their_middle_is_theirs) {
    for (const char* name : {"chicago_tmy3.epw.gz", "pvgis_45N_8E.epw.gz"}) {
        const Weather w = readWeather(test::dataFile(name));
        for (size_t i = 4000; i < 4024; ++i) {
            const Sky own = skyOfHour(w.hours[i]);
            const auto at = skyAt(w, w.hours[i].utc);
            ASSERT_TRUE(at);
            EXPECT_NEAR(at->sun.normalIlluminance, own.sun.normalIlluminance,
                        1e-6 * own.sun.normalIlluminance);
            EXPECT_NEAR(at->ground.luminance, own.ground.luminance, 1e-6 * own.ground.luminance);
            // No jump where one record hands over to the next.
            const double border = w.hours[i].utc + 1800;
            const double before = globalHorizontalIlluminance(*skyAt(w, border - 0.01)),
                         after = globalHorizontalIlluminance(*skyAt(w, border + 0.01));
            EXPECT_NEAR(before, after, 1e-3 * (before + 1));
        }
        // Another year, its leap day included.
        EXPECT_TRUE(skyAt(w, clockSeconds(parseTime("2024-02-29T18:00Z", ""))));
        EXPECT_GT(globalHorizontalIlluminance(*skyAt(w, clockSeconds(parseTime("2030-07-01T16:00Z", "")))),
                  1000);
    }
}

TEST(Weather, accepts_the_oddities_of_real_files) {
    const Weather w = weatherOf("\xef\xbb\xbf" + kHeader + "# a comment\r\n\r\n" + periods("6/ 1", "6/ 2") +
                                "\n" + days(6, 1, 2) + "\x1a");
    EXPECT_EQ(
        w.place,
        "Washington, DC, DC"); // the comma in its name shifts the fields; the numbers count from the end
    EXPECT_EQ(w.hours.size(), 48u);
    EXPECT_DOUBLE_EQ(w.site.longitudeDeg, -77.03);
    // A leap day is taken where it is there and not missed where it is not.
    EXPECT_EQ(weatherOf(kHeader + periods("2/27", "3/1") + days(2, 27, 28) + days(3, 1, 1)).hours.size(),
              72u);
    EXPECT_EQ(weatherOf(kHeader + periods("2/27", "3/1") + days(2, 27, 29) + days(3, 1, 1)).hours.size(),
              96u);
    const std::string toLeapDay = kHeader + periods("2/27", "2/29") + days(2, 27, 28);
    EXPECT_EQ(weatherOf(toLeapDay).hours.size(), 48u);
    EXPECT_EQ(weatherOf(toLeapDay + days(2, 29, 29)).hours.size(), 72u);
    // A winter over New Year.
    EXPECT_EQ(weatherOf(kHeader + periods("12/31", "1/1") + days(12, 31, 31) + days(1, 1, 1)).hours.size(),
              48u);
    // Hours from 0 to 23.
    std::string zeroBased;
    for (int h = 0; h < 24; ++h) zeroBased += text({6, 1, h});
    const Weather shifted = weatherOf(kHeader + periods("6/1", "6/1") + zeroBased);
    EXPECT_EQ(shifted.hours[0].clockHour, 0.5);
    EXPECT_EQ(shifted.warnings.size(), 1u);
    // The clock at the end of each hour, over the leap day and New Year.
    const auto clockDays = [](int month, int day, int nextMonth, int nextDay, int last) {
        std::string all;
        for (int h = 1; h <= 23; ++h) all += text({month, day, h});
        return all + text({nextMonth, nextDay, last});
    };
    for (const std::string& rolling : {periods("2/28", "3/1") + clockDays(2, 28, 2, 29, 0) +
                                           clockDays(2, 29, 3, 1, 0) + clockDays(3, 1, 3, 2, 0),
                                       periods("2/27", "3/1") + clockDays(2, 27, 2, 28, 0) +
                                           clockDays(2, 28, 3, 1, 0) + clockDays(3, 1, 3, 2, 0),
                                       periods("12/30", "1/1") + clockDays(12, 30, 12, 31, 0) +
                                           clockDays(12, 31, 1, 1, 0) + clockDays(1, 1, 1, 2, 0)}) {
        const Weather clock = weatherOf(kHeader + rolling);
        ASSERT_EQ(clock.hours.size(), 72u);
        for (size_t h = 0; h < 72; ++h)
            EXPECT_EQ(clock.hours[h].clockHour, static_cast<double>(h % 24) + 0.5);
        EXPECT_EQ(clock.warnings.size(), 1u);
    }
    // The same of half hours, midnight as 24 or 0; and hours written as a clock has them.
    for (const bool rolls : {false, true}) {
        std::string halves, hours = periods("6/1", "6/1", 2);
        for (int half = 1; half <= 48; ++half) {
            const bool midnight = half == 48 && rolls;
            halves += "1999,6," + std::to_string(midnight ? 2 : 1) + "," +
                      std::to_string(midnight ? 0 : half / 2) + "," + (half % 2 ? "30" : "0") +
                      ",?9?9,15,7,87,101300,0,0,305,0,0,0,0,0,0,0,130,2.6,4,4,24.1,77777,9\n";
        }
        const Weather clock = weatherOf(kHeader + hours + halves);
        ASSERT_EQ(clock.hours.size(), 48u);
        for (size_t h = 0; h < 48; ++h)
            EXPECT_EQ(clock.hours[h].clockHour, 0.5 * static_cast<double>(h) + 0.25);
    }
    std::string colons = days(6, 1, 1);
    for (size_t at = 0; (at = colons.find(",60,?", at)) != std::string::npos; at += 6)
        colons.insert(at, ":00");
    EXPECT_EQ(weatherOf(kHeader + periods("6/1", "6/1") + colons).hours.size(), 24u);
    // Four records an hour.
    std::string quarters;
    for (int h = 1; h <= 24; ++h)
        for (int q = 0; q < 4; ++q) quarters += text({6, 1, h});
    const Weather fine = weatherOf(kHeader + periods("6/1", "6/1", 4) + quarters);
    EXPECT_EQ(fine.hours.size(), 96u);
    EXPECT_DOUBLE_EQ(fine.hours[1].clockHour, 0.375);
    EXPECT_DOUBLE_EQ(fine.hours[1].utc - fine.hours[0].utc, 900);
}

TEST(Weather, accepts_what_spreadsheets_and_old_editors_make_of_files) {
    const std::string records = periods("6/1", "6/1") + days(6, 1, 1);
    EXPECT_EQ(weatherOf(kHeader + records + ",,,,\r\n , ,\r\n").hours.size(), 24u);
    std::string mac = kHeader + records;
    std::erase(mac, '\n');
    EXPECT_EQ(weatherOf(mac).hours.size(), 24u);
    EXPECT_EQ(weatherOf("LOCATION,Malm\xf6 \x96 Lund,-,SWE,a,b,38.87,-77.03,-5.0,1.0\n" + records).place,
              "Malm\xc3\xb6 \xe2\x80\x93 Lund, SWE"); // Windows-1252
    const Weather flat = weatherOf("LOCATION,a,b,c,d,e,38.87,-77.03,-5.0,\n" + records);
    EXPECT_EQ(flat.elevationM, 0);
    ASSERT_EQ(flat.warnings.size(), 1u);
    EXPECT_NE(flat.warnings[0].find("elevation"), std::string::npos);
    EXPECT_NE(refusalOf("PK\x03\x04 and more").find("zip"), std::string::npos);
    EXPECT_NE(refusalOf("\xff\xfeL").find("UTF-16"), std::string::npos);
    std::string low = kHeader + records, semicolons = low;
    low.replace(low.find("LOCATION"), 8, "Location").replace(low.find("DATA PERIODS"), 12, "data periods");
    EXPECT_EQ(weatherOf(low).hours.size(), 24u);
    std::ranges::replace(semicolons, ',', ';');
    EXPECT_EQ(refusalOf(semicolons), ":1: has ';' between its fields, expected commas");
    std::ranges::replace(semicolons, ';', '\t');
    EXPECT_EQ(refusalOf(semicolons), ":1: has tabs between its fields, expected commas");
}

// What cannot be read is a whole year's: files are that as a rule.
TEST(Weather, reads_the_dates_of_periods_as_spreadsheets_write_them) {
    for (const auto& [first, last] : {std::pair{"6/1", "6/2"},
                                      {"06/01/2003", "06/02/2003"},
                                      {"6/1/2003 0:00", "6/2/2003 23:00"},
                                      {"1-Jun", "2-JUN"},
                                      {"Jun-01", "Jun-02"},
                                      {"1 June", "2 June"},
                                      {"152", "153"}})
        EXPECT_EQ(weatherOf(kHeader + periods(first, last) + days(6, 1, 2)).hours.size(), 48u) << first;
    for (const auto& [first, last] : {std::pair{"6/1", "6/31"}, {"6/1", "?"}, {"", "6/2"}, {"0", "6/2"}})
        EXPECT_EQ(refusalOf(kHeader + periods(first, last) + days(6, 1, 2)),
                  ":6: is 6/1 hour 1, expected 1/1 hour 1 (a whole year, since DATA PERIODS, line 5, could "
                  "not be read)")
            << first << " to " << last;
    // Nor is one period of two left out.
    EXPECT_NE(refusalOf(kHeader + "DATA PERIODS,2,1,A,Sunday,6/1,6/1,B,Sunday,6/2,\n" + days(6, 1, 2))
                  .find("line 5, could not be read"),
              std::string::npos);
}

// Neighbours on the clock, not in the file: the record after the last of a period is not the next period's.
TEST(Weather, sky_is_not_interpolated_between_days_far_apart) {
    std::string records = "DATA PERIODS,3,1,A,Sunday,12/31,12/31,B,Sunday,6/1,6/1,C,Sunday,1/1,1/1\n";
    for (const Row day : {Row{12, 31, 1, "800", "700", "150"}, {6, 1, 1}, {1, 1, 1, "400", "300", "100"}})
        for (Row row = day; row.hour <= 24; ++row.hour) records += text(row);
    std::string farEast = kHeader; // noon at midnight
    farEast.replace(farEast.find("-77.03,-5.0"), 11, "-77.03,7.00");
    const Weather w = weatherOf(farEast + records);
    const auto direct = [&](const char* time) {
        const double utc = clockSeconds(parseTime(time, ""));
        return skyAt(w, utc)->sun.normalIlluminance / skyAt(w, w.hours[23].utc)->sun.normalIlluminance;
    };
    EXPECT_NEAR(direct("2026-12-31T23:59:59.9+07:00"), 500.0 / 700,
                0.02); // half way to 1 January; the efficacy moves with it
    EXPECT_NEAR(direct("2027-01-01T00:00:00.1+07:00"), 500.0 / 700, 0.02);
    EXPECT_NEAR(direct("2026-12-31T23:30+07:00"), 1, 0.01);
    EXPECT_EQ(direct("2026-06-01T00:01+07:00"), 0);
    EXPECT_FALSE(skyAt(w, clockSeconds(parseTime("2026-06-02T00:01+07:00", ""))));
}

// Files of spreadsheets have nothing where others have 9999.
TEST(Weather, a_blank_cell_is_a_missing_value) {
    const std::string head = kHeader + periods("6/1", "6/2") + days(6, 1, 1, {6, 1, 1, "800", "700", "150"});
    for (const Row& gap : {Row{6, 1, 1, "", "700", "150"},
                           {6, 1, 1, "800", "", "150"},
                           {6, 1, 1, "800", "700", ""},
                           {6, 1, 1, "", "", ""},
                           {6, 1, 1, "800", "700", "150", ""}}) {
        Row missing = gap;
        for (const char** cell : {&missing.global, &missing.direct, &missing.diffuse})
            if (**cell == 0) *cell = "9999";
        if (*missing.dewPoint == 0) missing.dewPoint = "99.9";
        const Weather blank = weatherOf(head + days(6, 2, 2, gap)),
                      nines = weatherOf(head + days(6, 2, 2, missing));
        ASSERT_EQ(blank.hours.size(), 48u);
        EXPECT_EQ(blank.warnings, nines.warnings);
        for (size_t h = 24; h < 48; ++h) {
            EXPECT_EQ(blank.hours[h].irradiance.directNormal, nines.hours[h].irradiance.directNormal);
            EXPECT_EQ(blank.hours[h].irradiance.diffuseHorizontal,
                      nines.hours[h].irradiance.diffuseHorizontal);
            EXPECT_EQ(blank.hours[h].precipitableWaterCm, nines.hours[h].precipitableWaterCm);
        }
    }
    EXPECT_EQ(refusalOf(kHeader + periods("6/1", "6/2") + days(6, 1, 2, {6, 1, 1, "", "", ""})).substr(0, 5),
              ":11: ");
}

TEST(Weather, fills_gaps_and_says_so) {
    const auto noon = [](const Weather& w, int day) { return w.hours[static_cast<size_t>(day * 24 + 12)]; };
    const Row full{6, 1, 1, "800", "700", "150"};
    const std::string head = kHeader + periods("6/1", "6/2");
    {
        const Weather w =
            weatherOf(head + days(6, 1, 1, full) + days(6, 2, 2, {6, 1, 1, "800", "9999", "150"}));
        EXPECT_NEAR(noon(w, 1).irradiance.directNormal, 650 / std::sin(radians(noon(w, 1).sun.altitudeDeg)),
                    1e-9);
        ASSERT_EQ(w.warnings.size(), 1u);
        EXPECT_NE(w.warnings[0].find("derived"), std::string::npos);
    }
    {
        const Weather w =
            weatherOf(head + days(6, 1, 1, full) + days(6, 2, 2, {6, 1, 1, "800", "700", "9999"}));
        EXPECT_NEAR(noon(w, 1).irradiance.diffuseHorizontal,
                    800 - 700 * std::sin(radians(noon(w, 1).sun.altitudeDeg)), 1e-9);
    }
    {
        // Global alone: Erbs keeps the sum.
        const Weather w =
            weatherOf(head + days(6, 1, 1, full) + days(6, 2, 2, {6, 1, 1, "500", "9999", "9999"}));
        const WeatherHour h = noon(w, 1);
        EXPECT_NEAR(h.irradiance.directNormal * std::sin(radians(h.sun.altitudeDeg)) +
                        h.irradiance.diffuseHorizontal,
                    500, 1e-6);
        EXPECT_GT(h.irradiance.diffuseHorizontal, 100);
    }
    {
        const Weather w =
            weatherOf(head + days(6, 1, 1, full) + days(6, 2, 2, {6, 1, 1, "9999", "9999", "9999", "99.9"}));
        EXPECT_EQ(noon(w, 1).irradiance.directNormal, 700);
        EXPECT_TRUE(noon(w, 1).filled);
        EXPECT_EQ(w.warnings.size(), 2u); // irradiance and dew point
    }
    {
        // None within a week of the 9th, all of the 1st: what is borrowed is a day's light, not a night's.
        const Row none{6, 1, 1, "999900", "999900", "999900"};
        const Weather w =
            weatherOf(kHeader + periods("6/1", "6/10") + days(6, 1, 1, full) + days(6, 2, 10, none));
        EXPECT_EQ(noon(w, 7).irradiance.directNormal, 700);
        EXPECT_EQ(noon(w, 8).irradiance.diffuseHorizontal, 0);
        ASSERT_EQ(w.warnings.size(), 2u);
        EXPECT_NE(w.warnings[1].find("dark"), std::string::npos);
        // A file that is dark by day is none.
        EXPECT_EQ(refusalOf(head + days(6, 1, 2, none)).substr(0, 24), ":11: neither this record");
        EXPECT_EQ(refusalOf(head + days(6, 1, 2, {6, 1, 1, "9999", "700", "9999"})).substr(0, 4), ":11:");
    }
}

// The sun of the file's place at the file's clock shines at night where the time zone is another's.
TEST(Weather, sun_below_the_horizon_asks_for_the_time_zone) {
    const std::string records = periods("6/1", "6/2") + days(6, 1, 2, {6, 1, 1, "800", "700", "150"});
    EXPECT_TRUE(weatherOf(kHeader + records).warnings.empty());
    std::string wrong = kHeader;
    wrong.replace(wrong.find("-5.0"), 4, "5.0");
    const TemporaryFile file(wrong + records);
    const Weather w = readWeather(file.path());
    ASSERT_EQ(w.warnings.size(), 1u);
    EXPECT_TRUE(w.warnings[0].starts_with(file.path() + ": ")) << w.warnings[0];
    EXPECT_NE(w.warnings[0].find("while it is below the horizon"), std::string::npos) << w.warnings[0];
    EXPECT_NE(w.warnings[0].find("+5 h at longitude -77.03"), std::string::npos) << w.warnings[0];
    // So does the sky.
    std::string night = records;
    const std::string dark = text({6, 2, 2}), glow = text({6, 2, 2, "30", "0", "30"});
    night.replace(night.find(dark), dark.size(), glow);
    const Weather lit = weatherOf(kHeader + night);
    ASSERT_EQ(lit.warnings.size(), 1u);
    EXPECT_NE(lit.warnings[0].find("1 of 48 records have light"), std::string::npos) << lit.warnings[0];
    EXPECT_TRUE(skyOfHour(lit.hours[25]).isDark());
}

// Files without direct or diffuse light have zeros there as often as 9999: a year would be dark without a
// word.
TEST(Weather, components_that_do_not_add_up_to_the_global_are_named) {
    const std::string head = kHeader + periods("6/1", "6/30");
    const auto warningOf = [&](const char* global, const char* direct, const char* diffuse) {
        const auto all = weatherOf(head + days(6, 1, 30, {6, 1, 1, global, direct, diffuse})).warnings;
        return all.empty() ? "none" : all.back();
    };
    EXPECT_NE(warningOf("500", "0", "0").find("in 1 month: 0 against 165 kWh/m2 in month 6"),
              std::string::npos)
        << warningOf("500", "0", "0");
    EXPECT_NE(warningOf("500", "0", "200").find("in 1 month: 66 against 165"), std::string::npos);
    EXPECT_EQ(warningOf("500", "0", "480"), "none");
    EXPECT_NE(warningOf("0", "0", "0").find("all is dark"), std::string::npos);
}

// Days that nobody measured have zeros in some files.
TEST(Weather, days_without_any_light_are_named) {
    const Row sunny{6, 1, 1, "800", "700", "150"};
    const auto warnings = [&](const Row& row) {
        return weatherOf(kHeader + periods("6/1", "6/4") + days(6, 1, 1, sunny) + days(6, 2, 3, row) +
                         days(6, 4, 4, sunny))
            .warnings;
    };
    const std::vector<std::string> dark = warnings({});
    ASSERT_EQ(dark.size(), 1u);
    EXPECT_NE(dark[0].find("2 days have no light at all, the first from line 30 on"), std::string::npos)
        << dark[0];
    EXPECT_TRUE(warnings({6, 1, 1, "3", "0", "3"}).empty());
    const Weather kilowatts =
        weatherOf(kHeader + periods("6/1", "6/2") + days(6, 1, 2, {6, 1, 1, "0.8", "0.7", ".15"}));
    ASSERT_FALSE(kilowatts.warnings.empty());
    EXPECT_NE(kilowatts.warnings.back().find("in W/m2?"), std::string::npos) << kilowatts.warnings.back();
}

// Small negative numbers are noise of the night; where global less diffuse says sun, it is taken from there.
TEST(Weather, negative_direct_sun_that_the_others_refute_is_missing) {
    const std::string head = kHeader + periods("6/1", "6/2");
    const Weather w = weatherOf(head + days(6, 1, 1, {6, 1, 1, "800", "700", "150"}) +
                                days(6, 2, 2, {6, 1, 1, "800", "-5", "150"}));
    const WeatherHour noon = w.hours[24 + 12];
    EXPECT_NEAR(noon.irradiance.directNormal, 650 / std::sin(radians(noon.sun.altitudeDeg)), 1e-9);
    EXPECT_TRUE(noon.filled);
    ASSERT_EQ(w.warnings.size(), 2u);
    EXPECT_NE(w.warnings[0].find("11 negative direct irradiances are counted"), std::string::npos)
        << w.warnings[0];
    EXPECT_TRUE(weatherOf(head + days(6, 1, 2, {6, 1, 1, "152", "-5", "150"})).warnings.empty());
}

TEST(Weather, wrong_lines_are_named_by_number) {
    const std::string head = kHeader + periods("6/1", "6/1"); // five lines
    const std::string good = days(6, 1, 1);
    EXPECT_EQ(refusalOf("").substr(0, 11), ": is empty,");
    EXPECT_EQ(refusalOf("hello\n").substr(0, 4), ":1: ");
    EXPECT_EQ(refusalOf("LOCATION,a,b\n").substr(0, 4), ":1: ");
    EXPECT_EQ(refusalOf("LOCATION,a,b,c,d,e,north,-77,-5,1\n").substr(0, 4), ":1: ");
    EXPECT_EQ(refusalOf("LOCATION,a,b,c,d,e,95,-77,-5,1\n").substr(0, 4), ":1: ");
    EXPECT_EQ(refusalOf(kHeader).substr(0, 4), ":4: ");
    EXPECT_EQ(refusalOf(kHeader + good).substr(0, 4), ":5: ");
    EXPECT_EQ(refusalOf(head).substr(0, 4), ":5: ");
    EXPECT_EQ(refusalOf(head + good + text({6, 2, 1})).substr(0, 5), ":30: ");
    EXPECT_EQ(refusalOf(head + text({6, 1, 1}) + text({6, 1, 3})).substr(0, 4), ":7: ");
    EXPECT_EQ(refusalOf(head + text({6, 1, 1, "abc"})).substr(0, 18), ":6: field 14 (glob");
    EXPECT_EQ(refusalOf(head + text({6, 1, 1, "0", "5000"})).substr(0, 18), ":6: field 15 (dire");
    EXPECT_EQ(refusalOf(head + text({6, 1, 1, "0", "nan"})).substr(0, 4), ":6: ");
    EXPECT_EQ(refusalOf(head + text({13, 1, 1})).substr(0, 4), ":6: ");
    EXPECT_EQ(refusalOf(head + text({6, 31, 1})).substr(0, 4), ":6: ");
    EXPECT_EQ(refusalOf(head + "1999,6,1\n").substr(0, 4), ":6: ");
    EXPECT_EQ(refusalOf(kHeader + periods("6/1", "6/1", 7) + good).substr(0, 4), ":5: ");
    std::string halves = head, columns = text({6, 1, 1});
    halves.replace(halves.find(",1,Data"), 2, ",1.5");
    EXPECT_EQ(refusalOf(halves + good).substr(0, 4), ":5: ");
    while (std::ranges::count(columns, ',') < 37) columns.insert(columns.size() - 2, ",0");
    EXPECT_EQ(refusalOf(head + columns), ":6: has 38 fields, expected 35: are there decimal commas?");
    EXPECT_EQ(refusalOf(kHeader + periods("6/1", "6/1", 2) + good),
              ":7: is 6/1 hour 2, expected 6/1 hour 1 (2 records an hour by DATA PERIODS)");
    const std::string february = kHeader + periods("2/28", "3/1") + days(2, 28, 28), leap = days(2, 29, 29);
    EXPECT_EQ(refusalOf(february + leap + leap + days(3, 1, 1)).substr(0, 40),
              ":54: is 2/29 hour 1, expected 3/1 hour 1");
    EXPECT_EQ(refusalOf(kHeader + periods("2/28", "2/29") + days(2, 28, 28) + text({2, 29, 1})),
              ":30: the file ends before 2/29 hour 2 (1 record an hour by DATA PERIODS)");
    EXPECT_EQ(refusalOf(kHeader + periods("2/28", "2/28") + days(2, 28, 28) + leap).substr(0, 5), ":30: ");
    EXPECT_THROW(readWeather("no/such/file.epw"), geometry::InputError);
    EXPECT_THROW(readWeather(testing::TempDir()), geometry::InputError);
}

TEST(Weather, a_file_cut_anywhere_is_refused) {
    const std::string whole = test::readAll(test::dataFile("chicago_tmy3.epw.gz"));
    // Every kilobyte at first, then every 64: each read goes over the whole text before it.
    for (size_t size = 0; size + 1024 < whole.size(); size += size < 64 * 1024 ? 1024 : 64 * 1024) {
        const std::string refusal = refusalOf(whole.substr(0, size));
        ASSERT_NE(refusal, "accepted") << size;
    }
    // The last line without its end is whole; a byte less of its numbers cannot be told, a field less can.
    EXPECT_EQ(refusalOf(whole.substr(0, whole.find_last_not_of("\r\n") + 1)), "accepted");
    std::ifstream in(test::dataFile("pvgis_45N_8E.epw.gz"), std::ios::binary);
    const std::string zipped((std::istreambuf_iterator<char>(in)), {});
    for (const size_t size : {size_t{20}, size_t{1000}, zipped.size() / 2, zipped.size() - 5}) {
        const TemporaryFile file(zipped.substr(0, size), "heliodon_weather_test.epw.gz");
        EXPECT_THROW(readWeather(file.path()), geometry::InputError) << size;
    }
}

TEST(Weather, occupied_hours_are_those_whose_middle_lies_inside) {
    const Weather w = readWeather(test::dataFile("chicago_tmy3.epw.gz"));
    size_t n = 0;
    for (const auto& h : w.hours) n += isOccupied(h);
    EXPECT_EQ(n, 3650u);
}

} // namespace
} // namespace heliodon::daylight
