// An overhead photograph as the camera delivered it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace heliodon::vision {

struct Photograph {
    int width = 0, height = 0;
    std::vector<uint8_t> rgb; // row-major, 3 bytes a pixel, encoded with a gamma near 2.2 (sRGB is near)
    std::string name = "photograph"; // the file, for messages
    int jpegQuality = 100;           // 1 to 100 as libjpeg counts, of the file; 100 where it is no JPEG
    double chromaStep = 0;           // of 255, see picture_header.h
};

// Reads PNG, JPEG and TIFF, 8 or 16 bits, colour or grey; an alpha channel is dropped, another gamma that a
// PNG states is taken out. Profiles are not read. Throws InputError when the file is missing, no image, cut
// short, or of more than 250 million pixels.
Photograph readPhotograph(const std::filesystem::path& file);

// False for a grey picture: nothing can be read from it, since paint tells the walls' heights.
bool hasColor(const Photograph& photo);

} // namespace heliodon::vision
