// Files that a model names: where they are on this machine.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace heliodon::geometry {

std::string unquoted(const std::string& name);
// As written, or with Windows' backslashes.
std::optional<std::filesystem::path> fileAt(const std::filesystem::path& folder, const std::string& name);
// As paths of another machine mean it: the file of that name in the folder, in capitals or not.
std::optional<std::filesystem::path> fileBeside(const std::filesystem::path& folder, const std::string& name);

} // namespace heliodon::geometry
