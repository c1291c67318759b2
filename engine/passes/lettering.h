// Words in pictures: UTF-8, in DejaVu Sans, which is a part of the program.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "engine/passes/picture.h"

namespace heliodon::passes {

std::span<const uint8_t> fontFile(); // DejaVuSans.ttf

struct Lettering {
    double capital;               // height of capital letters, pixels
    std::array<uint8_t, 3> ink{}; // sRGB
    double halo = 0;              // pixels of white about the letters

    // Pixels that the words take along their line. Bytes that are no UTF-8 are read as Windows-1252;
    // characters that the font lacks are boxes.
    double width(std::string_view words) const;

    // Smaller where the words would be wider than `room` pixels.
    void shrinkTo(double room, std::string_view words);

    // `x`, `y`: left end of the baseline. What lies outside the picture is left out. The same on every run.
    void draw(Image8& picture, double x, double y, std::string_view words) const;
    // `x`, `y`: the middle of their capitals.
    void drawCentred(Image8& picture, double x, double y, std::string_view words) const;
};

} // namespace heliodon::passes
