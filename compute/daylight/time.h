// Dates, clock times and durations as users write them (ISO 8601), with calendar arithmetic in the proleptic
// Gregorian calendar. Instants are UTC seconds since 1970-01-01T00:00Z without leap seconds (UT1 is taken as
// UTC: within 0.9 s).
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace heliodon::daylight {

struct Date {
    int year = 2026, month = 3, day = 21; // month 1..12, day 1..31
    auto operator<=>(const Date&) const = default;
};

int daysInMonth(int year, int month);
int dayOfYear(const Date& date); // 1..366
// 1970-01-01 is 0; a day past the month's end runs on into the next month.
int64_t daysSinceEpoch(const Date& date);
Date dateFromDays(int64_t daysSinceEpoch);

// A time of day on a date, on a clock with a fixed offset from UTC or on the sun's own clock: local apparent
// solar time, whose 12:00 is the sun's transit. The latter becomes an instant only with a longitude:
// utcSeconds in sun_position.h.
struct Moment {
    Date date;
    double second = 13 * 3600.0; // of the day, [0, 86400)
    bool solar = true;
    int offsetMinutes = 0; // east of Greenwich positive; 0 when solar
};

// Calendar months and seconds kept apart, since months differ in length. A day is 86400 s.
struct Duration {
    int months = 0;
    double seconds = 0;
};

// "2026-03-21T13:00-05:00", "...T13:00:30.5Z", "...T13:00solar"; "+0530" and "+05" are offsets too; 24:00 is
// the next day's 00:00. A clock time without offset is refused: it would mean a different sun on every
// machine. Throws InputError(source, "", ...), `source` naming where the text came from ("--time").
Moment parseTime(std::string_view text, const std::string& source);

// "PT10M", "P1D", "PT1H30M", "P1M", "P2W", "PT0.5S"; positive. The last number may have a decimal fraction,
// except of years and months. Throws InputError(source, "", ...).
Duration parseDuration(std::string_view text, const std::string& source);

// Text that parses back to the same value; seconds to the microsecond, left out below none ("13:00:00").
std::string formatTime(const Moment& moment);
// For readers: "21 March 2026, 13:00 solar time", "..., 13:00 UTC-05:00"; seconds where there are any.
std::string timeInWords(const Moment& moment);
std::string monthName(int month); // 1..12, "January"

// start + count steps on the start's own clock. Months count from the start, so that 31 January + 2 x P1M is
// 31 March; a day that the month lacks becomes its last.
Moment advance(const Moment& start, const Duration& step, int64_t count = 1);

// from, from + step, ... up to and including `to` where it is hit (within 1 ms). Throws InputError(source,
// "", ...) when the clocks differ in kind, `to` lies before `from`, or more than `limit` moments would
// result.
std::vector<Moment> timeSeries(const Moment& from, const Moment& to, const Duration& step,
                               const std::string& source, size_t limit = 10'000'000);

// Seconds since the epoch as this clock counts them: for a clock with an offset the UTC instant, for the
// sun's clock its own reading (good for comparing two moments at one place).
double clockSeconds(const Moment& moment);
Moment momentFromUtc(double utcSeconds, int offsetMinutes = 0);

} // namespace heliodon::daylight
