// Whether a file that has been read is still what was read.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "geometry/text_file.h"

namespace heliodon::app {

class FileWatch {
public:
    // What is no plain file, as a pipe, can be read once only and never changes. Throws InputError where it
    // cannot be read.
    explicit FileWatch(std::filesystem::path file) : file_(std::move(file)), written_(written()) {
        if (isThere()) text_ = geometry::readText(file_, "a file");
    }

    // Whether it is there with other bytes than at the start, or than when it last was. Looks once a second
    // at most, and reads it only where it has been written since.
    bool changes() {
        const auto now = std::chrono::steady_clock::now();
        if (now - looked_ < std::chrono::seconds(1)) return false;
        looked_ = now;
        const auto writtenNow = written();
        if (writtenNow == written_ || !isThere()) return false;
        written_ = writtenNow;
        try {
            std::string text = geometry::readText(file_, "a file");
            std::swap(text, text_);
            return text != text_;
        } catch (const geometry::InputError&) { // gone again
            return false;
        }
    }

private:
    bool isThere() const {
        std::error_code missing;
        return std::filesystem::is_regular_file(file_, missing);
    }
    std::filesystem::file_time_type written() const {
        std::error_code missing;
        const auto time = std::filesystem::last_write_time(file_, missing);
        return missing ? std::filesystem::file_time_type::min() : time;
    }

    std::filesystem::path file_;
    std::string text_;
    std::filesystem::file_time_type written_;
    std::chrono::steady_clock::time_point looked_{};
};

} // namespace heliodon::app
