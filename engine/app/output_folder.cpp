#include "engine/app/output_folder.h"

#include <cctype>
#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "geometry/input_error.h"

namespace heliodon::app {

namespace fs = std::filesystem;

namespace {

// A folder of that name would be taken for a broken file.
void refuseNameOfFile(const fs::path& folder) {
    std::string extension = folder.extension().string();
    for (char& letter : extension)
        letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    for (const char* film : {".mp4", ".avi", ".mov", ".mkv", ".m4v", ".webm", ".gif"})
        if (extension == film)
            throw geometry::InputError(folder.string(), "",
                                       "is no name of a folder, and films are written as .mp4");
    for (const char* file : {".png", ".jpg", ".jpeg", ".tif", ".exr", ".svg", ".csv", ".json", ".npy"})
        if (extension == file)
            throw geometry::InputError(folder.string(), "", "is the name of a file, expected a folder");
}

} // namespace

OutputFolder::OutputFolder(const fs::path& named) {
    // A slash at the end would count as a folder more, without a name.
    const fs::path folder = named.has_filename() ? named : named.parent_path();
    std::error_code error;
    if (!fs::is_directory(folder, error)) refuseNameOfFile(folder);
    for (fs::path at = folder; !at.empty() && !fs::exists(at, error); at = at.parent_path())
        made_.push_back(at);
    fs::create_directories(folder, error);
    if (!fs::is_directory(folder))
        throw geometry::InputError(folder.string(), "", "is not a folder and cannot be made one");
    if (::access(folder.c_str(), W_OK) != 0)
        throw geometry::InputError(folder.string(), "", "cannot be written to");
    handle_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (handle_ < 0 || ::flock(handle_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
    ::close(handle_);
    throw geometry::InputError(folder.string(), "",
                               "another run is writing into it, expected a folder of its own");
}

OutputFolder::~OutputFolder() {
    std::error_code notEmpty;
    for (const fs::path& folder : made_)
        if (!fs::remove(folder, notEmpty)) break;
    if (handle_ >= 0) ::close(handle_);
}

} // namespace heliodon::app
