// Pictures to files, whole or not at all. Throws geometry::InputError when the folder cannot be written to,
// std::runtime_error when the writing itself fails.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "engine/passes/picture.h"

namespace heliodon::passes {

void writePng(const Image8& picture, const std::filesystem::path& file);

// OpenEXR 2, one part of scan lines, three 32-bit float channels (half floats end at 65504, sunlit surfaces
// do not), ZIP compression, Rec. 709 primaries, which it says, and the attributes: names of at most 31 bytes,
// each once, none of those that every file has.
struct ExrAttributes {
    std::vector<std::pair<std::string, std::string>> text;
    std::vector<std::pair<std::string, float>> numbers;
};
void writeExr(const ImageF& picture, const std::filesystem::path& file, const ExrAttributes& attributes = {});

// Whether such a file is there to its end; what lies between is not looked at. False where there is none.
bool isWholePng(const std::filesystem::path& file);
bool isWholeExr(const std::filesystem::path& file); // as writeExr writes them

} // namespace heliodon::passes
