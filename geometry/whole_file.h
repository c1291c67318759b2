// Output files appear whole or not at all: write to a neighbour, then rename.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace heliodon::geometry {

// Calls `write` with a path in the folder of `target` (same extension, so that image writers pick the right
// format), then renames it to `target`, or to what it links to. A stream is given what was written elsewhere.
// When `write` throws, the neighbour is removed and `target` is as it was; one that a killed program has left
// since this machine was started is removed when another writes into the folder. Throws InputError when the
// folder is missing or cannot be written to.
void writeWhole(const std::filesystem::path& target,
                const std::function<void(const std::filesystem::path&)>& write);

// A pipe or a device, or a descriptor of this program (/dev/stdout, /dev/fd/3) whatever is behind it: these
// have no neighbour to rename, and are not to be replaced.
bool isStream(const std::filesystem::path& target);

// Such a neighbour of `target`, of this process alone.
std::filesystem::path asideOf(const std::filesystem::path& target);

// Throws InputError where a file cannot be written: for long work, before it begins.
void refuseUnwritable(const std::filesystem::path& target);

// What writeWhole's `write` may do; errors name `target`.
void writeTextAside(const std::filesystem::path& aside, const std::filesystem::path& target,
                    std::string_view text);

// Where what is written under a name goes, through links, there or not; empty where that cannot be told.
std::filesystem::path placeOf(const std::filesystem::path& named);

// Whether two names are of one file or folder, there or not.
bool isSamePlace(const std::filesystem::path& a, const std::filesystem::path& b);

// The same of a name and a placeOf(), which is not empty: quick where they differ.
bool leadsTo(const std::filesystem::path& named, const std::filesystem::path& place);

void writeWholeText(const std::filesystem::path& target, std::string_view text);

} // namespace heliodon::geometry
