// ASCII letters made small: extensions, names of columns and fields, whatever a user may write either way.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>

namespace heliodon::geometry {

// Other bytes, those of UTF-8 among them, stay, whatever the locale.
inline std::string lowered(std::string_view text) {
    std::string out(text);
    std::ranges::transform(
        out, out.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return out;
}

// ".obj" of "Room.OBJ"; empty where there is none.
inline std::string loweredExtension(const std::filesystem::path& file) {
    return lowered(file.extension().string());
}

} // namespace heliodon::geometry
