#include "compute/daylight/time.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "geometry/input_error.h"
#include "geometry/lower_case.h"

namespace heliodon::daylight {

namespace {

constexpr double kDaySeconds = 86400.0;

// Reads a text from left to right; every read either takes what it wants or leaves the text as it was.
struct Cursor {
    std::string_view rest;

    bool take(char c) {
        if (rest.empty() || std::toupper(static_cast<unsigned char>(rest[0])) != c) return false;
        rest.remove_prefix(1);
        return true;
    }
    size_t digitCount() const {
        size_t n = 0;
        while (n < rest.size() && rest[n] >= '0' && rest[n] <= '9') ++n;
        return n;
    }
    std::optional<int> takeDigits(size_t n) {
        if (digitCount() < n) return std::nullopt;
        int value = 0;
        for (size_t i = 0; i < n; ++i) value = value * 10 + (rest[i] - '0');
        rest.remove_prefix(n);
        return value;
    }
    // Digits with an optional fraction after '.' or ','; at most nine digits before it and any number after.
    std::optional<double> takeNumber(bool& hasFraction) {
        const size_t whole = digitCount();
        if (whole == 0 || whole > 9) return std::nullopt;
        double value = *takeDigits(whole);
        hasFraction = false;
        if (!rest.empty() && (rest[0] == '.' || rest[0] == ',')) {
            Cursor after{rest.substr(1)};
            const size_t n = after.digitCount();
            if (n == 0) return std::nullopt;
            double unit = 0.1;
            for (size_t i = 0; i < n; ++i, unit *= 0.1) value += unit * (after.rest[i] - '0');
            rest.remove_prefix(1 + n);
            hasFraction = true;
        }
        return value;
    }
};

[[noreturn]] void refuseTime(std::string_view text, const std::string& source, std::string_view why) {
    throw geometry::InputError(
        source, "",
        fmt::format("'{}' is not a time: {}; expected like 2026-03-21T13:00-05:00, 2026-03-21T18:00Z or "
                    "2026-03-21T13:00solar",
                    text.substr(0, 60), why));
}

std::optional<Date> takeDate(Cursor& in) {
    const auto year = in.takeDigits(4);
    if (!year || !in.take('-')) return std::nullopt;
    const auto month = in.takeDigits(2);
    if (!month || !in.take('-')) return std::nullopt;
    const auto day = in.takeDigits(2);
    if (!day) return std::nullopt;
    return Date{*year, *month, *day};
}

// Seconds of the day from hh:mm[:ss[.f]].
std::optional<double> takeClock(Cursor& in) {
    const auto hour = in.takeDigits(2);
    if (!hour || !in.take(':')) return std::nullopt;
    const auto minute = in.takeDigits(2);
    if (!minute || *hour > 24 || *minute > 59) return std::nullopt;
    double second = 0;
    if (in.take(':')) {
        bool hasFraction = false;
        const size_t digits = in.digitCount();
        const auto read = digits == 2 ? in.takeNumber(hasFraction) : std::nullopt;
        if (!read || *read >= 60) return std::nullopt;
        second = *read;
    }
    const double ofDay = *hour * 3600.0 + *minute * 60.0 + second;
    return ofDay <= kDaySeconds ? std::optional(ofDay) : std::nullopt;
}

// Minutes east from Z, +hh, +hhmm or +hh:mm.
std::optional<int> takeOffset(Cursor& in) {
    if (in.take('Z')) return 0;
    const bool negative = !in.rest.empty() && in.rest[0] == '-';
    if (!negative && !(!in.rest.empty() && in.rest[0] == '+')) return std::nullopt;
    in.rest.remove_prefix(1);
    const auto hours = in.takeDigits(2);
    if (!hours) return std::nullopt;
    int minutes = 0;
    if (!in.rest.empty()) {
        in.take(':');
        const auto read = in.takeDigits(2);
        if (!read || *read > 59) return std::nullopt;
        minutes = *read;
    }
    const int total = *hours * 60 + minutes;
    if (total > 15 * 60) return std::nullopt;
    return negative ? -total : total;
}

void carryDay(Moment& moment) {
    const double days = std::floor(moment.second / kDaySeconds);
    moment.second = std::clamp(moment.second - days * kDaySeconds, 0.0, std::nextafter(kDaySeconds, 0.0));
    if (days != 0) moment.date = dateFromDays(daysSinceEpoch(moment.date) + static_cast<int64_t>(days));
}

std::string formatSeconds(double seconds) {
    std::string text = fmt::format("{:09.6f}", seconds);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text;
}

std::string formatOffset(int minutes) {
    const int offset = std::abs(minutes);
    return fmt::format("{}{:02}:{:02}", minutes < 0 ? '-' : '+', offset / 60, offset % 60);
}

// To the microsecond, so that 59.9999999 does not print as 60.
Moment rounded(Moment m) {
    m.second = std::round(m.second * 1e6) / 1e6;
    carryDay(m);
    return m;
}

bool isLeapYear(int year) {
    return year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
}

} // namespace

int daysInMonth(int year, int month) {
    constexpr std::array<int, 12> days{31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    return month == 2 && isLeapYear(year) ? 29 : days.at(static_cast<size_t>(month - 1));
}

int dayOfYear(const Date& date) {
    return static_cast<int>(daysSinceEpoch(date) - daysSinceEpoch({date.year, 1, 1})) + 1;
}

// Years are counted from March, so that the leap day is a year's last; an era is 400 years, 146097 days.
int64_t daysSinceEpoch(const Date& date) {
    const int64_t year = date.month <= 2 ? date.year - 1 : date.year;
    const int64_t era = (year >= 0 ? year : year - 399) / 400;
    const int64_t yearOfEra = year - era * 400;
    const int64_t monthFromMarch = (date.month + 9) % 12;
    const int64_t day = (153 * monthFromMarch + 2) / 5 + date.day - 1;
    return era * 146097 + yearOfEra * 365 + yearOfEra / 4 - yearOfEra / 100 + day - 719468;
}

Date dateFromDays(int64_t days) {
    days += 719468;
    const int64_t era = (days >= 0 ? days : days - 146096) / 146097;
    const int64_t dayOfEra = days - era * 146097;
    const int64_t yearOfEra = (dayOfEra - dayOfEra / 1460 + dayOfEra / 36524 - dayOfEra / 146096) / 365;
    const int64_t day = dayOfEra - (365 * yearOfEra + yearOfEra / 4 - yearOfEra / 100);
    const int64_t monthFromMarch = (5 * day + 2) / 153;
    const int month = static_cast<int>(monthFromMarch < 10 ? monthFromMarch + 3 : monthFromMarch - 9);
    return {static_cast<int>(yearOfEra + era * 400 + (month <= 2 ? 1 : 0)), month,
            static_cast<int>(day - (153 * monthFromMarch + 2) / 5 + 1)};
}

Moment parseTime(std::string_view text, const std::string& source) {
    Cursor in{text};
    const auto date = takeDate(in);
    if (!date) refuseTime(text, source, "it does not start with a date YYYY-MM-DD");
    if (date->year < 1 || date->year > 5999) refuseTime(text, source, "the year must be 0001 to 5999");
    if (date->month < 1 || date->month > 12) refuseTime(text, source, "the month must be 01 to 12");
    const int last = daysInMonth(date->year, date->month);
    if (date->day < 1 || date->day > last)
        refuseTime(text, source, fmt::format("the day must be 01 to {}", last));
    if (!in.take('T') && !in.take(' ')) refuseTime(text, source, "'T' and a time of day are missing");
    const auto second = takeClock(in);
    if (!second) refuseTime(text, source, "the time of day must be hh:mm or hh:mm:ss, at most 24:00");

    Moment moment{*date, *second, false, 0};
    const std::string tail = geometry::lowered(in.rest);
    if (tail.empty()) refuseTime(text, source, "the offset from UTC is missing (or 'solar')");
    if (tail == "solar") {
        moment.solar = true;
    } else {
        const auto offset = takeOffset(in);
        if (!offset || !in.rest.empty())
            refuseTime(text, source, fmt::format("'{}' is no offset from UTC", tail.substr(0, 20)));
        moment.offsetMinutes = *offset;
    }
    carryDay(moment);
    return moment;
}

Duration parseDuration(std::string_view text, const std::string& source) {
    const auto refuse = [&](std::string_view why) {
        throw geometry::InputError(
            source, "",
            fmt::format("'{}' is not a duration: {}; expected like PT10M, PT1H30M, P1D or P1M",
                        text.substr(0, 60), why));
    };
    struct Unit {
        char letter;
        bool ofTime;
        int months;
        double seconds;
    };
    constexpr std::array<Unit, 7> units{{{'Y', false, 12, 0},
                                         {'M', false, 1, 0},
                                         {'W', false, 0, 7 * kDaySeconds},
                                         {'D', false, 0, kDaySeconds},
                                         {'H', true, 0, 3600},
                                         {'M', true, 0, 60},
                                         {'S', true, 0, 1}}};
    Cursor in{text};
    if (!in.take('P')) refuse("it does not start with P");
    Duration duration;
    size_t next = 0;
    bool inTime = false, fraction = false, any = false;
    while (!in.rest.empty()) {
        if (!inTime && in.take('T')) {
            inTime = true;
            any = false;
        }
        if (fraction) refuse("only its last number may have a fraction");
        const auto number = in.takeNumber(fraction);
        if (!number) refuse("a number (at most nine digits) and its unit are expected");
        while (next < units.size() && !(units[next].ofTime == inTime && in.take(units[next].letter))) ++next;
        if (next == units.size()) refuse("units come in the order Y M W D T H M S, each once");
        if (fraction && units[next].months) refuse("years and months must be whole");
        if (duration.months + *number * units[next].months > 120'000) refuse("it is longer than 10000 years");
        duration.months += static_cast<int>(*number) * units[next].months;
        duration.seconds += *number * units[next].seconds;
        ++next;
        any = true;
    }
    if (!any) refuse("a number and its unit are missing");
    if (duration.months == 0 && duration.seconds < 1e-3) refuse("it must be at least a millisecond");
    return duration;
}

std::string formatTime(const Moment& moment) {
    const Moment m = rounded(moment);
    const int minutes = static_cast<int>(m.second / 60.0);
    std::string text =
        fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{}", m.date.year, m.date.month, m.date.day, minutes / 60,
                    minutes % 60, formatSeconds(std::max(0.0, m.second - minutes * 60.0)));
    if (m.solar) return text + "solar";
    return text + (m.offsetMinutes == 0 ? "Z" : formatOffset(m.offsetMinutes));
}

std::string timeInWords(const Moment& moment) {
    const Moment m = rounded(moment);
    const int minutes = static_cast<int>(m.second / 60.0);
    const double seconds = m.second - minutes * 60.0;
    std::string text = fmt::format("{} {} {}, {:02}:{:02}", m.date.day, monthName(m.date.month), m.date.year,
                                   minutes / 60, minutes % 60);
    if (seconds >= 5e-7) text += fmt::format(":{}", formatSeconds(seconds));
    if (m.solar) return text + " solar time";
    return text + " UTC" + (m.offsetMinutes == 0 ? "" : formatOffset(m.offsetMinutes));
}

std::string monthName(int month) {
    constexpr std::array<const char*, 12> names{"January",   "February", "March",    "April",
                                                "May",       "June",     "July",     "August",
                                                "September", "October",  "November", "December"};
    return names.at(static_cast<size_t>(month - 1));
}

Moment advance(const Moment& start, const Duration& step, int64_t count) {
    Moment moment = start;
    const int64_t month = moment.date.year * int64_t{12} + moment.date.month - 1 + step.months * count;
    const int64_t year = month >= 0 ? month / 12 : (month - 11) / 12;
    moment.date.year = static_cast<int>(year);
    moment.date.month = static_cast<int>(month - year * 12) + 1;
    moment.date.day = std::min(moment.date.day, daysInMonth(moment.date.year, moment.date.month));
    moment.second += step.seconds * static_cast<double>(count);
    carryDay(moment);
    return moment;
}

double clockSeconds(const Moment& moment) {
    return static_cast<double>(daysSinceEpoch(moment.date)) * kDaySeconds + moment.second -
           moment.offsetMinutes * 60.0;
}

Moment momentFromUtc(double utcSeconds, int offsetMinutes) {
    Moment moment{{1970, 1, 1}, utcSeconds + offsetMinutes * 60.0, false, offsetMinutes};
    carryDay(moment);
    return moment;
}

std::vector<Moment> timeSeries(const Moment& from, const Moment& to, const Duration& step,
                               const std::string& source, size_t limit) {
    if (from.solar != to.solar)
        throw geometry::InputError(source, "",
                                   "one end is in solar time and the other is not; expected the same clock");
    const double end = clockSeconds(to) + 1e-3;
    if (end < clockSeconds(from) + 1e-3)
        throw geometry::InputError(source, "", "the end lies before the start");
    if (step.months <= 0 && step.seconds <= 0)
        throw geometry::InputError(source, "", "the step must be longer than zero");
    std::vector<Moment> series;
    for (Moment m = from; clockSeconds(m) <= end;
         m = advance(from, step, static_cast<int64_t>(series.size()))) {
        if (series.size() == limit)
            throw geometry::InputError(source, "",
                                       fmt::format("more than {} steps; expected a longer step", limit));
        series.push_back(m);
    }
    return series;
}

} // namespace heliodon::daylight
