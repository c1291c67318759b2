// What tells, without reading it, that a file has been written again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace heliodon::geometry {

struct FileState {
    std::filesystem::file_time_type written;
    std::uintmax_t bytes = 0;
    bool operator==(const FileState&) const = default;
};

// None where there is no such file, or nothing that has a size, as a folder.
std::optional<FileState> fileState(const std::filesystem::path& file);

} // namespace heliodon::geometry
