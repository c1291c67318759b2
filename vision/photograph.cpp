#include "vision/photograph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "geometry/input_error.h"
#include "geometry/picture_file.h"
#include "vision/grey_picture.h"

namespace heliodon::vision {

namespace {

// The chunks of a PNG, after its signature, up to the last.
bool isWholePng(const std::vector<uint8_t>& bytes) {
    for (size_t at = 8; at + 12 <= bytes.size();) {
        const size_t length = (size_t{bytes[at]} << 24) | (size_t{bytes[at + 1]} << 16) |
                              (size_t{bytes[at + 2]} << 8) | bytes[at + 3];
        if (std::equal(bytes.begin() + static_cast<std::ptrdiff_t>(at) + 4,
                       bytes.begin() + static_cast<std::ptrdiff_t>(at) + 8, "IEND"))
            return true;
        at += 12 + length;
    }
    return false;
}

// The segments of a JPEG up to the end marker; a preview within one of them has an end marker of its own.
bool isWholeJpeg(const std::vector<uint8_t>& bytes) {
    constexpr uint8_t kEnd = 0xD9, kScan = 0xDA;
    size_t at = 2;
    while (at + 4 <= bytes.size()) {
        if (bytes[at] != 0xFF) return true; // not as expected: the decoder's business
        const uint8_t marker = bytes[at + 1];
        if (marker == kEnd) return true;
        if (marker == 0xFF) { // padding
            ++at;
            continue;
        }
        at += 2 + ((size_t{bytes[at + 2]} << 8) | bytes[at + 3]);
        if (marker != kScan) continue;
        // Coded data: a 0xFF in it is followed by 0 or by a restart marker.
        while (at + 1 < bytes.size() &&
               !(bytes[at] == 0xFF && bytes[at + 1] != 0 && (bytes[at + 1] & 0xF8) != 0xD0))
            ++at;
    }
    return at + 1 < bytes.size() && bytes[at] == 0xFF && bytes[at + 1] == kEnd;
}

bool isPng(const std::vector<uint8_t>& bytes) {
    constexpr std::array<uint8_t, 8> kPng = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    return bytes.size() >= kPng.size() && std::equal(kPng.begin(), kPng.end(), bytes.begin());
}
bool isJpeg(const std::vector<uint8_t>& bytes) {
    return bytes.size() >= 3 && bytes[0] == 0xFF && bytes[1] == 0xD8 && bytes[2] == 0xFF;
}

// Decoders read what is there of a file that was cut short and leave the rest grey.
bool isCutShort(const std::vector<uint8_t>& bytes) {
    if (isPng(bytes)) return !isWholePng(bytes);
    if (isJpeg(bytes)) return !isWholeJpeg(bytes);
    return false;
}

// From the mean of the first table of quantization, of brightness, against that of ITU-T T.81, K.1, by
// libjpeg's scale. 100 where none is found.
int jpegQuality(const std::vector<uint8_t>& bytes) {
    constexpr uint8_t kTables = 0xDB, kScan = 0xDA;
    constexpr size_t kValues = 64;
    constexpr double kMeanOfStandard = 3688.0 / kValues;
    for (size_t at = 2; at + 5 <= bytes.size() && bytes[at] == 0xFF && bytes[at + 1] != kScan;) {
        if (bytes[at + 1] != kTables) {
            at += 2 + ((size_t{bytes[at + 2]} << 8) | bytes[at + 3]);
            continue;
        }
        const size_t wide = bytes[at + 4] >> 4 ? 2 : 1, first = at + 5; // bytes of a value, low one last
        if (first + wide * kValues > bytes.size()) break;
        double sum = 0;
        for (size_t i = 0; i < kValues; ++i)
            sum += wide == 2 ? 256 * bytes[first + 2 * i] + bytes[first + 2 * i + 1] : bytes[first + i];
        const double scale = std::max(1.0, 100 * sum / kValues / kMeanOfStandard);
        return std::clamp(static_cast<int>(std::lround(scale <= 100 ? (200 - scale) / 2 : 5000 / scale)), 1,
                          100);
    }
    return 100;
}

std::vector<uint8_t> bytesOf(const std::filesystem::path& file) {
    std::error_code gone;
    const uintmax_t size = std::filesystem::file_size(file, gone);
    std::vector<uint8_t> bytes(gone ? 0 : size); // at once: a photograph waits for it
    std::ifstream(file, std::ios::binary)
        .read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return bytes;
}

// The pixels as the sensor has them: the rig was calibrated on those, so no rotation by EXIF.
template<class Picture>
Picture readOrComplain(std::optional<Picture> (*read)(const std::filesystem::path&),
                       const std::filesystem::path& file, int* quality = nullptr) {
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored))
        throw geometry::InputError(file.string(), "", "is a folder, expected a photograph (png, jpg or tif)");
    if (!std::filesystem::is_regular_file(file, ignored))
        throw geometry::InputError(file.string(), "",
                                   "no such file, expected a photograph (png, jpg or tif)");
    const std::vector<uint8_t> bytes = bytesOf(file);
    if (isCutShort(bytes))
        throw geometry::InputError(file.string(), "", "the picture is cut short, expected a whole file");
    auto picture = read(file);
    if (!picture)
        throw geometry::InputError(file.string(), "",
                                   "not an image that can be read, expected png, jpg or tif");
    if (quality && isJpeg(bytes)) *quality = jpegQuality(bytes);
    return std::move(*picture);
}

} // namespace

Photograph readPhotograph(const std::filesystem::path& file) {
    int quality = 100;
    auto picture = readOrComplain(geometry::readPictureFile, file, &quality);
    return {picture.width, picture.height, std::move(picture.rgb), file.string(), quality};
}

bool hasColor(const Photograph& photo) {
    for (size_t i = 0; i + 2 < photo.rgb.size(); i += 3)
        if (photo.rgb[i] != photo.rgb[i + 1] || photo.rgb[i] != photo.rgb[i + 2]) return true;
    return false;
}

GreyPicture readGrey(const std::filesystem::path& file) {
    auto picture = readOrComplain(geometry::readGreyFile, file);
    return {picture.width, picture.height, std::move(picture.values)};
}

} // namespace heliodon::vision
