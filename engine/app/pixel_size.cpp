#include "engine/app/pixel_size.h"

#include <charconv>

#include <fmt/format.h>

#include "geometry/input_error.h"

namespace heliodon::app {

PixelSize parseSize(const std::string& option, const std::string& text, int most) {
    constexpr int kLeast = 16;
    const auto refuse = [&] {
        throw geometry::InputError(
            option, text,
            fmt::format("expected WIDTHxHEIGHT in pixels, {} to {}, as 1024x768", kLeast, most));
    };
    const auto number = [&](const std::string& digits) {
        int value = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (error != std::errc() || end != digits.data() + digits.size() || value < kLeast || value > most)
            refuse();
        return value;
    };
    const size_t times = text.find('x');
    if (times == std::string::npos) refuse();
    return {number(text.substr(0, times)), number(text.substr(times + 1))};
}

} // namespace heliodon::app
