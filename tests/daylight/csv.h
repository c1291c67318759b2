// Test tables: CSV with a header line, gzipped or not.
#pragma once

#include <cstdlib>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <zlib.h>

namespace heliodon::test {

inline std::string dataFile(const std::string& name) {
    return std::string(HELIODON_TEST_DATA "/daylight/") + name;
}

inline std::string readAll(const std::string& file) {
    gzFile in = gzopen(file.c_str(), "rb");
    if (!in) throw std::runtime_error("cannot read " + file);
    std::string text;
    char block[1 << 16];
    for (int n; (n = gzread(in, block, sizeof block)) > 0;) text.append(block, static_cast<size_t>(n));
    gzclose(in);
    return text;
}

inline std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    size_t from = 0;
    for (size_t at; (at = text.find(separator, from)) != std::string::npos; from = at + 1)
        parts.push_back(text.substr(from, at - from));
    parts.push_back(text.substr(from));
    return parts;
}

struct Csv {
    std::map<std::string, size_t> columns;
    std::vector<std::vector<std::string>> rows;

    explicit Csv(const std::string& name) {
        for (auto& line : split(readAll(dataFile(name)), '\n')) {
            if (!line.empty() && line.back() == '\r') line.pop_back();
            if (line.empty()) continue;
            auto cells = split(line, ',');
            if (columns.empty())
                for (size_t i = 0; i < cells.size(); ++i) columns[cells[i]] = i;
            else
                rows.push_back(std::move(cells));
        }
    }
    const std::string& text(size_t row, const std::string& column) const {
        return rows[row].at(columns.at(column));
    }
    double number(size_t row, const std::string& column) const {
        return std::strtod(text(row, column).c_str(), nullptr);
    }
};

} // namespace heliodon::test
