// Numbers in text files and options, whatever the locale.
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace heliodon::geometry {

// The finite number that all of `text` is ("1.5", "-2e3"); none for anything else, a leading + or space
// included.
inline std::optional<double> numberFrom(std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
        return std::nullopt;
    return value;
}

// The same with one leading + allowed, as files have it that spreadsheets and other programs write.
inline std::optional<double> signedNumberFrom(std::string_view text) {
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
    return numberFrom(text);
}

} // namespace heliodon::geometry
