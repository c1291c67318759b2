// What hangs before a window, and how files and options say so.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace heliodon::geometry {

// What hangs before an opening to the outside, on the room's side of its glass. Grey; light by
// daylight/window.h. A fabric sends on what it passes evenly in all directions. Slats are horizontal, flat,
// thin and long against their width.
struct Blind {
    enum class Kind : uint8_t { none, fabric, slats };
    Kind kind = Kind::none;
    float transmittance = 0;  // of a fabric, diffuse; with its reflectance at most 1
    float reflectance = 0;    // of a fabric or of both faces of slats, diffuse, [0, 1)
    float slatAngleDeg = 0;   // 0: level; positive: outer edges down; [-85, 85]
    float slatSpacing = 0.8f; // over the slats' width; (0, 10]

    bool operator==(const Blind&) const = default;
};

// "open", "fabric:T[,R]" (R: half of what does not pass) or "slats:ANGLE[,R[,SPACING]]" (reflectance 0.7,
// spacing 0.8). Throws std::invalid_argument with what is wrong, for the caller to say where.
Blind parseBlind(std::string_view text);
std::string blindText(const Blind& blind); // parseBlind gives the same blind again

} // namespace heliodon::geometry
