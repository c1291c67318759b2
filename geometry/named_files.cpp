#include "geometry/named_files.h"

#include <algorithm>
#include <system_error>

#include "geometry/lower_case.h"

namespace heliodon::geometry {

namespace {

bool isFile(const std::filesystem::path& file) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(file, ignored);
}

std::string withSlashes(std::string name) {
    std::ranges::replace(name, '\\', '/');
    return name;
}

} // namespace

std::string unquoted(const std::string& name) {
    const bool quoted = name.size() > 1 && name.front() == '"' && name.back() == '"';
    return quoted ? name.substr(1, name.size() - 2) : name;
}

std::optional<std::filesystem::path> fileAt(const std::filesystem::path& folder, const std::string& name) {
    for (const std::string& way : {name, withSlashes(name)})
        if (isFile(folder / way)) return folder / way;
    return std::nullopt;
}

std::optional<std::filesystem::path> fileBeside(const std::filesystem::path& folder,
                                                const std::string& name) {
    const std::string last = lowered(std::filesystem::path(withSlashes(name)).filename().string());
    std::optional<std::filesystem::path> found; // the first by name
    std::error_code failed;
    for (std::filesystem::directory_iterator entry(folder.empty() ? "." : folder, failed), end;
         !failed && entry != end; entry.increment(failed)) {
        const std::string own = lowered(entry->path().filename().string());
        if (own == last && isFile(entry->path()) && (!found || entry->path() < *found)) found = entry->path();
    }
    return found;
}

} // namespace heliodon::geometry
