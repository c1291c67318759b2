// Auxiliary Programs, EnergyPlus documentation: "EnergyPlus Weather File (EPW) Data Dictionary".
#include "compute/daylight/epw.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>
#include <string_view>

#include <fmt/format.h>
#include <zlib.h>

#include "compute/daylight/wea.h"
#include "geometry/input_error.h"
#include "geometry/number_text.h"
#include "geometry/text_file.h"

namespace heliodon::daylight {

namespace {

using geometry::InputError;
using Cells = std::vector<std::string_view>;

constexpr size_t kLargestFile = size_t{256} << 20;

// zlib reads plain files as they are.
std::string readText(const std::string& file) {
    const std::string expected = "hourly weather (.epw, .wea, or one of them as .gz)";
    geometry::refuseUnreadable(file, expected);
    const int descriptor = geometry::openToRead(file);
    const std::unique_ptr<gzFile_s, int (*)(gzFile)> in(gzdopen(descriptor, "rb"), gzclose);
    if (!in) throw InputError(file, "", "cannot be read, expected " + expected);
    std::string text;
    std::vector<char> block(1 << 16);
    for (;;) {
        const int n = gzread(in.get(), block.data(), static_cast<unsigned>(block.size()));
        int state = Z_OK;
        gzerror(in.get(), &state);
        // A cut gzip stream ends without an error from gzread but leaves Z_BUF_ERROR.
        if (n < 0 || (state != Z_OK && state != Z_STREAM_END))
            throw InputError(file, "", "is cut off or damaged (gzip)");
        if (n == 0) return text;
        text.append(block.data(), static_cast<size_t>(n));
        if (text.size() > kLargestFile)
            throw InputError(file, "", "is larger than 256 MiB, not a weather file");
    }
}

// Text with lines that end as they do on every system.
std::string readLines(const std::string& file) {
    std::string text = readText(file);
    if (text.starts_with("PK\x03\x04"))
        throw InputError(file, "", "is a zip archive, expected the .epw in it");
    geometry::refuseUtf16(file, text);
    if (text.find('\n') == text.npos) std::replace(text.begin(), text.end(), '\r', '\n');
    return text;
}

std::string_view trim(std::string_view text) {
    const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\x1a' || c == '"'; };
    while (!text.empty() && blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && blank(text.back())) text.remove_suffix(1);
    return text;
}

bool sameWord(std::string_view a, std::string_view b) {
    return std::ranges::equal(
        a, b, [](unsigned char c, unsigned char d) { return std::tolower(c) == std::tolower(d); });
}

Cells splitCells(std::string_view line) {
    Cells cells;
    for (;;) {
        const size_t comma = line.find(',');
        cells.push_back(trim(line.substr(0, comma)));
        if (comma == line.npos) return cells;
        line.remove_prefix(comma + 1);
    }
}

// One line of the file with its place for messages.
struct Line {
    const std::string& file;
    size_t number;
    Cells cells;

    [[noreturn]] void refuse(const std::string& what) const {
        throw InputError(file, std::to_string(number), what);
    }

    double value(size_t field, const char* name) const {
        if (field >= cells.size())
            refuse(fmt::format("has {} fields, expected at least {} ({})", cells.size(), field + 1, name));
        const auto value = geometry::signedNumberFrom(cells[field]);
        if (!value)
            refuse(fmt::format("field {} ({}) is '{}', expected a number", field + 1, name,
                               cells[field].substr(0, 30)));
        return *value;
    }
    double within(size_t field, const char* name, double low, double high) const {
        const double v = value(field, name);
        if (v < low || v > high)
            refuse(fmt::format("field {} ({}) is {}, expected {:g} to {:g}", field + 1, name, v, low, high));
        return v;
    }
    int whole(size_t field, const char* name, int low, int high) const {
        const double v = within(field, name, low, high);
        if (v != std::floor(v))
            refuse(fmt::format("field {} ({}) is {}, expected a whole number", field + 1, name, v));
        return static_cast<int>(v);
    }
    bool isBlank(size_t field) const { return field < cells.size() && cells[field].empty(); }
    std::optional<double> irradiance(size_t field, const char* name) const {
        if (isBlank(field)) return std::nullopt;
        return irradianceFrom(value(field, name), [&](const std::string& what) {
            refuse(fmt::format("field {} ({}) {}", field + 1, name, what));
        });
    }
};

struct Period {
    Date first{2001, 1, 1}, last{2001, 12, 31}; // of a common year
};

// 1 to 12 by its first three letters.
std::optional<double> monthNamed(std::string_view word) {
    for (int month = 1; month <= 12; ++month)
        if (sameWord(word.substr(0, 3), monthName(month).substr(0, 3))) return month;
    return std::nullopt;
}

// "6/20", "6/20/2003"; "20-Jun" or "Jun-20", as spreadsheets make of it; 171, the day of a common year.
std::optional<Date> monthAndDay(std::string_view text) {
    text = text.substr(0, text.find(':')); // "6/20/2003 0:00": the hour goes with the year
    Cells words;
    const auto isPart = [](unsigned char c) { return std::isalnum(c) != 0; };
    for (auto at = text.begin(); (at = std::find_if(at, text.end(), isPart)) != text.end();) {
        const auto end = std::find_if_not(at, text.end(), isPart);
        words.emplace_back(at, end);
        at = end;
    }
    if (words.empty() || words.size() > 4) return std::nullopt;
    if (words.size() == 1) {
        const auto day = geometry::numberFrom(words[0]);
        if (!day || *day != std::floor(*day) || *day < 1 || *day > 366) return std::nullopt;
        const int64_t days = daysSinceEpoch({2001, 1, 1}) + static_cast<int64_t>(std::min(*day, 365.0)) - 1;
        return dateFromDays(days);
    }
    if (monthNamed(words[1])) std::swap(words[0], words[1]);
    const auto named = monthNamed(words[0]);
    const auto month = named ? named : geometry::numberFrom(words[0]);
    const auto day = geometry::numberFrom(words[1]);
    if (!month || !day || *month < 1 || *month > 12 || *day < 1 ||
        *day > daysInMonth(2000, static_cast<int>(*month)))
        return std::nullopt;
    return Date{2001, static_cast<int>(*month), static_cast<int>(*day)};
}

// What a file is expected to cover, and by what.
struct Coverage {
    std::vector<Period> periods;
    int recordsPerHour = 1;
    std::string by;
};

// DATA PERIODS,n,records an hour,{name,week day,first,last} n times.
Coverage readCoverage(const Line& line, EpwFile& epw) {
    const auto count = line.cells.size() > 1 ? geometry::signedNumberFrom(line.cells[1]) : std::nullopt;
    const auto perHour = line.cells.size() > 2 ? geometry::signedNumberFrom(line.cells[2]) : std::nullopt;
    if (perHour &&
        (*perHour < 1 || *perHour > 60 || std::fmod(60.0, *perHour) != 0 || *perHour != std::floor(*perHour)))
        line.refuse(fmt::format("field 3 (records per hour) is {}, expected a divisor of 60", *perHour));
    Coverage coverage;
    coverage.recordsPerHour = perHour ? static_cast<int>(*perHour) : 1;
    const auto wanted = static_cast<size_t>(std::clamp(count.value_or(0), 0.0, 366.0));
    for (size_t i = 0; i < wanted; ++i) {
        const size_t at = 3 + 4 * i;
        const auto first = at + 2 < line.cells.size() ? monthAndDay(line.cells[at + 2]) : std::nullopt;
        const auto last = at + 3 < line.cells.size() ? monthAndDay(line.cells[at + 3]) : std::nullopt;
        if (first && last) coverage.periods.push_back({*first, *last});
    }
    if (perHour && !coverage.periods.empty() && coverage.periods.size() == wanted) {
        coverage.by = fmt::format("{} record{} an hour by DATA PERIODS", coverage.recordsPerHour,
                                  coverage.recordsPerHour == 1 ? "" : "s");
        return coverage;
    }
    // Most files are a year whatever this line says; what is none is refused by its records.
    coverage.by = fmt::format("a whole year, since DATA PERIODS, line {}, could not be read", line.number);
    epw.warnings.push_back(
        fmt::format("line {}: DATA PERIODS could not be read; a whole year is expected", line.number));
    coverage.periods = {Period{}};
    return coverage;
}

[[noreturn]] void refuseFirst(const Line& line) {
    const std::string_view word = line.cells[0];
    if (sameWord(word.substr(0, 8), "LOCATION") && word.size() > 8 &&
        !std::isalnum(static_cast<unsigned char>(word[8])))
        line.refuse(fmt::format("has {} between its fields, expected commas",
                                word[8] == '\t' ? "tabs" : fmt::format("'{}'", word[8])));
    line.refuse("expected LOCATION, the first line of an EPW file");
}

void readLocation(const Line& line, EpwFile& epw) {
    Cells cells = line.cells;
    while (!cells.empty() && cells.back().empty()) cells.pop_back();
    if (line.cells.size() == 10 && cells.size() == 9) {
        epw.warnings.push_back(fmt::format("line {}: the elevation is missing; 0 m is taken", line.number));
        cells.emplace_back("0");
    }
    if (cells.size() < 6) line.refuse(fmt::format("LOCATION has {} fields, expected 10", cells.size()));
    // Counted from the end: names may hold commas.
    const Line numbers{line.file, line.number, cells};
    const size_t n = cells.size();
    epw.latitudeDeg = numbers.within(n - 4, "latitude", -90, 90);
    epw.longitudeDeg = numbers.within(n - 3, "longitude", -180, 180);
    epw.timeZoneHours = numbers.within(n - 2, "time zone", -14, 15);
    epw.elevationM = numbers.within(n - 1, "elevation", -1000, 9999.9);
    for (size_t i = 1; i < n - 4 && i < 4; ++i) {
        if (cells[i].empty() || cells[i] == "-" || cells[i] == "unknown") continue;
        epw.place += (epw.place.empty() ? "" : ", ") + geometry::asUtf8(std::string(cells[i]));
    }
}

void readComment(std::string_view text, EpwFile& epw) {
    constexpr std::string_view kKey = "Irradiance Time Offset";
    const size_t at = text.find(kKey);
    if (at == text.npos) return;
    const size_t colon = text.find_first_of(":=", at);
    if (colon == text.npos) return;
    text = text.substr(colon + 1);
    const auto hours = geometry::signedNumberFrom(trim(text.substr(0, text.find(','))));
    if (hours && std::abs(*hours) <= 2) epw.irradianceOffsetHours = *hours;
}

// A direct irradiance that cannot be: it is negative where global less diffuse says that the sun shone.
bool losesTheSun(double direct, const EpwRecord& record) {
    constexpr double kSurelySun = 30; // W/m2 horizontal
    return direct < 0 && record.global && record.diffuse && *record.global - *record.diffuse > kSurelySun;
}

// The date and clock that a record carries.
struct Stamp {
    Date date;
    int hour = 0; // 0..24
    bool fullHour = false;
};

Stamp readStamp(const Line& line) {
    Stamp stamp;
    stamp.date.year = line.whole(0, "year", -9999, 9999);
    stamp.date.month = line.whole(1, "month", 1, 12);
    stamp.date.day = line.whole(2, "day", 1, daysInMonth(2000, stamp.date.month));
    Line clock = line;
    if (clock.cells.size() > 3)
        while (clock.cells[3].ends_with(":00")) clock.cells[3].remove_suffix(3);
    stamp.hour = clock.whole(3, "hour", 0, 24);
    stamp.fullHour = line.cells.size() > 4 && geometry::signedNumberFrom(line.cells[4]) == 0.0;
    return stamp;
}

EpwRecord readRecord(const Line& line, EpwFile& epw) {
    constexpr size_t kFields = 35, kMore = 2; // columns that somebody added
    const auto filled = static_cast<size_t>(
        std::ranges::count_if(line.cells, [](std::string_view cell) { return !cell.empty(); }));
    if (filled > kFields + kMore)
        line.refuse(fmt::format("has {} fields, expected {}: are there decimal commas?", filled, kFields));
    EpwRecord record;
    record.line = line.number;
    std::optional<double> dewPoint;
    if (!line.isBlank(7)) dewPoint = line.value(7, "dew point");
    if (dewPoint && *dewPoint > -90 && *dewPoint < 70) record.dewPointC = dewPoint; // 99.9 = missing
    record.global = line.irradiance(13, "global horizontal radiation");
    record.direct = line.irradiance(14, "direct normal radiation");
    record.diffuse = line.irradiance(15, "diffuse horizontal radiation");
    if (record.direct && losesTheSun(line.value(14, "direct normal radiation"), record)) {
        record.direct.reset();
        ++epw.directRefuted;
    }
    return record;
}

// Where the next record must be: walks hour by hour through the data periods. 29 February is taken when the
// file has it.
class Sequence {
public:
    explicit Sequence(Coverage coverage)
        : periods_(std::move(coverage.periods)), perHour_(coverage.recordsPerHour),
          by_(std::move(coverage.by)), date_(periods_[0].first) {}

    bool finished() const { return period_ == periods_.size(); }
    bool hoursFromZero() const { return fromZero_; }
    bool clockAtEnd() const { return clockAtEnd_; }
    std::string expected() const {
        return fmt::format("{}/{} hour {} ({})", date_.month, date_.day, hour_, by_);
    }

    void accept(const Line& line, const Stamp& stamp, EpwRecord& record) {
        if (!year_) fromZero_ = stamp.hour == 0;
        if (isOn(stamp.date, kLeapDay) && mayBeLeapDay()) date_ = kLeapDay, period_ = donePeriod_;
        if (finished()) line.refuse(fmt::format("a record after the end of the data period ({})", by_));
        const bool byClock = endsNow(stamp);
        if (!byClock && (!isOn(stamp.date, date_) || stamp.hour + fromZero_ != hour_))
            line.refuse(fmt::format("is {}/{} hour {}, expected {}", stamp.date.month, stamp.date.day,
                                    stamp.hour + fromZero_, expected()));
        clockAtEnd_ |= byClock;
        if (!byClock || !year_) year_ = stamp.date.year; // at midnight of New Year the clock has the next
        record.date = {*year_, date_.month, date_.day};
        record.hour = hour_;
        record.part = part_;
        if (++part_ < perHour_) return;
        part_ = 0;
        if (++hour_ <= 24) return;
        hour_ = 1;
        nextDay(record.date);
    }

private:
    static constexpr Date kLeapDay{2001, 2, 29};

    static bool isOn(const Date& a, const Date& b) { return a.month == b.month && a.day == b.day; }
    // It has been stepped over: 28 February is done, and was not the last of its period.
    bool mayBeLeapDay() const {
        return hour_ == 1 && part_ == 0 && done_ && isOn(*done_, {2001, 2, 28}) &&
               !isOn(periods_[donePeriod_].last, *done_);
    }
    static Date dayAfter(const Date& date) {
        Date next = isOn(date, kLeapDay) ? Date{2001, 3, 1} : dateFromDays(daysSinceEpoch(date) + 1);
        next.year = 2001; // a period may run over New Year
        return next;
    }
    // Whether a clock at the end of the interval shows this: the full hour, at midnight 24 or the next day's
    // 0. Of whole hours counted from 1 it is what differs from the format; an hour's last part, counted from
    // 0, has the next hour's number.
    bool endsNow(const Stamp& stamp) const {
        if (part_ + 1 < perHour_ || (fromZero_ && (perHour_ == 1 || !stamp.fullHour))) return false;
        if (hour_ == 24 && stamp.hour == 0)
            return isOn(stamp.date, dayAfter(date_)) ||
                   (isOn(stamp.date, kLeapDay) && isOn(date_, {2001, 2, 28}));
        return fromZero_ && stamp.hour == hour_ && isOn(stamp.date, date_);
    }
    void nextDay(const Date& done) {
        done_ = done, donePeriod_ = period_;
        const Date& last = periods_[period_].last;
        if (isOn(done, last) || (isOn(done, {2001, 2, 28}) && isOn(last, kLeapDay))) {
            if (++period_ < periods_.size()) date_ = periods_[period_].first;
            return;
        }
        date_ = dayAfter(date_);
    }

    std::vector<Period> periods_;
    int perHour_;
    std::string by_; // what they are expected by
    size_t period_ = 0;
    Date date_;
    int hour_ = 1, part_ = 0;
    std::optional<Date> done_; // the last day that is whole, in ...
    size_t donePeriod_ = 0;    // ... this period
    std::optional<int> year_;  // of the last record; none before the first
    bool fromZero_ = false;    // hours 0 to 23, by the first record
    bool clockAtEnd_ = false;  // records carry the clock at their end
};

} // namespace

EpwFile readEpw(const std::filesystem::path& path) {
    const std::string file = path.string();
    const std::string text = readLines(file);
    std::string_view rest = text;
    if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3);
    if (isWea(rest)) return readWea(file, rest);

    EpwFile epw;
    std::optional<Sequence> sequence;
    bool located = false;
    size_t number = 0;
    while (!rest.empty()) {
        const size_t end = rest.find('\n');
        const std::string_view content = trim(rest.substr(0, end));
        rest.remove_prefix(end == rest.npos ? rest.size() : end + 1);
        ++number;
        if (content.find_first_not_of(", \t") == content.npos || content[0] == '#' || content[0] == '!')
            continue;
        const Line line{file, number, splitCells(content)};
        if (!located) {
            if (!sameWord(line.cells[0], "LOCATION")) refuseFirst(line);
            readLocation(line, epw);
            located = true;
        } else if (!sequence) {
            if (sameWord(content.substr(0, 8), "COMMENTS")) readComment(content, epw);
            if (sameWord(line.cells[0], "DATA PERIODS")) {
                Coverage coverage = readCoverage(line, epw);
                epw.recordsPerHour = coverage.recordsPerHour;
                sequence.emplace(std::move(coverage));
            } else if (geometry::signedNumberFrom(line.cells[0]))
                line.refuse("a record before the line DATA PERIODS");
        } else {
            const Stamp stamp = readStamp(line);
            EpwRecord record = readRecord(line, epw);
            sequence->accept(line, stamp, record);
            epw.records.push_back(record);
        }
    }
    if (!located) throw InputError(file, "", "is empty, expected an EPW weather file or a .wea");
    const std::string last = std::to_string(number);
    if (!sequence) throw InputError(file, last, "the file ends before the line DATA PERIODS");
    if (!sequence->finished())
        throw InputError(file, last, fmt::format("the file ends before {}", sequence->expected()));
    if (sequence->clockAtEnd())
        epw.warnings.emplace_back("records carry the clock at their end; read as hours 1 to 24");
    else if (sequence->hoursFromZero())
        epw.warnings.emplace_back("hours run from 0 to 23; read as 1 to 24");
    return epw;
}

} // namespace heliodon::daylight
