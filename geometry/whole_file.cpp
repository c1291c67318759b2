#include "geometry/whole_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "geometry/input_error.h"

namespace heliodon::geometry {

namespace fs = std::filesystem;

namespace {

// What a link names, there or not; circles end.
fs::path linked(fs::path target) {
    std::error_code none;
    for (int links = 0; links < 40 && fs::is_symlink(target, none); ++links)
        target = target.parent_path() / fs::read_symlink(target);
    return target;
}

// A descriptor of this program, "/dev/stdout" or "/dev/fd/3", also through links that a user made. What is
// behind it, a file too, belongs to whoever opened it: it is written to where it stands, not replaced.
std::optional<int> descriptorOf(fs::path target) {
    for (int links = 0; links < 40; ++links) {
        const std::string name = target.string();
        if (name == "/dev/stdout") return STDOUT_FILENO;
        if (name == "/dev/stderr") return STDERR_FILENO;
        for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"}) {
            if (!name.starts_with(folder)) continue;
            int number = -1;
            const char* const last = name.data() + name.size();
            const auto [end, error] = std::from_chars(name.data() + folder.size(), last, number);
            if (error == std::errc() && end == last && number >= 0) return number;
        }
        std::error_code none;
        if (!fs::is_symlink(target, none)) return std::nullopt;
        target = target.parent_path() / fs::read_symlink(target);
    }
    return std::nullopt;
}

void writeDescriptor(int descriptor, const fs::path& named, std::istream& in) {
    std::fflush(stdout); // what was said before comes before
    std::array<char, 1 << 16> chunk{};
    while (in.read(chunk.data(), chunk.size()), in.gcount() > 0)
        for (std::streamsize done = 0; done < in.gcount();) {
            const ssize_t written =
                ::write(descriptor, chunk.data() + done, static_cast<size_t>(in.gcount() - done));
            if (written < 0 && errno == EINTR) continue;
            if (written <= 0)
                throw std::runtime_error(fmt::format("{}: could not be written: {}", named.string(),
                                                     std::system_category().message(errno)));
            done += written;
        }
}

fs::path folderOf(const fs::path& target) {
    return target.has_parent_path() ? target.parent_path() : fs::path(".");
}

// Where process numbers mean the same: this machine, and the space of numbers that a container may have of
// its own.
const std::string& processSpace() {
    static const std::string space = [] {
        char host[256]{};
        ::gethostname(host, sizeof host - 1);
        struct stat numbers {};
        ::stat("/proc/self/ns/pid", &numbers);
        // Machines may share a folder and a name, but not their last start.
        std::string boot;
        std::ifstream("/proc/sys/kernel/random/boot_id") >> boot;
        return fmt::format("{:016x}", std::hash<std::string>()(fmt::format("{} {} {} {}", host, boot,
                                                                           numbers.st_dev, numbers.st_ino)));
    }();
    return space;
}

// ".NAME.heliodon-SPACE-PROCESS" before the extension: whose file it is, where it is one of asideOf's.
bool isOfDeadProcess(const fs::path& file) {
    const std::string name = file.filename().string(), mark = ".heliodon-" + processSpace() + "-";
    const size_t at = name.rfind(mark);
    if (!name.starts_with(".") || at == std::string::npos) return false;
    const char *first = name.data() + at + mark.size(),
               *last = name.data() + std::min(name.find('.', at + mark.size()), name.size());
    pid_t process = 0;
    const auto [end, error] = std::from_chars(first, last, process);
    return error == std::errc() && end == last && process > 0 && ::kill(process, 0) != 0 && errno == ESRCH;
}

// Bytes that a name in the folder may have.
size_t longestName(const fs::path& folder) {
    const long most = ::pathconf(folder.c_str(), _PC_NAME_MAX);
    return most > 0 ? static_cast<size_t>(most) : NAME_MAX;
}

void removeQuietly(const fs::path& file) {
    std::error_code ignored;
    fs::remove(file, ignored);
}

// Once for each folder: a long time-lapse writes many files into one.
void removeLeftOvers(const fs::path& folder) {
    static std::mutex mutex;
    static std::set<fs::path> done;
    std::error_code error;
    {
        const std::lock_guard lock(mutex);
        if (!done.insert(fs::absolute(folder, error)).second) return;
    }
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
        if (isOfDeadProcess(entry->path())) removeQuietly(entry->path());
}

void writeStream(const fs::path& target, const std::function<void(const fs::path&)>& write) {
    // No name that others could foresee and put a link at.
    const std::string extension = target.extension().string();
    std::string name = (fs::temp_directory_path() / ("heliodon-XXXXXX" + extension)).string();
    const int handle = ::mkstemps(name.data(), static_cast<int>(extension.size()));
    if (handle < 0)
        throw std::runtime_error(fmt::format("{}: {}", name, std::system_category().message(errno)));
    ::close(handle);
    const fs::path aside = name;
    try {
        write(aside);
        std::ifstream in(aside, std::ios::binary);
        if (const auto descriptor = descriptorOf(target)) {
            writeDescriptor(*descriptor, target, in);
        } else {
            std::ofstream out(target, std::ios::binary);
            out << in.rdbuf();
            if (!out.flush()) throw std::runtime_error(target.string() + ": could not be written");
        }
    } catch (...) {
        removeQuietly(aside);
        throw;
    }
    removeQuietly(aside);
}

} // namespace

bool isStream(const fs::path& target) {
    if (descriptorOf(target)) return true;
    std::error_code unknown;
    const fs::file_status status = fs::status(target, unknown);
    return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

fs::path asideOf(const fs::path& target) {
    const fs::path folder = folderOf(target);
    removeLeftOvers(folder);
    const auto named = [&](const std::string& stem) {
        return fmt::format(".{}.heliodon-{}-{}{}", stem, processSpace(), ::getpid(),
                           target.extension().string());
    };
    const std::string name = named(target.stem().string());
    const size_t longest = longestName(folder);
    if (name.size() <= longest || target.filename().string().size() > longest) return folder / name;
    // The target's has room in the folder, this one has not.
    return folder / named(fmt::format("{:016x}", std::hash<std::string>()(target.stem().string())));
}

fs::path placeOf(const fs::path& named) {
    std::error_code unknown;
    const fs::path place = fs::weakly_canonical(linked(named), unknown);
    if (unknown) return {};
    return place.has_filename() ? place : place.parent_path(); // a folder that is not there keeps its slash
}

bool isSamePlace(const fs::path& a, const fs::path& b) {
    const fs::path place = placeOf(a);
    return !place.empty() && place == placeOf(b);
}

bool leadsTo(const fs::path& named, const fs::path& place) {
    std::error_code none;
    return (named.filename() == place.filename() || fs::is_symlink(named, none)) && placeOf(named) == place;
}

void refuseUnwritable(const fs::path& named) {
    if (const auto descriptor = descriptorOf(named)) {
        const int flags = ::fcntl(*descriptor, F_GETFL);
        if (flags < 0 || (flags & O_ACCMODE) == O_RDONLY)
            throw InputError(named.string(), "", "is not open for writing");
        return;
    }
    if (isStream(named)) return;
    const fs::path target = linked(named), folder = folderOf(target);
    if (!fs::is_directory(folder)) throw InputError(target.string(), "", "its folder does not exist");
    if (fs::is_directory(target))
        throw InputError(target.string(), "", "is a folder, expected a file to write");
    if (::access(folder.c_str(), W_OK) != 0)
        throw InputError(target.string(), "", "its folder cannot be written to");
}

void writeWhole(const fs::path& named, const std::function<void(const fs::path&)>& write) {
    refuseUnwritable(named);
    if (isStream(named)) return writeStream(named, write);
    const fs::path target = linked(named);
    const fs::path aside = asideOf(target);
    try {
        write(aside);
        fs::rename(aside, target);
    } catch (...) {
        removeQuietly(aside);
        throw;
    }
}

void writeTextAside(const fs::path& aside, const fs::path& target, std::string_view text) {
    errno = 0;
    std::ofstream out(aside, std::ios::binary);
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    if (!out.flush())
        throw std::runtime_error(
            fmt::format("{}: could not be written: {}", target.string(),
                        errno != 0 ? std::system_category().message(errno) : "is the disk full?"));
}

void writeWholeText(const fs::path& target, std::string_view text) {
    writeWhole(target, [&](const fs::path& aside) { writeTextAside(aside, target, text); });
}

} // namespace heliodon::geometry
