// Sizes of pictures on the command line.
#pragma once

#include <string>

namespace heliodon::app {

struct PixelSize {
    int width, height;
};

// "1024x768". Throws InputError naming `option` unless both are from 16 to `most`.
PixelSize parseSize(const std::string& option, const std::string& text, int most);

} // namespace heliodon::app
