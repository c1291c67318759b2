// The one exception for what a user can mend: a wrong file, field, line or argument. The program prints
// what() after "heliodon: " and exits with 2; every other exception is a failure of the work and exits
// with 1.
#pragma once

#include <stdexcept>
#include <string>

namespace heliodon::geometry {

// With '?' for the control characters, which would end a message or steer the terminal that shows it.
std::string printable(std::string text);

class InputError : public std::runtime_error {
public:
    // `place` is a line ("12") or a field ("walls[3].thickness"), or empty for the file as a whole. `what`
    // says what is wrong and what was expected, in one line. what() reads "file:place: what".
    InputError(const std::string& file, const std::string& place, const std::string& what);
    // The same with more behind it.
    InputError(const InputError& error, const std::string& more);
};

} // namespace heliodon::geometry
