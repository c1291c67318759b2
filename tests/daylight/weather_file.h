// Weather files as text, read from disk.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "compute/daylight/weather.h"
#include "geometry/input_error.h"

namespace heliodon::test {

class TemporaryFile {
public:
    explicit TemporaryFile(const std::string& content, const char* name = "heliodon_weather_test.epw")
        : path_(testing::TempDir() + name) {
        std::ofstream(path_, std::ios::binary) << content;
    }
    ~TemporaryFile() { std::filesystem::remove(path_); }
    const std::string& path() const { return path_; }

private:
    std::string path_;
};

inline daylight::Weather weatherOf(const std::string& content) {
    return daylight::readWeather(TemporaryFile(content).path());
}

inline std::string refusalOf(const std::string& content) {
    const TemporaryFile file(content);
    try {
        daylight::readWeather(file.path());
        return "accepted";
    } catch (const geometry::InputError& e) {
        return std::string(e.what()).substr(file.path().size());
    }
}

} // namespace heliodon::test
