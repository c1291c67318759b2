#include "engine/app/live_script.h"

#include <cctype>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "engine/app/moment.h"
#include "engine/present/operator_window.h"
#include "geometry/input_error.h"
#include "geometry/text_file.h"

namespace heliodon::app {

namespace {

using geometry::InputError;

class Line {
public:
    Line(std::string text, std::string source) : in_(std::move(text)), source_(std::move(source)) {}

    [[noreturn]] void refuse(const std::string& why) const { throw InputError(source_, "", why); }
    std::string word(const std::string& what) {
        std::string text;
        if (!(in_ >> text)) refuse("expected " + what);
        return text;
    }
    double number(const std::string& what, double low, double high) {
        double value = 0;
        if (!(in_ >> value) || !(value >= low && value <= high))
            refuse(fmt::format("expected {} from {} to {}", what, low, high));
        return value;
    }
    size_t count(const std::string& what, size_t low, size_t high) {
        const double value = number(what, static_cast<double>(low), static_cast<double>(high));
        if (value != std::floor(value)) refuse(fmt::format("expected {} as a whole number", what));
        return static_cast<size_t>(value);
    }
    bool optional(std::string& text) { return static_cast<bool>(in_ >> text); }
    const std::string& source() const { return source_; }

private:
    std::istringstream in_;
    std::string source_;
};

int keyOf(const std::string& name) {
    if (name == "space") return ' ';
    if (name == "escape") return present::kEscapeKey;
    return name.size() == 1 ? std::toupper(static_cast<unsigned char>(name[0])) : 0;
}

void readModifiers(Line& line, present::Event& event) {
    for (std::string word; line.optional(word);) {
        if (word == "shift")
            event.shift = true;
        else if (word == "ctrl")
            event.control = true;
        else
            line.refuse("'" + word + "' is neither shift nor ctrl");
    }
}

std::string skyOf(Line& line, bool weather) {
    const std::string sky = line.word("a sky");
    if (sky == present::kWeatherFile) {
        if (!weather) line.refuse("there is no weather file, expected --weather FILE.epw");
        return sky;
    }
    try {
        const SkySource source({}, sky, 0);
        source.skyAt(source.moment());
    } catch (const InputError& error) {
        line.refuse(error.what());
    }
    return sky;
}

ScriptStep stepOf(const std::string& verb, Line& line, size_t windows, bool weather) {
    if (verb == "wait") return WaitStep{};
    if (verb == "look") return LookStep{line.count("times", 1, 1'000'000)};
    if (verb == "quit") return QuitStep{};
    if (verb == "sleep") return SleepStep{line.number("seconds", 0, 86400)};
    if (verb == "time") return TimeStep{daylight::parseTime(line.word("a time"), line.source())};
    if (verb == "sky") return SkyStep{skyOf(line, weather)};
    if (verb == "close") return CloseStep{line.count("a window", 0, windows - 1)};
    if (verb == "snapshot") {
        const std::string name = line.word("a name");
        if (name.find('/') != std::string::npos) line.refuse("a snapshot's name is no path");
        return SnapshotStep{name};
    }
    if (verb == "resize") {
        const size_t window = line.count("a window", 0, windows - 1);
        const auto width = static_cast<int>(line.count("a width", 1, 16384));
        return ResizeStep{window, width, static_cast<int>(line.count("a height", 1, 16384))};
    }
    present::Event event;
    if (verb == "wheel") {
        event.kind = present::Event::Kind::wheel;
        event.notches = line.number("notches", -1e6, 1e6);
    } else if (verb == "key") {
        const std::string name = line.word("a key");
        event.key = keyOf(name);
        if (event.key == 0) line.refuse("'" + name + "' is no key, expected a letter, space or escape");
    } else {
        line.refuse("'" + verb + "' is nothing that a script does, heliodon live --help lists what is");
    }
    readModifiers(line, event);
    return EventStep{event};
}

} // namespace

std::vector<ScriptStep> readScript(const std::filesystem::path& file, size_t windows, bool weather) {
    const std::string expected = "a script, a step a line", script = geometry::readText(file, expected);
    geometry::refuseOtherKinds(file, script, expected); // whose lines may be endless
    std::istringstream in(script);
    std::vector<ScriptStep> steps;
    size_t number = 0;
    for (std::string text; std::getline(in, text);) {
        ++number;
        Line line(text.substr(0, text.find('#')), fmt::format("{}:{}", file.string(), number));
        std::string verb, more;
        if (!line.optional(verb)) continue;
        steps.push_back(stepOf(verb, line, windows, weather));
        if (line.optional(more)) line.refuse("'" + more + "' is one word too many");
    }
    return steps;
}

} // namespace heliodon::app
