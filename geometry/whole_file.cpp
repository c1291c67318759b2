#include "geometry/whole_file.h"

#include <fstream>
#include <system_error>
#include <unistd.h>

#include <fmt/format.h>

#include "geometry/input_error.h"

namespace heliodon::geometry {

namespace fs = std::filesystem;

void writeWhole(const fs::path& target, const std::function<void(const fs::path&)>& write) {
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    if (!fs::is_directory(folder)) throw InputError(target.string(), "", "its folder does not exist");
    if (fs::is_directory(target))
        throw InputError(target.string(), "", "is a folder, expected a file to write");
    if (::access(folder.c_str(), W_OK) != 0)
        throw InputError(target.string(), "", "its folder cannot be written to");
    const fs::path aside =
        folder / fmt::format(".{}.{}{}", target.stem().string(), ::getpid(), target.extension().string());
    try {
        write(aside);
        fs::rename(aside, target);
    } catch (...) {
        std::error_code ignored;
        fs::remove(aside, ignored);
        throw;
    }
}

void writeWholeText(const fs::path& target, std::string_view text) {
    writeWhole(target, [&](const fs::path& aside) {
        std::ofstream out(aside, std::ios::binary);
        out.write(text.data(), static_cast<std::streamsize>(text.size()));
        if (!out.flush()) throw std::runtime_error(target.string() + ": could not be written (disk full?)");
    });
}

} // namespace heliodon::geometry
