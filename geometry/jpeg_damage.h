// What a JPEG's data lacks, which decoders paint grey or smear without an error.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace heliodon::geometry {

// libjpeg's words for the first place where data ends before the pixels or goes on after them; none where
// there is none, where a few bytes are too many or padding ends them (some cameras'), or where it is no JPEG
// with a header that can be read. Other values that make as many pixels are not noticed: a JPEG has no
// checksum. Cost: about half of decoding it.
std::optional<std::string> jpegDamage(const std::vector<uint8_t>& bytes);

} // namespace heliodon::geometry
