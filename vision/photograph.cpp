#include "vision/photograph.h"

#include <array>
#include <cmath>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "geometry/input_error.h"
#include "geometry/picture_file.h"
#include "vision/grey_picture.h"
#include "vision/picture_header.h"

namespace heliodon::vision {

namespace {

// Larger ones are refused before they are decoded: three bytes a pixel, twice for a moment.
constexpr uint64_t kMostPixels = 250'000'000;

// The pixels as the sensor has them: the rig was calibrated on those, and the turn that EXIF states is chance
// where a telephone looks straight down.
template<class Picture>
Picture readOrComplain(std::optional<Picture> (*pictureIn)(const std::vector<uint8_t>&),
                       const std::filesystem::path& file, std::vector<uint8_t>* content = nullptr) {
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored))
        throw geometry::InputError(file.string(), "", "is a folder, expected a photograph (png, jpg or tif)");
    if (!std::filesystem::is_regular_file(file, ignored))
        throw geometry::InputError(file.string(), "",
                                   "no such file, expected a photograph (png, jpg or tif)");
    std::vector<uint8_t> bytes = geometry::bytesOf(file);
    if (const auto size = pictureSize(bytes); size && size->first * size->second > kMostPixels)
        throw geometry::InputError(file.string(), "",
                                   fmt::format("{} x {} pixels, expected at most {} million in all",
                                               size->first, size->second, kMostPixels / 1000000));
    if (isCutShort(bytes))
        throw geometry::InputError(file.string(), "", "the picture is cut short, expected a whole file");
    if (isDamaged(bytes))
        throw geometry::InputError(file.string(), "",
                                   "the picture is damaged: a checksum in it is not that of its data");
    if (const auto damage = geometry::jpegDamageIn(bytes))
        throw geometry::InputError(file.string(), "", "the picture is damaged: " + *damage);
    auto picture = pictureIn(bytes);
    if (!picture)
        throw geometry::InputError(file.string(), "",
                                   "not an image that can be read, expected png, jpg or tif");
    if (content) *content = std::move(bytes);
    return std::move(*picture);
}

// From values that stand for light by that exponent to those of a photograph.
void encodeAgain(std::vector<uint8_t>& values, double gamma) {
    constexpr double kUsual = 2.2, kAlike = 0.1;
    if (std::abs(gamma - kUsual) < kAlike) return;
    std::array<uint8_t, 256> encoded{};
    for (size_t i = 0; i < encoded.size(); ++i)
        encoded[i] =
            static_cast<uint8_t>(std::lround(255 * std::pow(static_cast<double>(i) / 255, gamma / kUsual)));
    for (uint8_t& value : values) value = encoded[value];
}

} // namespace

Photograph readPhotograph(const std::filesystem::path& file) {
    std::vector<uint8_t> bytes;
    auto picture = readOrComplain(geometry::pictureIn, file, &bytes);
    if (const auto gamma = statedGamma(bytes)) encodeAgain(picture.rgb, *gamma);
    return {picture.width, picture.height,     std::move(picture.rgb),
            file.string(), jpegQuality(bytes), chromaStep(bytes)};
}

bool hasColor(const Photograph& photo) {
    for (size_t i = 0; i + 2 < photo.rgb.size(); i += 3)
        if (photo.rgb[i] != photo.rgb[i + 1] || photo.rgb[i] != photo.rgb[i + 2]) return true;
    return false;
}

GreyPicture readGrey(const std::filesystem::path& file) {
    auto picture = readOrComplain(geometry::greyPictureIn, file);
    return {picture.width, picture.height, std::move(picture.values)};
}

} // namespace heliodon::vision
