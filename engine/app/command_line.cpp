#include "engine/app/command_line.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "geometry/field_names.h"
#include "geometry/input_error.h"
#include "geometry/model_file.h"
#include "geometry/whole_file.h"

namespace heliodon::app {

namespace fs = std::filesystem;
using geometry::InputError;

namespace {

const std::string kUnknown = ": is nothing that this command takes; --help lists what is";

// " (render?)", of what may have been meant by "redner"; nothing where nothing is like it.
std::string perhaps(const std::string& word, const std::vector<std::string>& known) {
    const std::vector<std::string_view> views(known.begin(), known.end());
    const std::string_view meant = geometry::meantBy(word, views, geometry::Alike::near);
    return meant.empty() ? "" : fmt::format(" ({}?)", meant);
}

std::string unknownOption(const CLI::App& command, const std::string& name) {
    std::vector<std::string> known;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& word : option->get_lnames()) known.push_back("--" + word);
    return name + perhaps(name, known) + kUnknown;
}

// A script's variable that was never set is not the default that its user meant to leave.
void refuseEmpty(const CLI::Option& option) {
    for (const std::string& text : option.results())
        if (text.empty()) throw InputError(option.get_name(), "", "is empty, expected a value");
}

// "nan" and "inf" are numbers to the parser, and within every range.
void refuseInfinite(const CLI::Option& option) {
    if (option.get_type_name().find("FLOAT") == std::string::npos) return;
    for (const std::string& text : option.results())
        if (!std::isfinite(std::strtod(text.c_str(), nullptr)))
            throw InputError(option.get_name(), text, "is no finite number");
}

bool isFile(const fs::path& path) {
    std::error_code none;
    return fs::is_regular_file(path, none);
}

bool isFileOrNew(const fs::path& path) {
    std::error_code none;
    return isFile(path) || fs::status(path, none).type() == fs::file_type::not_found;
}

// What is written beside an output, under a name made of its own.
std::vector<fs::path> besides(const fs::path& output) {
    if (output.extension() == ".obj") return {fs::path(output).replace_extension(".mtl")};
    return {};
}

bool isStdout(const fs::path& path) {
    return path == "-" || path == "/dev/stdout";
}

// The user has named neither the materials that a model reads nor those that are written beside one.
void refuseOverLibraries(const CLI::App& command,
                         const std::vector<std::pair<std::string, std::string>>& written) {
    const CLI::Option* input = command.get_option_no_throw("INPUT");
    const auto stands = [](const auto& nameAndFile) { return isFile(nameAndFile.second); };
    if (!input || input->empty() || std::ranges::none_of(written, stands)) return;
    for (const fs::path& library : geometry::materialFiles(input->results().front()))
        for (const auto& [name, file] : written)
            if (isFile(library) && geometry::isSamePlace(library, file))
                throw InputError(name, file, "is read by INPUT, expected another file");
}

// `calibrate` may put a rig in the old one's place.
void refuseOverwriting(const CLI::App& command) {
    const bool renewsRig = command.get_parent()->get_name() == "calibrate";
    std::vector<std::pair<std::string, std::string>> written;
    for (const char* name : {"--output", "--report", "--overlay", "--plan"}) {
        const CLI::Option* option = command.get_option_no_throw(name);
        if (!option || option->empty()) continue;
        const std::string& file = option->results().front();
        for (const auto& [other, path] : written)
            if ((isStdout(file) && isStdout(path)) ||
                (geometry::isSamePlace(file, path) && isFileOrNew(file)))
                throw InputError(name, file, "is written by " + other + " too");
        written.emplace_back(name, file);
        for (const fs::path& beside : besides(file)) written.emplace_back(name, beside.string());
    }
    for (const CLI::Option* option : command.get_options())
        for (const std::string& text : option->results())
            for (const auto& [name, file] : written)
                if (option->get_name() != name && isFile(text) && geometry::isSamePlace(text, file) &&
                    !(renewsRig && name == "--output" && option->get_name() == "--rig"))
                    throw InputError(name, file,
                                     "is read by " + option->get_name() + ", expected another file");
    refuseOverLibraries(command, written);
}

} // namespace

HelpLayout::HelpLayout() {
    label("SUBCOMMAND", "COMMAND");
}

std::string HelpLayout::make_option_name(const CLI::Option* option, bool isPositional) const {
    const std::string name = CLI::Formatter::make_option_name(option, isPositional);
    return name.substr(0, name.find('{')); // "--no-stamp{false}"
}

std::string HelpLayout::make_option_desc(const CLI::Option* option) const {
    return wrapped(option->get_description());
}

std::string HelpLayout::make_subcommand(const CLI::App* sub) const {
    std::ostringstream out;
    CLI::detail::format_help(out, sub->get_name(), wrapped(sub->get_description()), column_width_);
    return out.str();
}

std::string HelpLayout::wrapped(const std::string& text) const {
    const size_t width = 96 - column_width_;
    std::string lines, word;
    size_t used = 0;
    for (std::istringstream words(text); words >> word; used += word.size()) {
        if (used > 0) lines += used + 1 + word.size() > width ? (used = 0, '\n') : (++used, ' ');
        lines += word;
    }
    return lines;
}

const CLI::App& commandNamed(const CLI::App& app, int argc, const char* const* argv) {
    if (argc < 2) throw InputError("command line", "", "names no command; heliodon --help lists them");
    if (argv[1][0] == '-' && app.get_option_no_throw(argv[1])) return app;
    const CLI::App* command = nullptr;
    std::vector<std::string> known;
    for (const CLI::App* sub : app.get_subcommands({})) {
        known.push_back(sub->get_name());
        if (known.back() == argv[1]) command = sub;
    }
    if (!command)
        throw InputError("command line", argv[1],
                         fmt::format("is no command{}; heliodon --help lists them", perhaps(argv[1], known)));
    std::vector<std::string> steps;
    for (const CLI::App* step : command->get_subcommands({})) {
        if (argc > 2 && step->get_name() == argv[2]) return *step;
        steps.push_back(step->get_name());
    }
    if (!steps.empty() && argc < 3)
        throw InputError("command line", argv[1],
                         fmt::format("needs one of its steps: {}", fmt::join(steps, ", ")));
    if (!steps.empty() && argv[2][0] != '-')
        throw InputError("command line", argv[2],
                         fmt::format("is no step of {}{}; its steps are {}", argv[1],
                                     perhaps(argv[2], steps), fmt::join(steps, ", ")));
    return *command;
}

void refuseWords(const CLI::App& command, int argc, const char* const* argv) {
    const auto nameOf = [](const std::string& word) { return word.substr(0, word.find('=')); };
    const auto optionOf = [&](const std::string& name) {
        return name.starts_with("-") ? command.get_option_no_throw(name) : nullptr;
    };
    for (int i = 2; i < argc; ++i) {
        const std::string word = argv[i];
        if (word == "--") return; // what follows are no options
        const std::string name = nameOf(word);
        const CLI::Option* option = optionOf(name);
        if (!option && word.starts_with("--"))
            throw InputError("command line", "", unknownOption(command, name));
        if (option && word.size() == name.size() + 1)
            throw InputError(name, "", "is empty, expected a value");
        if (option && word == name && option->get_items_expected_min() > 0 && i + 1 < argc &&
            optionOf(nameOf(argv[i + 1])))
            throw InputError("command line", "",
                             fmt::format("{}: its value is missing before {}", name, argv[i + 1]));
    }
}

std::string inOurWords(const CLI::ParseError& error) {
    const std::string said = error.what();
    const size_t colon = said.find(": "), equals = said.find(" = ");
    if (colon == std::string::npos) return said;
    const std::string first = said.substr(0, colon), rest = said.substr(colon + 2);
    if (dynamic_cast<const CLI::ExtrasError*>(&error)) // "The following argument was not expected: foo"
        return rest + kUnknown;
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) // "--size: At Most 1 required but received 2"
        return first + (rest.find("received") != std::string::npos ? ": is given more than once"
                                                                   : ": its value is missing");
    if (!dynamic_cast<const CLI::ConversionError*>(&error) || equals == std::string::npos) return said;
    const std::string value = said.substr(equals + 3); // "Could not convert: --triangles = 20.5"
    double number = 0;
    return fmt::format("{}: '{}' is no {}number", said.substr(colon + 2, equals - colon - 2), value,
                       CLI::detail::lexical_cast(value, number) ? "whole " : "");
}

void refuseValues(const CLI::App& command) {
    for (const CLI::Option* option : command.get_options()) {
        refuseEmpty(*option);
        refuseInfinite(*option);
    }
    refuseOverwriting(command);
}

} // namespace heliodon::app
