// The one exception for what a user can mend: a wrong file, field, line or argument. The program prints
// what() after "heliodon: " and exits with 2; every other exception is a failure of the work and exits
// with 1.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

namespace heliodon::geometry {

// With '?' for the control characters, which would end a message or steer the terminal that shows it.
std::string printable(std::string text);

// Where in a model something is wrong.
struct ModelPlace {
    std::vector<uint32_t> faces;    // by their numbers in the file, the one that is named first
    std::vector<glm::dvec3> border; // both ends of each edge round a hole, world metres
    std::string said;               // of that hole, in the message
    bool isOpen = false;            // the model does not close, there or elsewhere
};

class InputError : public std::runtime_error {
public:
    // `place` is a line ("12") or a field ("walls[3].thickness"), or empty for the file as a whole. `what`
    // says what is wrong and what was expected, in one line. what() reads "file:place: what".
    InputError(const std::string& file, const std::string& place, const std::string& what,
               ModelPlace where = {});
    // The same with more behind it.
    InputError(const InputError& error, const std::string& more);
    // The same of another hole: `said` of that in place of what was said, or else behind it all.
    InputError(const InputError& error, const std::vector<glm::dvec3>& border, const std::string& said);

    const ModelPlace& where() const { return where_; } // empty where it is no place of a model

private:
    ModelPlace where_;
};

} // namespace heliodon::geometry
