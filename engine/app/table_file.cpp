#include "engine/app/table_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include <fcntl.h>
#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <unistd.h>

#include "geometry/input_error.h"
#include "geometry/lower_case.h"
#include "geometry/number_text.h"
#include "geometry/text_file.h"
#include "geometry/whole_file.h"

namespace heliodon::app {

using geometry::InputError;

namespace {

static_assert(std::endian::native == std::endian::little, "binary tables are written as they lie in memory");

constexpr size_t kLargestTable = size_t{256} << 20; // bytes of text

// What stands between cells: spreadsheets of many languages write semicolons, others tabs; a blank stands for
// any number of them.
char separatorOf(const std::string& header) {
    if (header.find_first_of(",;\t") == std::string::npos) return ' ';
    return std::ranges::max({',', ';', '\t'}, {}, [&](char c) { return std::ranges::count(header, c); });
}

const char* blanksBeside(char separator) {
    return separator == '\t' ? " " : " \t";
}

std::string trimmed(const std::string& text, const char* blanks = " \t") {
    const size_t first = text.find_first_not_of(blanks), last = text.find_last_not_of(blanks);
    return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

// After RFC 4180: separators in quotes part nothing, two quotes in quotes are one. Blanks round a cell do not
// count. Only a cell that goes over several lines is refused.
std::vector<std::string> splitCsv(const std::string& line, char separator, const std::string& file,
                                  size_t number) {
    std::vector<std::string> cells;
    if (separator == ' ') {
        std::istringstream words(line);
        for (std::string word; words >> word;) cells.push_back(word);
        return cells;
    }
    const char* const blanks = blanksBeside(separator);
    for (size_t at = 0; at <= line.size(); ++at) { // behind a separator, or at the start
        const size_t first = std::min(line.find_first_not_of(blanks, at), line.size());
        std::string cell;
        if (first == line.size() || line[first] != '"') {
            const size_t end = std::min(line.find(separator, at), line.size());
            cells.push_back(trimmed(line.substr(at, end - at), blanks));
            at = end;
            continue;
        }
        for (at = first + 1;; ++at) {
            if (at >= line.size())
                throw InputError(file, std::to_string(number),
                                 "a quoted cell does not end in its line, expected a closing quote");
            if (line[at] == '"') {
                if (at + 1 >= line.size() || line[at + 1] != '"') break;
                ++at;
            }
            cell += line[at];
        }
        const size_t end = std::min(line.find(separator, at), line.size());
        if (!trimmed(line.substr(at + 1, end - at - 1)).empty())
            throw InputError(file, std::to_string(number),
                             "text follows a closing quote, expected a comma or the line's end");
        cells.push_back(trimmed(cell));
        at = end;
    }
    return cells;
}

double numberIn(const std::string& cell, const std::string& file, size_t line, const char* column) {
    const std::optional<double> value = geometry::signedNumberFrom(cell);
    if (!value)
        throw InputError(file, std::to_string(line),
                         fmt::format("column {} is '{}', expected a number", column, cell));
    return *value;
}

// Names in small letters, unless those wanted are there as they are.
std::vector<std::string> columnNames(std::vector<std::string> header, std::span<const char* const> wanted) {
    const auto has = [&](const char* name) { return std::ranges::find(header, name) != header.end(); };
    if (std::ranges::all_of(wanted, has)) return header;
    for (std::string& name : header) name = geometry::lowered(name);
    return header;
}

// Cells with commas between; a line that has them already stays as it is.
std::string commaSeparated(const std::string& line, char separator, const std::vector<std::string>& cells) {
    if (separator == ',') return line;
    std::string text;
    for (size_t k = 0; k < cells.size(); ++k) {
        if (k > 0) text += ',';
        text += csvField(cells[k]);
    }
    return text;
}

bool getTextLine(std::istream& in, std::string& line) {
    if (!std::getline(in, line)) return false;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return true;
}

std::string inUnits(size_t bytes) {
    double value = static_cast<double>(bytes);
    size_t unit = 0;
    constexpr std::array<const char*, 5> kUnits{"bytes", "KiB", "MiB", "GiB", "TiB"};
    for (; value >= 1024 && unit + 1 < kUnits.size(); ++unit) value /= 1024;
    return fmt::format("{:.3g} {}", value, kUnits[unit]);
}

// Disk space for all of it, so that a full disk is found before the work and not after.
void reserve(const std::filesystem::path& aside, size_t bytes, const std::filesystem::path& named) {
    const int handle = ::open(aside.c_str(), O_WRONLY | O_CLOEXEC);
    const int error = handle < 0 ? errno : ::posix_fallocate(handle, 0, static_cast<off_t>(bytes));
    if (handle >= 0) ::close(handle);
    if (error != 0)
        throw std::runtime_error(
            fmt::format("{}: no room for its {}: {}", named.string(), inUnits(bytes), std::strerror(error)));
}

} // namespace

std::string csvField(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + '"';
}

SensorTable readSensors(const std::filesystem::path& file, geometry::UpAxis up) {
    std::istringstream in(geometry::readText(file, "a table of sensors (.csv)", kLargestTable));
    SensorTable table;
    std::string line;
    if (!getTextLine(in, line))
        throw InputError(file.string(), "1", "is empty, expected a header with x,y,z,nx,ny,nz");
    if (line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);
    const char separator = separatorOf(line);
    constexpr std::array<const char*, 6> kNames{"x", "y", "z", "nx", "ny", "nz"};
    std::array<size_t, 6> column{};
    std::vector<std::string> header = splitCsv(line, separator, file.string(), 1);
    table.header = commaSeparated(line, separator, header);
    header = columnNames(std::move(header), kNames);
    for (size_t k = 0; k < kNames.size(); ++k) {
        const auto found = std::find(header.begin(), header.end(), kNames[k]);
        if (found == header.end())
            throw InputError(file.string(), "1",
                             fmt::format("the header has no column {}, expected x,y,z,nx,ny,nz", kNames[k]));
        if (std::find(found + 1, header.end(), kNames[k]) != header.end())
            throw InputError(file.string(), "1", fmt::format("the header has column {} twice", kNames[k]));
        column[k] = static_cast<size_t>(found - header.begin());
    }
    if (std::find(header.begin(), header.end(), "lux") != header.end())
        throw InputError(file.string(), "1", "has a column lux already, expected sensors without results");
    for (size_t number = 2; getTextLine(in, line); ++number) {
        if (line.find_first_not_of(" \t") == std::string::npos) continue;
        std::vector<std::string> cells = splitCsv(line, separator, file.string(), number);
        if (cells.size() != header.size())
            throw InputError(file.string(), std::to_string(number),
                             fmt::format("has {} columns, the header has {}", cells.size(), header.size()));
        std::array<double, 6> v{};
        for (size_t k = 0; k < v.size(); ++k) {
            std::string& cell = cells[column[k]];
            if (separator != ',') std::ranges::replace(cell, ',', '.'); // 1,5 where commas do not part cells
            v[k] = numberIn(cell, file.string(), number, kNames[k]);
        }
        const glm::dvec3 normal{v[3], v[4], v[5]};
        if (glm::length(normal) < 1e-12)
            throw InputError(file.string(), std::to_string(number), "the normal nx,ny,nz has length zero");
        table.rows.push_back(commaSeparated(line, separator, cells));
        table.points.push_back(geometry::worldFromModel({v[0], v[1], v[2]}, up));
        table.normals.push_back(glm::normalize(geometry::worldFromModel(normal, up)));
    }
    if (table.rows.empty()) throw InputError(file.string(), "", "has a header but no sensors");
    return table;
}

void NpyWriter::flush() {
    if (!out_.flush()) throw std::runtime_error(name_ + ": could not be written (disk full?)");
}

void NpyWriter::writeAt(size_t place, std::span<const float> values) {
    out_.seekp(static_cast<std::streamoff>(begin_ + place * sizeof(float)));
    out_.write(reinterpret_cast<const char*>(values.data()),
               static_cast<std::streamsize>(values.size_bytes()));
}

void NpyWriter::write(std::span<const float> values) {
    writeAt(written_, values);
    written_ += values.size();
    flush();
}

void NpyWriter::put(size_t firstRow, size_t rows, size_t firstColumn, size_t columns,
                    std::span<const float> values) {
    // Whole rows in one go; parts of rows one by one.
    const size_t step = columns == columnCount_ ? rows : 1;
    for (size_t row = 0; row < rows; row += step)
        writeAt((firstRow + row) * columnCount_ + firstColumn, values.subspan(row * columns, step * columns));
    flush();
}

void NpyWriter::writeWhole(const std::filesystem::path& file, size_t rowCount, size_t columnCount,
                           const std::function<void(NpyWriter&)>& fill) {
    std::string header =
        fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, {}), }}", rowCount, columnCount);
    constexpr size_t kPreamble = 10,
                     kAlignment = 64; // magic, version and length; numpy aligns the data to 64 bytes
    header.append(kAlignment - 1 - (kPreamble + header.size()) % kAlignment, ' ');
    header += '\n';
    geometry::writeWhole(file, [&](const std::filesystem::path& aside) {
        std::ofstream out(aside, std::ios::binary);
        const auto length = static_cast<uint16_t>(header.size());
        out.write("\x93NUMPY\x01\x00", 8);
        out.write(reinterpret_cast<const char*>(&length), 2);
        out << header;
        NpyWriter writer(out, file.string(), kPreamble + header.size(), columnCount);
        writer.flush();
        reserve(aside, writer.begin_ + rowCount * columnCount * sizeof(float), file);
        fill(writer);
    });
}

MatrixFile::MatrixFile(const std::filesystem::path& file, size_t rowCount, size_t columnCount)
    : name_(file.string()), columnCount_(columnCount) {
    geometry::refuseUnreadable(file, "a matrix (.npy or .f32)");
    in_.open(file, std::ios::binary);
    if (file.extension() == ".npy") {
        std::array<char, 10> preamble{};
        in_.read(preamble.data(), preamble.size());
        uint16_t length = 0;
        std::memcpy(&length, preamble.data() + 8, 2);
        std::string header(length, ' ');
        in_.read(header.data(), length);
        const std::string shape = fmt::format("({}, {})", rowCount, columnCount);
        if (!in_ || std::memcmp(preamble.data(), "\x93NUMPY\x01", 7) != 0 ||
            header.find("'<f4'") == std::string::npos ||
            header.find("'fortran_order': False") == std::string::npos ||
            header.find(shape) == std::string::npos)
            throw InputError(name_, "", fmt::format("expected a NumPy array of float32 of shape {}", shape));
        begin_ = preamble.size() + length;
    }
    std::error_code unknown;
    if (!std::filesystem::is_regular_file(file, unknown)) throw InputError(name_, "", "is no plain file");
    if (std::filesystem::file_size(file, unknown) != begin_ + rowCount * columnCount * sizeof(float))
        throw InputError(
            name_, "",
            fmt::format("its size is not that of a {} x {} float32 matrix", rowCount, columnCount));
}

std::vector<float> MatrixFile::read(size_t firstRow, size_t rows, size_t firstColumn, size_t columns) {
    std::vector<float> values(rows * columns);
    // Whole rows in one go; parts of rows one by one.
    const size_t step = columns == columnCount_ ? std::max<size_t>(rows, 1) : 1;
    for (size_t row = 0; row < rows; row += step) {
        const size_t place = (firstRow + row) * columnCount_ + firstColumn;
        in_.seekg(static_cast<std::streamoff>(begin_ + place * sizeof(float)));
        in_.read(reinterpret_cast<char*>(&values[row * columns]),
                 static_cast<std::streamsize>(step * columns * sizeof(float)));
    }
    if (!in_) throw InputError(name_, "", "could not be read to its end");
    return values;
}

std::vector<float> readMatrix(const std::filesystem::path& file, size_t rowCount, size_t columnCount) {
    std::vector<float> values = MatrixFile(file, rowCount, columnCount).read(0, rowCount, 0, columnCount);
    for (size_t at = 0; at < values.size(); ++at)
        if (!std::isfinite(values[at]))
            throw InputError(file.string(), fmt::format("[{}, {}]", at / columnCount, at % columnCount),
                             fmt::format("is {}, expected a finite number", values[at]));
    return values;
}

} // namespace heliodon::app
