// The module behind picture_file.h. Nothing is thrown out of it.
#include <array>
#include <fstream>
#include <string>
#include <vector>

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "geometry/film_codec.h"
#include "geometry/jpeg_damage.h"
#include "geometry/picture_file.h"

namespace heliodon::geometry {

namespace {

// What says that the colours are sRGB (PNG, third edition, 11.3.2.5): length, name, perceptual intent, check.
constexpr std::array<uint8_t, 13> kSrgbChunk{0, 0, 0, 1, 's', 'R', 'G', 'B', 0, 0xAE, 0xCE, 0x1C, 0xE9};
constexpr std::ptrdiff_t kAfterPngHeader = 33;

cv::Mat bgrOf(int width, int height, const uint8_t* rgb) {
    cv::Mat bgr;
    cv::cvtColor(cv::Mat(height, width, CV_8UC3, const_cast<uint8_t*>(rgb)), bgr, cv::COLOR_RGB2BGR);
    return bgr;
}

// Sets the orientation that a TIFF's first directory states to the usual one; other bytes stay as they are.
void forgetTurn(std::vector<uint8_t>& bytes) {
    constexpr size_t kOrientation = 274;
    const bool highFirst = !bytes.empty() && bytes[0] == 'M';
    const auto number = [&](size_t at, size_t count) { // 0 beyond the end
        size_t value = 0;
        for (size_t i = 0; i < count && count <= bytes.size() && at <= bytes.size() - count; ++i)
            value = value << 8 | bytes[highFirst ? at + i : at + count - 1 - i];
        return value;
    };
    if (number(0, 2) != (highFirst ? 0x4D4D : 0x4949)) return;
    const size_t version = number(2, 2);
    if (version != 42 && version != 43) return;
    const bool big = version == 43; // numbers of eight bytes
    const size_t directory = big ? number(8, 8) : number(4, 4), count = big ? 8 : 2, entry = big ? 20 : 12;
    if (directory >= bytes.size()) return;
    const size_t entries = number(directory, count);
    for (size_t i = 0, at = directory + count; i < entries && at + entry <= bytes.size(); ++i, at += entry)
        if (const size_t value = at + (big ? 12 : 8); number(at, 2) == kOrientation)
            bytes[value] = highFirst ? 0 : 1, bytes[value + 1] = highFirst ? 1 : 0;
}

// OpenCV follows the orientation of a TIFF in spite of the flag. Its own lines about a file come before ours,
// which names it.
cv::Mat imageIn(std::vector<uint8_t> bytes, int flags) {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    forgetTurn(bytes);
    return bytes.empty() ? cv::Mat() : cv::imdecode(bytes, flags | cv::IMREAD_IGNORE_ORIENTATION);
}

std::optional<PicturePixels> picture(const std::vector<uint8_t>& bytes) {
    try {
        const cv::Mat bgr = imageIn(bytes, cv::IMREAD_COLOR);
        if (bgr.empty()) return std::nullopt;
        PicturePixels out{bgr.cols, bgr.rows, {}};
        out.rgb.resize(static_cast<size_t>(bgr.cols) * static_cast<size_t>(bgr.rows) * 3);
        cv::cvtColor(bgr, cv::Mat(bgr.rows, bgr.cols, CV_8UC3, out.rgb.data()), cv::COLOR_BGR2RGB);
        return out;
    } catch (const cv::Exception&) { // a header that promises more than OpenCV is willing to allocate
        return std::nullopt;
    }
}

std::optional<GreyPixels> greyPicture(const std::vector<uint8_t>& bytes) {
    try {
        // Without IMREAD_COLOR: one channel.
        const cv::Mat grey = imageIn(bytes, cv::IMREAD_ANYDEPTH);
        if (grey.empty() || (grey.depth() != CV_8U && grey.depth() != CV_16U)) return std::nullopt;
        GreyPixels out{grey.cols, grey.rows, std::vector<float>(grey.total())};
        cv::Mat values(grey.rows, grey.cols, CV_32FC1, out.values.data());
        grey.convertTo(values, CV_32F, 1.0 / (grey.depth() == CV_16U ? 65535 : 255));
        return out;
    } catch (const cv::Exception&) { // as above
        return std::nullopt;
    }
}

bool writePng(const std::filesystem::path& file, int width, int height, const uint8_t* rgb) {
    try {
        // Not by OpenCV: it does not look whether all of it was written. A compression asked for, whichever,
        // would have each row filtered in five ways: three times the time for a tenth of the bytes.
        std::vector<uint8_t> bytes;
        if (!cv::imencode(".png", bgrOf(width, height, rgb), bytes)) return false;
        bytes.insert(bytes.begin() + kAfterPngHeader, kSrgbChunk.begin(), kSrgbChunk.end());
        std::ofstream out(file, std::ios::binary);
        out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        return static_cast<bool>(out.flush());
    } catch (const cv::Exception&) {
        return false;
    }
}

} // namespace

} // namespace heliodon::geometry

extern "C" const heliodon::geometry::PictureCodecs heliodonPictureCodecs;
const heliodon::geometry::PictureCodecs heliodonPictureCodecs{heliodon::geometry::kPictureCodecsVersion,
                                                              heliodon::geometry::picture,
                                                              heliodon::geometry::greyPicture,
                                                              heliodon::geometry::jpegDamage,
                                                              heliodon::geometry::writePng,
                                                              heliodon::geometry::openFilm};
