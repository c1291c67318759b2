#include "engine/app/output_folder.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <fstream>
#include <functional>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "engine/app/run.h"
#include "geometry/input_error.h"
#include "geometry/lower_case.h"
#include "geometry/text_file.h"
#include "geometry/whole_file.h"

namespace heliodon::app {

namespace fs = std::filesystem;

namespace {

// A folder of that name would be taken for a broken file.
void refuseNameOfFile(const fs::path& folder) {
    if (folder == "-")
        throw geometry::InputError("--output", "-",
                                   "means one file to the standard output, expected a folder");
    const std::string extension = geometry::loweredExtension(folder);
    for (const char* film : {".mp4", ".avi", ".mov", ".mkv", ".m4v", ".webm", ".gif"})
        if (extension == film)
            throw geometry::InputError(folder.string(), "",
                                       "is no name of a folder, and films are written as .mp4");
    for (const char* file : {".png", ".jpg", ".jpeg", ".tif", ".exr", ".svg", ".csv", ".json", ".npy"})
        if (extension == file)
            throw geometry::InputError(folder.string(), "", "is the name of a file, expected a folder");
}

constexpr const char* kFormat = "heliodon-files/1";

// Nothing where there is no record, or one of something else.
std::vector<std::string> recorded(const fs::path& record, const std::string& command) {
    std::ifstream in(record);
    const nlohmann::json all = nlohmann::json::parse(in, nullptr, false);
    try {
        if (!all.is_object() || all.at("format") != kFormat || all.at("command") != command) return {};
        return all.at("files").get<std::vector<std::string>>();
    } catch (const nlohmann::json::exception&) {
        return {};
    }
}

fs::path recordOf(const fs::path& folder, const std::string& command) {
    return folder / (command + ".files.json");
}

void writeRecord(const fs::path& folder, const std::string& command, const std::vector<std::string>& files) {
    geometry::writeWholeText(
        recordOf(folder, command),
        geometry::jsonText(nlohmann::json{{"format", kFormat}, {"command", command}, {"files", files}}));
}

// 0 where there is none. A file that is written whole is another one than that which stood there.
ino_t numberOf(const fs::path& file) {
    struct stat status {};
    return ::stat(file.c_str(), &status) == 0 ? status.st_ino : 0;
}

// Asks for a while: a run that was killed holds what it had until its memory is given back.
template<class F> bool isFree(F take) {
    for (int tries = 0; tries < 20; ++tries) {
        if (take()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
}

} // namespace

// By a socket in Linux's own name space, which leaves nothing beside the file.
SoleFile::SoleFile(const fs::path& file) : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const std::string name = fmt::format("heliodon {:x}", std::hash<std::string>{}(geometry::placeOf(file)));
    sockaddr_un address{AF_UNIX, {}};
    name.copy(address.sun_path + 1, sizeof address.sun_path - 1);
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
    if (isFree([&] {
            return ::bind(socket_, reinterpret_cast<const sockaddr*>(&address), length) == 0 ||
                   errno != EADDRINUSE;
        }))
        return;
    ::close(socket_);
    throw geometry::InputError(file.string(), "", "another run is writing it, expected a file of its own");
}

SoleFile::~SoleFile() {
    if (socket_ >= 0) ::close(socket_);
}

void warnOfStrangers(Run& run, const fs::path& folder, std::span<const std::string> files) {
    if (files.empty()) return;
    constexpr size_t kFew = 5;
    run.warn(fmt::format("{}: {}{} stood there, not known to come from an earlier run, and {} written over",
                         folder.string(), fmt::join(files.first(std::min(files.size(), kFew)), ", "),
                         files.size() > kFew ? fmt::format(" and {} more", files.size() - kFew) : "",
                         files.size() == 1 ? "is" : "are"));
}

OutputFolder::OutputFolder(const fs::path& named)
    // A slash at the end would count as a folder more, without a name.
    : folder_(named.has_filename() ? named : named.parent_path()) {
    std::error_code error;
    if (!fs::is_directory(folder_, error)) refuseNameOfFile(folder_);
    for (fs::path at = folder_; !at.empty() && !fs::exists(at, error); at = at.parent_path())
        made_.push_back(at);
    fs::create_directories(folder_, error);
    if (std::error_code ignored; !fs::is_directory(folder_, ignored))
        throw geometry::InputError(folder_.string(), "",
                                   "is not a folder and cannot be made one" +
                                       (error ? ": " + error.message() : std::string()));
    if (::access(folder_.c_str(), W_OK) != 0)
        throw geometry::InputError(folder_.string(), "", "cannot be written to");
    handle_ = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (handle_ < 0) return;
    if (isFree([&] { return ::flock(handle_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK; })) return;
    ::close(handle_);
    throw geometry::InputError(folder_.string(), "",
                               "another run is writing into it, expected a folder of its own");
}

void OutputFolder::refuseUsed(Run& run, const std::string& command, std::vector<std::string> files) const {
    files.push_back(recordOf({}, command).string());
    run.willWrite(folder_, files);
}

void OutputFolder::startFiles(Run& run, const std::string& command, const std::vector<std::string>& files) {
    const auto isIn = [](const std::vector<std::string>& names, const std::string& name) {
        return std::ranges::find(names, name) != names.end();
    };
    const std::vector<std::string> earlier = recorded(recordOf(folder_, command), command);
    std::error_code error;
    std::vector<std::string> strangers, known;
    for (const std::string& name : files) {
        const bool isStranger = !isIn(earlier, name) && fs::exists(fs::symlink_status(folder_ / name, error));
        (isStranger ? strangers : known).push_back(name);
    }
    warnOfStrangers(run, folder_, strangers);
    files_ = earlier; // until there is another record
    if (!earlier.empty()) command_ = command;
    for (const std::string& old : earlier) {
        const bool here = !old.empty() && fs::path(old).filename() == old; // not "..", nor in another folder
        if (!here || isIn(files, old)) continue;
        if (fs::is_regular_file(fs::symlink_status(folder_ / old, error))) fs::remove(folder_ / old);
    }
    writeRecord(folder_, command, known);
    for (const std::string& name : strangers) strangers_[name] = numberOf(folder_ / name);
    files_ = files;
    command_ = command;
}

// This run, or an earlier one, and it is there.
bool OutputFolder::wrote(const std::string& name) const {
    const auto stranger = strangers_.find(name);
    return numberOf(folder_ / name) != (stranger == strangers_.end() ? 0 : stranger->second);
}

OutputFolder::~OutputFolder() {
    std::error_code unknown, notEmpty;
    if (!command_.empty()) {
        std::erase_if(files_, [&](const std::string& name) { return !wrote(name); });
        try {
            if (files_.empty())
                fs::remove(recordOf(folder_, command_), unknown);
            else
                writeRecord(folder_, command_, files_);
        } catch (const std::exception&) { // that of the beginning stays, which lists no strangers
        }
    }
    for (const fs::path& folder : made_)
        if (!fs::remove(folder, notEmpty)) break;
    if (handle_ >= 0) ::close(handle_);
}

} // namespace heliodon::app
