// Pictures to files, whole or not at all. Throws geometry::InputError when the folder cannot be written to,
// std::runtime_error when the writing itself fails.
#pragma once

#include <filesystem>

#include "engine/passes/picture.h"

namespace heliodon::passes {

void writePng(const Image8& picture, const std::filesystem::path& file);

// OpenEXR 2, one part of scan lines, three 32-bit float channels, not compressed, Rec. 709 primaries.
void writeExr(const ImageF& picture, const std::filesystem::path& file);

} // namespace heliodon::passes
