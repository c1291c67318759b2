#include "geometry/whole_file.h"

#include <fstream>
#include <system_error>
#include <unistd.h>

#include <fmt/format.h>

#include "geometry/input_error.h"

namespace heliodon::geometry {

namespace fs = std::filesystem;

namespace {

// Pipes and devices have no neighbour to rename, and are not to be replaced: they are given what is complete.
bool isStream(const fs::path& target) {
    const fs::file_status status = fs::status(target);
    return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

// What a link names, there or not; circles end.
fs::path linked(fs::path target) {
    for (int links = 0; links < 40 && fs::is_symlink(target); ++links)
        target = target.parent_path() / fs::read_symlink(target);
    return target;
}

fs::path folderOf(const fs::path& target) {
    return target.has_parent_path() ? target.parent_path() : fs::path(".");
}

void removeQuietly(const fs::path& file) {
    std::error_code ignored;
    fs::remove(file, ignored);
}

void writeStream(const fs::path& target, const std::function<void(const fs::path&)>& write) {
    const fs::path aside =
        fs::temp_directory_path() / fmt::format("heliodon.{}{}", ::getpid(), target.extension().string());
    try {
        write(aside);
        std::ofstream out(target, std::ios::binary);
        out << std::ifstream(aside, std::ios::binary).rdbuf();
        if (!out.flush()) throw std::runtime_error(target.string() + ": could not be written");
    } catch (...) {
        removeQuietly(aside);
        throw;
    }
    removeQuietly(aside);
}

} // namespace

void refuseUnwritable(const fs::path& named) {
    if (isStream(named)) return;
    const fs::path target = linked(named), folder = folderOf(target);
    if (!fs::is_directory(folder)) throw InputError(target.string(), "", "its folder does not exist");
    if (fs::is_directory(target))
        throw InputError(target.string(), "", "is a folder, expected a file to write");
    if (::access(folder.c_str(), W_OK) != 0)
        throw InputError(target.string(), "", "its folder cannot be written to");
}

void writeWhole(const fs::path& named, const std::function<void(const fs::path&)>& write) {
    if (isStream(named)) return writeStream(named, write);
    const fs::path target = linked(named);
    refuseUnwritable(target);
    const fs::path folder = folderOf(target);
    const fs::path aside =
        folder / fmt::format(".{}.{}{}", target.stem().string(), ::getpid(), target.extension().string());
    try {
        write(aside);
        fs::rename(aside, target);
    } catch (...) {
        removeQuietly(aside);
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
