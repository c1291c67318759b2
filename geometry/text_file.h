// Text and JSON files that are read as a whole, with one way to complain about them.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace heliodon::geometry {

// Throws InputError where it is missing, a folder, or cannot be read. `expected` ends the message: "a rig
// (vh-rig/1)".
std::string readText(const std::filesystem::path& file, const std::string& expected);

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

// Told what a parser comes upon, throws InputError where an object has a field twice: parsers keep the last.
class RepeatedFields {
public:
    explicit RepeatedFields(std::filesystem::path file) : file_(std::move(file)) {}
    void begin(bool list); // an object or a list
    void field(const std::string& name);
    void value();
    void end();

private:
    struct Open {
        bool list = false;
        size_t count = 0;             // of a list: what was read of it
        std::string field;            // of an object: the last one,
        std::set<std::string> fields; // and all
    };
    std::string place() const;

    std::filesystem::path file_;
    std::vector<Open> open_;
};

// As readText, and InputError with the line where it stops being JSON, or a field that is there twice. Json:
// nlohmann::json or ordered_json.
template<class Json = nlohmann::json>
Json readJson(const std::filesystem::path& file, const std::string& expected) {
    const std::string text = readText(file, expected);
    RepeatedFields repeated(file);
    const auto check = [&](int, typename Json::parse_event_t event, const Json& parsed) {
        using Event = typename Json::parse_event_t;
        if (event == Event::key)
            repeated.field(parsed.template get<std::string>());
        else if (event == Event::object_start || event == Event::array_start)
            repeated.begin(event == Event::array_start);
        else if (event == Event::object_end || event == Event::array_end)
            repeated.end();
        else
            repeated.value();
        return true;
    };
    try {
        return Json::parse(text, check);
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
