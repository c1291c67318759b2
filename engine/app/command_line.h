// What every command has in common on the command line: how help looks, and what is refused before, while and
// after the words are parsed. Everything is refused by geometry::InputError.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace heliodon::app {

// Help of 96 columns, which terminals show without breaking words.
class HelpLayout : public CLI::Formatter {
public:
    HelpLayout();
    std::string make_option_name(const CLI::Option* option, bool isPositional) const override;
    std::string make_option_desc(const CLI::Option* option) const override;
    std::string make_subcommand(const CLI::App* sub) const override;

private:
    std::string wrapped(const std::string& text) const;
};

// The command, or the step of one, that the first words name; `app` where they begin with an option.
const CLI::App& commandNamed(const CLI::App& app, int argc, const char* const* argv);

// Throws where the command has no such option, which the parser would name only after those that are missing,
// and where an option lacks its value ("--sky=" too): the parser would take the option that follows for it.
void refuseWords(const CLI::App& command, int argc, const char* const* argv);

// What the parser complains of, in this program's words.
std::string inOurWords(const CLI::ParseError& error);

// Of a command that was parsed: values that are empty or no finite numbers, and files that are written twice,
// or written over what is read.
void refuseValues(const CLI::App& command);

} // namespace heliodon::app
