// Text and JSON files that are read as a whole, with one way to complain about them.
#pragma once

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string>

#include <nlohmann/json.hpp>

#include "geometry/input_error.h"

namespace heliodon::geometry {

// Throws InputError where it is missing, a folder, or cannot be read. `expected` ends the message: "a rig
// (vh-rig/1)".
std::string readText(const std::filesystem::path& file, const std::string& expected);

// For readers of other kinds of file: throws what readText would.
void refuseUnreadable(const std::filesystem::path& file, const std::string& expected);
void refuseUtf16(const std::filesystem::path& file, const std::string& text);

// The same, and InputError with the line where it stops being JSON. Json: nlohmann::json or ordered_json.
template<class Json = nlohmann::json>
Json readJson(const std::filesystem::path& file, const std::string& expected) {
    const std::string text = readText(file, expected);
    try {
        return Json::parse(text);
    } catch (const nlohmann::json::parse_error& error) {
        const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
        const auto line = std::find(std::make_reverse_iterator(end), text.rend(), '\n').base();
        throw InputError(file.string(), std::to_string(1 + std::count(text.begin(), end, '\n')),
                         "is not JSON here (character " +
                             std::to_string(std::max<std::ptrdiff_t>(end - line, 1)) +
                             " of the line), expected " + expected);
    } catch (const nlohmann::json::out_of_range&) { // the parser's word for a number beyond double
        throw InputError(file.string(), "", "holds a number too large to represent");
    }
}

// As it is written to files; bytes that are no UTF-8, as in names of files, are replaced.
template<class Json> std::string jsonText(const Json& json, int indent = 2) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

// `text` if it is UTF-8, else read as Windows-1252 (ISO 8859-1 and more), which old files are in.
std::string asUtf8(const std::string& text);

} // namespace heliodon::geometry
