#include "vision/picture_header.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string_view>

#include <zlib.h>

namespace heliodon::vision {

namespace {

// Of `count` bytes, the high one first or last. They must be there.
size_t numberAt(const std::vector<uint8_t>& bytes, size_t at, size_t count, bool highFirst) {
    size_t number = 0;
    for (size_t i = 0; i < count; ++i) number = number << 8 | bytes[highFirst ? at + i : at + count - 1 - i];
    return number;
}

// Where a PNG's first chunk of that name begins, its length first. Chunks follow the signature.
std::optional<size_t> chunkOf(const std::vector<uint8_t>& bytes, std::string_view name) {
    for (size_t at = 8; at + 12 <= bytes.size(); at += 12 + numberAt(bytes, at, 4, true))
        if (std::equal(name.begin(), name.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at) + 4))
            return at;
    return std::nullopt;
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
        at += 2 + numberAt(bytes, at + 2, 2, true);
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

bool isTiff(const std::vector<uint8_t>& bytes) {
    return bytes.size() >= 8 && ((bytes[0] == 'I' && bytes[1] == 'I' && bytes[2] == 42 && bytes[3] == 0) ||
                                 (bytes[0] == 'M' && bytes[1] == 'M' && bytes[2] == 0 && bytes[3] == 42));
}

using Size = std::optional<std::pair<uint64_t, uint64_t>>;

// From the frame's header.
Size jpegSize(const std::vector<uint8_t>& bytes) {
    constexpr uint8_t kScan = 0xDA, kNoFrame[] = {0xC4, 0xC8, 0xCC}; // tables and extensions
    for (size_t at = 2; at + 9 <= bytes.size() && bytes[at] == 0xFF && bytes[at + 1] != kScan;) {
        const uint8_t marker = bytes[at + 1];
        if (marker == 0xFF) { // padding
            ++at;
            continue;
        }
        if ((marker & 0xF0) == 0xC0 &&
            std::find(std::begin(kNoFrame), std::end(kNoFrame), marker) == std::end(kNoFrame))
            return std::pair{numberAt(bytes, at + 7, 2, true), numberAt(bytes, at + 5, 2, true)};
        at += 2 + numberAt(bytes, at + 2, 2, true);
    }
    return std::nullopt;
}

// From the first directory.
Size tiffSize(const std::vector<uint8_t>& bytes) {
    constexpr size_t kWidth = 256, kHeight = 257, kShort = 3, kEntry = 12;
    const bool highFirst = bytes[0] == 'M';
    const size_t directory = numberAt(bytes, 4, 4, highFirst);
    if (directory + 2 > bytes.size()) return std::nullopt;
    const size_t entries = numberAt(bytes, directory, 2, highFirst);
    std::pair<uint64_t, uint64_t> size{};
    for (size_t i = 0; i < entries; ++i) {
        const size_t at = directory + 2 + i * kEntry;
        if (at + kEntry > bytes.size()) return std::nullopt;
        const size_t tag = numberAt(bytes, at, 2, highFirst);
        const size_t wide = numberAt(bytes, at + 2, 2, highFirst) == kShort ? 2 : 4;
        if (tag == kWidth) size.first = numberAt(bytes, at + 8, wide, highFirst);
        if (tag == kHeight) size.second = numberAt(bytes, at + 8, wide, highFirst);
    }
    return size;
}

// Whether the first directory and the strips or tiles that it names are in the file.
bool isWholeTiff(const std::vector<uint8_t>& bytes) {
    constexpr size_t kShort = 3, kLong = 4, kEntry = 12;
    constexpr size_t kStrips = 273, kStripSizes = 279, kTiles = 324, kTileSizes = 325;
    const bool highFirst = bytes[0] == 'M';
    const size_t directory = numberAt(bytes, 4, 4, highFirst);
    if (directory + 2 > bytes.size()) return false;
    const size_t entries = numberAt(bytes, directory, 2, highFirst);
    if (directory + 2 + entries * kEntry > bytes.size()) return false;
    std::vector<size_t> begins, sizes;
    for (size_t i = 0; i < entries; ++i) {
        const size_t at = directory + 2 + i * kEntry, tag = numberAt(bytes, at, 2, highFirst),
                     type = numberAt(bytes, at + 2, 2, highFirst),
                     count = numberAt(bytes, at + 4, 4, highFirst);
        const bool isBegin = tag == kStrips || tag == kTiles,
                   isSize = tag == kStripSizes || tag == kTileSizes;
        if (!(isBegin || isSize) || (type != kShort && type != kLong)) continue;
        const size_t wide = type == kShort ? 2 : 4; // bytes of a value; few stand in the entry itself
        const size_t first = count * wide <= 4 ? at + 8 : numberAt(bytes, at + 8, 4, highFirst);
        if (first + count * wide > bytes.size()) return false;
        for (size_t k = 0; k < count; ++k)
            (isBegin ? begins : sizes).push_back(numberAt(bytes, first + k * wide, wide, highFirst));
    }
    for (size_t i = 0; i < std::min(begins.size(), sizes.size()); ++i)
        if (begins[i] + sizes[i] > bytes.size()) return false;
    return true;
}

constexpr size_t kOfTable = 64; // values
using Quantization = std::array<int, kOfTable>;

// The tables of a JPEG as they stand before its first scan, that of brightness first; none of other files.
std::vector<Quantization> quantization(const std::vector<uint8_t>& bytes) {
    constexpr uint8_t kTables = 0xDB, kScan = 0xDA;
    std::vector<Quantization> out;
    if (!isJpeg(bytes)) return out;
    for (size_t at = 2; at + 4 <= bytes.size() && bytes[at] == 0xFF && bytes[at + 1] != kScan;) {
        const size_t end = at + 2 + numberAt(bytes, at + 2, 2, true);
        size_t table = at + 4;
        const bool holdsTables = bytes[at + 1] == kTables;
        while (holdsTables && table < end && end <= bytes.size()) {
            const size_t wide = bytes[table] >> 4 ? 2 : 1, first = table + 1; // bytes of a value
            table = first + wide * kOfTable;
            if (table > end) break;
            Quantization values{};
            for (size_t i = 0; i < kOfTable; ++i)
                values[i] = static_cast<int>(numberAt(bytes, first + wide * i, wide, true));
            out.push_back(values);
        }
        at = end;
    }
    return out;
}

} // namespace

Size pictureSize(const std::vector<uint8_t>& bytes) {
    constexpr size_t kPngSize = 16; // after the signature and the first chunk's length and name
    if (isPng(bytes) && bytes.size() >= kPngSize + 8)
        return std::pair{numberAt(bytes, kPngSize, 4, true), numberAt(bytes, kPngSize + 4, 4, true)};
    if (isJpeg(bytes)) return jpegSize(bytes);
    if (isTiff(bytes)) return tiffSize(bytes);
    return std::nullopt;
}

bool isCutShort(const std::vector<uint8_t>& bytes) {
    if (isPng(bytes)) return !chunkOf(bytes, "IEND");
    if (isJpeg(bytes)) return !isWholeJpeg(bytes);
    if (isTiff(bytes)) return !isWholeTiff(bytes);
    return false;
}

bool isDamaged(const std::vector<uint8_t>& bytes) {
    if (!isPng(bytes)) return false;
    constexpr uint8_t kAncillary = 0x20; // a small first letter
    const size_t end = chunkOf(bytes, "IEND").value_or(0);
    for (size_t at = 8; at < end;) {
        const size_t length = numberAt(bytes, at, 4, true), sum = at + 8 + length;
        if (!(bytes[at + 4] & kAncillary) &&
            crc32(0, bytes.data() + at + 4, static_cast<uInt>(length + 4)) != numberAt(bytes, sum, 4, true))
            return true;
        at = sum + 4;
    }
    return false;
}

std::optional<double> statedGamma(const std::vector<uint8_t>& bytes) {
    if (!isPng(bytes) || chunkOf(bytes, "sRGB") || chunkOf(bytes, "iCCP")) return std::nullopt;
    const auto chunk = chunkOf(bytes, "gAMA");
    const size_t value = chunk && *chunk + 12 <= bytes.size() ? numberAt(bytes, *chunk + 8, 4, true) : 0;
    if (value == 0) return std::nullopt;
    return 100000.0 / static_cast<double>(value);
}

// The mean of the first table, of brightness, against that of ITU-T T.81, K.1.
int jpegQuality(const std::vector<uint8_t>& bytes) {
    constexpr double kMeanOfStandard = 3688.0 / kOfTable;
    const auto tables = quantization(bytes);
    if (tables.empty()) return 100;
    const double sum = std::accumulate(tables[0].begin(), tables[0].end(), 0.0);
    const double scale = std::max(1.0, 100 * sum / kOfTable / kMeanOfStandard);
    return std::clamp(static_cast<int>(std::lround(scale <= 100 ? (200 - scale) / 2 : 5000 / scale)), 1, 100);
}

double chromaStep(const std::vector<uint8_t>& bytes) {
    constexpr double kGain = 8; // of the mean's coefficient in a square of 8 x 8
    const auto tables = quantization(bytes);
    return tables.empty() ? 0 : tables.back()[0] / kGain;
}

} // namespace heliodon::vision
