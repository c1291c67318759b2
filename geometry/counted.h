// Counts in messages.
#pragma once

#include <cstddef>
#include <string>

namespace heliodon::geometry {

// "1 wall", "2 walls".
inline std::string counted(size_t count, const std::string& what) {
    return std::to_string(count) + ' ' + what + (count == 1 ? "" : "s");
}

// "1 wall was", "2 walls were".
inline std::string countedWere(size_t count, const std::string& what) {
    return counted(count, what) + (count == 1 ? " was" : " were");
}

// A warning: of what stands outside.
inline std::string solidsOutside(size_t count) {
    return counted(count, "solid") +
           (count == 1 ? " stands outside of all rooms: it was not taken as one"
                       : " stand outside of all rooms: none was taken as one");
}

} // namespace heliodon::geometry
