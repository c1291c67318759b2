// Whether a file that has been read is still what was read.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

#include "geometry/file_state.h"

namespace heliodon::app {

class FileWatch {
public:
    // What is no plain file, as a pipe, can be read once only and never changes. Throws InputError where it
    // cannot be read.
    explicit FileWatch(std::filesystem::path file);

    // Whether it is there with other bytes than at the start, or than when it last was. Looks once a second
    // at most, and reads it only where it has been written since.
    bool changes();

private:
    bool isThere() const;

    std::filesystem::path file_;
    std::string text_;
    std::optional<geometry::FileState> state_;
    std::chrono::steady_clock::time_point looked_{};
};

} // namespace heliodon::app
