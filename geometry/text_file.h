// Text and JSON files that are read as a whole, with one way to complain about them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace heliodon::geometry {

// Bytes of a file: devices have no end, and memory has.
constexpr size_t kLargestText = size_t{64} << 20, kLargestModel = size_t{1} << 30;

// Throws InputError where it is missing, a folder, larger than `largest` bytes, or cannot be read. `expected`
// ends the message: "a rig (vh-rig/1)".
std::string readText(const std::filesystem::path& file, const std::string& expected,
                     size_t largest = kLargestText);

// open() for reading; a pipe that nobody writes into yet is waited for until a signal comes. A descriptor, or
// -1. Throws std::runtime_error where a signal came.
int openToRead(const std::filesystem::path& file);

// For readers of other kinds of file: throws what readText would.
void refuseUnreadable(const std::filesystem::path& file, const std::string& expected);
void refuseUtf16(const std::filesystem::path& file, const std::string& text);
// A picture, an archive, a model of another program under a wrong name: says what it is by how it begins.
void refuseOtherKinds(const std::filesystem::path& file, std::string_view text, const std::string& expected);

// Throws InputError with the line at which, `byte` bytes into `text`, it stops being JSON.
[[noreturn]] void refuseNotJson(const std::filesystem::path& file, const std::string& text, size_t byte,
                                const std::string& expected);
// Throws it with the line of the number that `error`, of parsing `text`, names as beyond double.
[[noreturn]] void refuseLargeNumber(const std::filesystem::path& file, const std::string& text,
                                    const nlohmann::json::out_of_range& error);

// Throws InputError where an object of the JSON has a field twice, of which parsers keep the last; what is no
// JSON is passed over.
void refuseRepeatedFields(const std::filesystem::path& file, const std::string& text);

// As readText, and InputError with the line where it stops being JSON, or a field that is there twice. Json:
// nlohmann::json or ordered_json.
template<class Json = nlohmann::json>
Json readJson(const std::filesystem::path& file, const std::string& expected, size_t largest = kLargestText) {
    const std::string text = readText(file, expected, largest);
    // In a pass of its own: told while it parses, nlohmann's parser takes time with the square of a list.
    refuseRepeatedFields(file, text);
    try {
        return Json::parse(text);
    } catch (const nlohmann::json::parse_error& error) {
        refuseNotJson(file, text, error.byte, expected);
    } catch (const nlohmann::json::out_of_range& error) {
        refuseLargeNumber(file, text, error);
    }
}

// As it is written to files; bytes that are no UTF-8, as in names of files, are replaced.
template<class Json> std::string jsonText(const Json& json, int indent = 2) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

// `text` if it is UTF-8, else read as Windows-1252 (ISO 8859-1 and more), which old files are in.
std::string asUtf8(const std::string& text);

} // namespace heliodon::geometry
