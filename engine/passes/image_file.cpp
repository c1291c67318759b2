#include "engine/passes/image_file.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <fstream>
#include <istream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <zlib.h>

#include "geometry/picture_file.h"
#include "geometry/whole_file.h"

namespace heliodon::passes {

namespace {

// OpenEXR files are little-endian, as every machine that the program runs on.
static_assert(std::endian::native == std::endian::little);

constexpr uint32_t kExrMagic = 20000630;
constexpr size_t kLinesOfBlock = 16; // that ZIP compression takes together
constexpr int kZipLevel = 4;         // files hardly grow against the best, in a fraction of its time

class Bytes {
public:
    template<class T> void add(const T& value) {
        const char* begin = reinterpret_cast<const char*>(&value);
        bytes_.insert(bytes_.end(), begin, begin + sizeof(T));
    }
    void text(const std::string& value) {
        bytes_.insert(bytes_.end(), value.c_str(), value.c_str() + value.size() + 1);
    }
    void letters(const std::string& value) { bytes_.insert(bytes_.end(), value.begin(), value.end()); }
    void attribute(const std::string& name, const std::string& type, const Bytes& value) {
        text(name);
        text(type);
        add(static_cast<int32_t>(value.bytes_.size()));
        bytes_.insert(bytes_.end(), value.bytes_.begin(), value.bytes_.end());
    }
    size_t size() const { return bytes_.size(); }
    const char* data() const { return bytes_.data(); }

private:
    std::vector<char> bytes_;
};

template<class... T> Bytes packed(const T&... values) {
    Bytes bytes;
    (bytes.add(values), ...);
    return bytes;
}

Bytes exrHeader(int32_t width, int32_t height, const ExrAttributes& attributes) {
    Bytes channels;
    for (const char* name : {"B", "G", "R"}) { // in alphabetical order, as their samples are
        channels.text(name);
        channels.add(int32_t{2}); // 32-bit float
        channels.add(int32_t{0}); // pLinear and three reserved bytes
        channels.add(int32_t{1});
        channels.add(int32_t{1});
    }
    channels.add(uint8_t{0});
    const Bytes window = packed(int32_t{0}, int32_t{0}, width - 1, height - 1);
    Bytes header;
    header.add(kExrMagic);
    header.add(uint32_t{2});
    header.attribute("channels", "chlist", channels);
    header.attribute("compression", "compression", packed(uint8_t{3})); // ZIP
    header.attribute("dataWindow", "box2i", window);
    header.attribute("displayWindow", "box2i", window);
    header.attribute("lineOrder", "lineOrder", packed(uint8_t{0}));
    header.attribute("pixelAspectRatio", "float", packed(1.0f));
    header.attribute("screenWindowCenter", "v2f", packed(0.0f, 0.0f));
    header.attribute("screenWindowWidth", "float", packed(1.0f));
    header.attribute("chromaticities", "chromaticities", // Rec. 709, D65
                     packed(0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f));
    for (const auto& [name, words] : attributes.text) {
        Bytes value;
        value.letters(words);
        header.attribute(name, "string", value);
    }
    for (const auto& [name, number] : attributes.numbers) header.attribute(name, "float", packed(number));
    header.add(uint8_t{0});
    return header;
}

// Bytes before the table of blocks; 0 where they do not end in the file.
uint64_t exrHeaderSize(std::istream& in) {
    in.seekg(8); // behind magic and version
    std::string name, type;
    while (std::getline(in, name, '\0') && !name.empty()) {
        int32_t size = -1;
        std::getline(in, type, '\0');
        in.read(reinterpret_cast<char*>(&size), sizeof size);
        if (!in || size < 0) return 0;
        in.seekg(size, std::ios::cur);
    }
    return in ? static_cast<uint64_t>(in.tellg()) : 0;
}

// ZIP compression of OpenEXR: even bytes before odd ones, differences to the byte before, then zlib. What
// would not get smaller stays as it was, which readers tell by its size.
std::vector<unsigned char> zipped(const std::vector<float>& values) {
    const auto* raw = reinterpret_cast<const unsigned char*>(values.data());
    const size_t size = 4 * values.size();
    std::vector<unsigned char> parted(size);
    for (size_t i = 0; i < size; ++i) parted[i / 2 + (i % 2) * (size / 2)] = raw[i];
    for (size_t i = size; i-- > 1;) parted[i] = static_cast<unsigned char>(parted[i] - parted[i - 1] + 128);
    uLongf length = compressBound(size);
    std::vector<unsigned char> packed(length);
    if (compress2(packed.data(), &length, parted.data(), size, kZipLevel) != Z_OK || length >= size)
        return {raw, raw + size};
    packed.resize(length);
    return packed;
}

} // namespace

void writePng(const Image8& picture, const std::filesystem::path& file) {
    geometry::writePngFile(file, picture.width, picture.height, picture.rgb.data());
}

void writeExr(const ImageF& picture, const std::filesystem::path& file, const ExrAttributes& attributes) {
    const auto width = static_cast<size_t>(picture.width), height = static_cast<size_t>(picture.height);
    const Bytes header = exrHeader(picture.width, picture.height, attributes);
    const size_t blocks = (height + kLinesOfBlock - 1) / kLinesOfBlock;
    geometry::writeWhole(file, [&](const std::filesystem::path& path) {
        std::ofstream out(path, std::ios::binary);
        std::vector<uint64_t> offsets(blocks); // known when all is written
        const auto writeHead = [&] {
            out.seekp(0);
            out.write(header.data(), static_cast<std::streamsize>(header.size()));
            out.write(reinterpret_cast<const char*>(offsets.data()),
                      static_cast<std::streamsize>(8 * offsets.size()));
        };
        writeHead();
        std::vector<float> lines;
        for (size_t b = 0; b < blocks; ++b) {
            offsets[b] = static_cast<uint64_t>(out.tellp());
            const size_t first = b * kLinesOfBlock, last = std::min(first + kLinesOfBlock, height);
            lines.clear();
            for (size_t y = first; y < last; ++y)
                for (size_t c = 0; c < 3; ++c)
                    for (size_t x = 0; x < width; ++x)
                        lines.push_back(picture.rgb[3 * (y * width + x) + 2 - c]);
            const std::vector<unsigned char> block = zipped(lines);
            const int32_t start[2] = {static_cast<int32_t>(first), static_cast<int32_t>(block.size())};
            out.write(reinterpret_cast<const char*>(start), 8);
            out.write(reinterpret_cast<const char*>(block.data()),
                      static_cast<std::streamsize>(block.size()));
        }
        writeHead();
        out.flush();
        if (!out) throw std::runtime_error(file.string() + ": the EXR could not be written (disk full?)");
    });
}

bool isWholePng(const std::filesystem::path& file) {
    constexpr std::string_view kBegin("\x89PNG\r\n\x1a\n", 8), kEnd("\0\0\0\0IEND\xae\x42\x60\x82", 12);
    std::ifstream in(file, std::ios::binary);
    std::string begin(kBegin.size(), ' '), end(kEnd.size(), ' ');
    in.read(begin.data(), static_cast<std::streamsize>(begin.size()));
    in.seekg(-static_cast<std::streamoff>(kEnd.size()), std::ios::end);
    in.read(end.data(), static_cast<std::streamsize>(end.size()));
    return in && begin == kBegin && end == kEnd;
}

bool isWholeExr(const std::filesystem::path& file) {
    std::error_code missing;
    const uintmax_t size = std::filesystem::file_size(file, missing);
    if (missing) return false;
    std::ifstream in(file, std::ios::binary);
    const auto at = [&in](uint64_t place, auto value) {
        in.seekg(static_cast<std::streamoff>(place));
        in.read(reinterpret_cast<char*>(&value), sizeof value);
        return value;
    };
    const uint64_t head = exrHeaderSize(in), first = head > 0 ? at(head, uint64_t{0}) : 0;
    if (!in || at(0, uint32_t{0}) != kExrMagic || first < head + 8 || first > size) return false;
    const uint64_t last = at(first - 8, uint64_t{0});
    if (last < first || last > size) return false;
    const int32_t bytes = at(last + 4, int32_t{-1});
    return in && bytes > 0 && last + 8 + static_cast<uint64_t>(bytes) == size;
}

} // namespace heliodon::passes
