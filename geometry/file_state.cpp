#include "geometry/file_state.h"

#include <system_error>

namespace heliodon::geometry {

std::optional<FileState> fileState(const std::filesystem::path& file) {
    std::error_code time, size;
    const FileState state{std::filesystem::last_write_time(file, time),
                          std::filesystem::file_size(file, size)};
    return time || size ? std::nullopt : std::optional(state);
}

} // namespace heliodon::geometry
