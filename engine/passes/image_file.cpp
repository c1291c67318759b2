#include "engine/passes/image_file.h"

#include <bit>
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/picture_file.h"
#include "geometry/whole_file.h"

namespace heliodon::passes {

namespace {

// OpenEXR files are little-endian, as every machine that the program runs on.
static_assert(std::endian::native == std::endian::little);

class Bytes {
public:
    template<class T> void add(const T& value) {
        const char* begin = reinterpret_cast<const char*>(&value);
        bytes_.insert(bytes_.end(), begin, begin + sizeof(T));
    }
    void text(const std::string& value) {
        bytes_.insert(bytes_.end(), value.c_str(), value.c_str() + value.size() + 1);
    }
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

Bytes exrHeader(int32_t width, int32_t height) {
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
    header.add(uint32_t{20000630});
    header.add(uint32_t{2});
    header.attribute("channels", "chlist", channels);
    header.attribute("compression", "compression", packed(uint8_t{0}));
    header.attribute("dataWindow", "box2i", window);
    header.attribute("displayWindow", "box2i", window);
    header.attribute("lineOrder", "lineOrder", packed(uint8_t{0}));
    header.attribute("pixelAspectRatio", "float", packed(1.0f));
    header.attribute("screenWindowCenter", "v2f", packed(0.0f, 0.0f));
    header.attribute("screenWindowWidth", "float", packed(1.0f));
    header.add(uint8_t{0});
    return header;
}

} // namespace

void writePng(const Image8& picture, const std::filesystem::path& file) {
    geometry::writePngFile(file, picture.width, picture.height, picture.rgb.data());
}

void writeExr(const ImageF& picture, const std::filesystem::path& file) {
    const auto width = static_cast<size_t>(picture.width), height = static_cast<size_t>(picture.height);
    const Bytes header = exrHeader(picture.width, picture.height);
    geometry::writeWhole(file, [&](const std::filesystem::path& path) {
        std::ofstream out(path, std::ios::binary);
        out.write(header.data(), static_cast<std::streamsize>(header.size()));
        const size_t lineBytes = 8 + 12 * width;
        for (size_t y = 0; y < height; ++y) {
            const uint64_t offset = header.size() + 8 * height + y * lineBytes;
            out.write(reinterpret_cast<const char*>(&offset), 8);
        }
        std::vector<float> line(3 * width);
        for (size_t y = 0; y < height; ++y) {
            const int32_t start[2] = {static_cast<int32_t>(y), static_cast<int32_t>(12 * width)};
            for (size_t x = 0; x < width; ++x)
                for (size_t c = 0; c < 3; ++c) line[c * width + x] = picture.rgb[3 * (y * width + x) + 2 - c];
            out.write(reinterpret_cast<const char*>(start), 8);
            out.write(reinterpret_cast<const char*>(line.data()),
                      static_cast<std::streamsize>(4 * line.size()));
        }
        out.flush();
        if (!out) throw std::runtime_error(file.string() + ": the EXR could not be written (disk full?)");
    });
}

} // namespace heliodon::passes
