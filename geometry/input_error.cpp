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

InputError::InputError(const InputError& error, const std::vector<glm::dvec3>& border,
                       const std::string& said)
    : std::runtime_error([&] {
          std::string text = error.what();
          const std::string& before = error.where_.said;
          const size_t at = before.empty() ? std::string::npos : text.find(before);
          return at == std::string::npos ? text + said : text.replace(at, before.size(), said);
      }()),
      where_{error.where_.faces, border, said, error.where_.isOpen} {}

} // namespace heliodon::geometry
