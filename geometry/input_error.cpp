#include "geometry/input_error.h"

namespace heliodon::geometry {

InputError::InputError(const std::string& file, const std::string& place, const std::string& what)
    : std::runtime_error(file + (place.empty() ? "" : ":" + place) + ": " + what) {}

} // namespace heliodon::geometry
