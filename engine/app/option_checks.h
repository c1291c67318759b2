// Limits of numbers on the command line, said in as many digits as they have.
#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "geometry/whole_file.h"

namespace heliodon::app {

// CLI::Range and CLI::PositiveNumber spell limits with six and three hundred digits.
inline CLI::Validator number(const std::function<bool(double)>& fits, const std::string& wanted) {
    const auto check = [=](std::string& text) {
        double value = 0;
        return CLI::detail::lexical_cast(text, value) && fits(value)
                   ? std::string()
                   : fmt::format("'{}' is not a number {}", text, wanted);
    };
    return {check, wanted};
}

inline CLI::Validator within(double low, double high) {
    return number([=](double x) { return x >= low && x <= high; }, fmt::format("from {} to {}", low, high));
}

// A file to write; "-" becomes /dev/stdout.
inline std::string fileOrStdout(std::string& text) {
    if (text == "-") text = "/dev/stdout";
    return {};
}

// Of this ending; streams may have any name.
inline CLI::Validator resultNamed(const std::string& ending) {
    const auto check = [=](std::string& text) {
        fileOrStdout(text);
        const std::filesystem::path file = text;
        return file.extension() == ending || geometry::isStream(file)
                   ? std::string()
                   : fmt::format("'{}' is no {} file, expected that ending, or - for the standard output",
                                 text, ending);
    };
    return {check, ""};
}

inline CLI::Validator positive() {
    return number([](double x) { return x > 0 && std::isfinite(x); }, "above 0");
}

} // namespace heliodon::app
