#include "compute/daylight/time.h"

#include <random>

#include <gtest/gtest.h>

#include "geometry/input_error.h"

namespace heliodon::daylight {
namespace {

TEST(Calendar, days_count_through_leap_years_and_centuries) {
    EXPECT_EQ(daysSinceEpoch({1970, 1, 1}), 0);
    EXPECT_EQ(daysSinceEpoch({2000, 3, 1}), 11017);
    EXPECT_EQ(daysSinceEpoch({1900, 3, 1}) - daysSinceEpoch({1900, 2, 28}), 1);
    EXPECT_EQ(daysSinceEpoch({2000, 3, 1}) - daysSinceEpoch({2000, 2, 28}), 2);
    EXPECT_EQ(dayOfYear({2024, 12, 31}), 366);
    EXPECT_EQ(dayOfYear({2026, 12, 31}), 365);
    for (int64_t day = -800'000; day < 800'000; day += 13) {
        const Date date = dateFromDays(day);
        ASSERT_EQ(daysSinceEpoch(date), day);
        ASSERT_GE(date.day, 1);
        ASSERT_LE(date.day, daysInMonth(date.year, date.month));
    }
}

TEST(ParseTime, reads_offsets_and_solar_time) {
    // 18:00 UTC on 21 March 2026 is 1774116000 s.
    for (const char* text : {"2026-03-21T13:00-05:00", "2026-03-21T18:00Z", "2026-03-21t18:00:00z",
                             "2026-03-21T23:30:00+0530", "2026-03-21T18:00:00,0+00", "2026-03-21 18:00Z"})
        EXPECT_DOUBLE_EQ(clockSeconds(parseTime(text, "--time")), 1774116000.0) << text;
    const Moment solar = parseTime("2026-03-21T13:00solar", "--time");
    EXPECT_TRUE(solar.solar);
    EXPECT_DOUBLE_EQ(solar.second, 13 * 3600);
    EXPECT_EQ(parseTime("2026-12-31T24:00Z", "--time").date, (Date{2027, 1, 1}));
    EXPECT_DOUBLE_EQ(parseTime("2026-03-21T13:00:30.25solar", "--time").second, 13 * 3600 + 30.25);
}

TEST(ParseTime, refuses_what_is_no_time_and_says_why) {
    for (const char* text : {"",
                             "T",
                             "2026",
                             "2026-03-21",
                             "2026-03-21T",
                             "2026-03-21T13",
                             "2026-03-21T13:00",
                             "2026-02-29T00:00Z",
                             "2026-13-01T00:00Z",
                             "2026-00-01T00:00Z",
                             "2026-04-31T00:00Z",
                             "2026-03-21T25:00Z",
                             "2026-03-21T24:01Z",
                             "2026-03-21T13:60Z",
                             "2026-03-21T13:00:60Z",
                             "2026-03-21T13:00Zulu",
                             "2026-03-21T13:00+5",
                             "2026-03-21T13:00+05:0",
                             "2026-03-21T13:00+25:00",
                             "2026-03-21T13:00 solar",
                             "20260321T1300Z",
                             "0000-01-01T00:00Z",
                             "9999-01-01T00:00Z",
                             "-026-03-21T13:00Z",
                             "2026-03-21T13:00:1Z",
                             "2026-03-21T13:00:01.Z",
                             "2026-03-21T13:00solarsolar",
                             "\xff\xfe",
                             "99999999999999999999"}) {
        try {
            parseTime(text, "--time");
            ADD_FAILURE() << "accepted: " << text;
        } catch (const geometry::InputError& e) {
            EXPECT_TRUE(std::string(e.what()).starts_with("--time: '")) << e.what();
        }
    }
}

TEST(ParseTime, survives_any_mutation_of_a_good_text) {
    const std::string good = "2026-03-21T13:00:30.5-05:00";
    std::minstd_rand random(1);
    for (int i = 0; i < 20'000; ++i) {
        std::string text = good.substr(0, random() % (good.size() + 1));
        for (auto k = random() % 3; k > 0 && !text.empty(); --k)
            text[random() % text.size()] = static_cast<char>(random());
        try {
            const Moment m = parseTime(text, "--time");
            ASSERT_GE(m.second, 0);
            ASSERT_LT(m.second, 86400);
        } catch (const geometry::InputError&) {
        }
    }
}

TEST(TimeInWords, reads_as_people_say_it) {
    EXPECT_EQ(timeInWords(parseTime("2026-03-21T13:00solar", "")), "21 March 2026, 13:00 solar time");
    EXPECT_EQ(timeInWords(parseTime("2026-12-01T09:05-05:30", "")), "1 December 2026, 09:05 UTC-05:30");
    EXPECT_EQ(timeInWords(parseTime("2026-05-09T23:59:07.5Z", "")), "9 May 2026, 23:59:07.5 UTC");
    EXPECT_EQ(timeInWords({{2026, 12, 31}, 86399.9999999, true, 0}), "1 January 2027, 00:00 solar time");
}

TEST(FormatTime, parses_back_to_the_same_moment) {
    EXPECT_EQ(formatTime(parseTime("2026-03-21T13:00-05:00", "")), "2026-03-21T13:00:00-05:00");
    EXPECT_EQ(formatTime(parseTime("2026-03-21T13:00:07.5solar", "")), "2026-03-21T13:00:07.5solar");
    EXPECT_EQ(formatTime(momentFromUtc(1774116000.0)), "2026-03-21T18:00:00Z");
    EXPECT_EQ(formatTime({{2026, 12, 31}, 86399.9999999, false, 0}), "2027-01-01T00:00:00Z");
    std::minstd_rand random(2);
    for (int i = 0; i < 2000; ++i) {
        const double utc =
            (static_cast<double>(random()) - 1e9) * 3.7 + 1e-6 * static_cast<double>(random() % 1'000'000);
        const Moment m = momentFromUtc(utc, static_cast<int>(random() % 1800) - 900);
        ASSERT_NEAR(clockSeconds(parseTime(formatTime(m), "")), utc, 2e-6);
    }
}

TEST(Duration, reads_iso_durations) {
    EXPECT_DOUBLE_EQ(parseDuration("PT10M", "").seconds, 600);
    EXPECT_DOUBLE_EQ(parseDuration("P1D", "").seconds, 86400);
    EXPECT_DOUBLE_EQ(parseDuration("PT1H30M", "").seconds, 5400);
    EXPECT_DOUBLE_EQ(parseDuration("P2W", "").seconds, 14 * 86400);
    EXPECT_DOUBLE_EQ(parseDuration("pt0,5s", "").seconds, 0.5);
    EXPECT_EQ(parseDuration("P1M", "").months, 1);
    EXPECT_EQ(parseDuration("P1Y2M3DT4H5M6.5S", "").months, 14);
    EXPECT_DOUBLE_EQ(parseDuration("P1Y2M3DT4H5M6.5S", "").seconds, 3 * 86400 + 4 * 3600 + 5 * 60 + 6.5);
    for (const char* text :
         {"", "P", "PT", "10M", "PT10", "P10", "P1DT", "PT1M1H", "P1H", "PT1D", "PT0S", "P-1D", "PT1.5H30M",
          "P1.5M", "PTM", "P99999999Y", "PT9999999999S", "P1D ", "P1M1M"})
        EXPECT_THROW(parseDuration(text, "--step"), geometry::InputError) << text;
}

TEST(TimeSeries, steps_are_counted_from_the_start) {
    const auto at = [](const char* t) { return parseTime(t, ""); };
    const auto months = timeSeries(at("2024-01-31T12:00solar"), at("2024-05-31T12:00solar"),
                                   parseDuration("P1M", ""), "--step");
    ASSERT_EQ(months.size(), 5u);
    EXPECT_EQ(months[1].date, (Date{2024, 2, 29}));
    EXPECT_EQ(months[2].date, (Date{2024, 3, 31}));
    EXPECT_EQ(months[3].date, (Date{2024, 4, 30}));
    // A tenth of a second a step: no drift over ten thousand.
    EXPECT_EQ(
        timeSeries(at("2026-03-21T00:00Z"), at("2026-03-21T00:16:40Z"), parseDuration("PT0.1S", ""), "--step")
            .size(),
        10'001u);
    EXPECT_EQ(timeSeries(at("2026-03-21T00:00Z"), at("2026-03-21T00:00Z"), parseDuration("P1D", ""), "--step")
                  .size(),
              1u);
    // The ends may have different offsets.
    EXPECT_EQ(timeSeries(at("2026-03-21T00:00Z"), at("2026-03-21T02:00+01:00"), parseDuration("PT30M", ""),
                         "--step")
                  .size(),
              3u);
    EXPECT_THROW(
        timeSeries(at("2026-03-21T00:00Z"), at("2026-03-20T00:00Z"), parseDuration("P1D", ""), "--to"),
        geometry::InputError);
    EXPECT_THROW(
        timeSeries(at("2026-03-21T00:00Z"), at("2026-03-22T00:00solar"), parseDuration("P1D", ""), "--to"),
        geometry::InputError);
    EXPECT_THROW(timeSeries(at("2026-03-21T00:00Z"), at("2027-03-21T00:00Z"), parseDuration("PT1S", ""),
                            "--step", 1000),
                 geometry::InputError);
}

} // namespace
} // namespace heliodon::daylight
