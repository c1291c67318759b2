// A picture's brightness as numbers, for measuring in it.
#pragma once

#include <filesystem>
#include <vector>

#include <glm/vec2.hpp>

#include "vision/photograph.h"

namespace heliodon::vision {

struct GreyPicture {
    int width = 0, height = 0;
    std::vector<float> values; // row-major; 1 is the file's largest value

    float operator()(int x, int y) const {
        return values[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
    }
    // Bilinear; clamped to the picture.
    float at(glm::dvec2 pixel) const;
    // Whether all pixels within `margin` of this place are in the picture.
    bool holds(glm::dvec2 pixel, double margin) const;
};

GreyPicture greyOf(const Photograph& photo);

// Reads PNG, JPEG and TIFF with all of their 8 or 16 bits. Throws InputError as readPhotograph does.
GreyPicture readGrey(const std::filesystem::path& file);

// Gaussian, `sigma` in pixels; 0 or less changes nothing.
GreyPicture blurred(const GreyPicture& picture, double sigma);

} // namespace heliodon::vision
