#include "geometry/input_error.h"

#include <algorithm>
#include <utility>

namespace heliodon::geometry {

std::string printable(std::string text) {
    std::ranges::replace_if(
        text, [](unsigned char c) { return c < ' ' || c == 0x7F; }, '?');
    return text;
}

InputError::InputError(const std::string& file, const std::string& place, const std::string& what,
                       ModelPlace where)
    : std::runtime_error(printable(file + (place.empty() ? "" : ":" + place) + ": " + what)),
      where_(std::move(where)) {}

InputError::InputError(const InputError& error, const std::string& more)
    : std::runtime_error(printable(error.what() + more)), where_(error.where_) {}

} // namespace heliodon::geometry
