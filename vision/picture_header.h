// What the bytes of a picture file say before it is decoded. PNG, JPEG and TIFF, any bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace heliodon::vision {

// Width and height in pixels, as stated; none where nothing states them.
std::optional<std::pair<uint64_t, uint64_t>> pictureSize(const std::vector<uint8_t>& bytes);

// Decoders read what is there of a PNG or JPEG file that was cut short and leave the rest grey; of a TIFF
// they complain in words of their own.
bool isCutShort(const std::vector<uint8_t>& bytes);

// Whether a part of a PNG that decoders need is not as it was written, by its checksum.
bool isDamaged(const std::vector<uint8_t>& bytes);

// 1 to 100 by libjpeg's scale; 100 where it is no JPEG or has no table.
int jpegQuality(const std::vector<uint8_t>& bytes);

// Between the values, of 255, that a JPEG tells apart of the mean colour of a square of 8 or 16 pixels: of
// red or blue less brightness, at its own scale. 0 where it is no JPEG or has no table.
double chromaStep(const std::vector<uint8_t>& bytes);

// The exponent that takes its values to light, where the file states one by itself (gAMA of a PNG); none
// where it does not or names a profile.
std::optional<double> statedGamma(const std::vector<uint8_t>& bytes);

} // namespace heliodon::vision
