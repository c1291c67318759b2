// Pictures and films as files. What is behind them (OpenCV, FFmpeg: some two hundred libraries of formats, a
// tenth of a second to load) is a module beside the program, loaded when first used. Throws
// std::runtime_error where that module is missing.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace heliodon::geometry {

// Three bytes a pixel, R G B, row-major from the top, tightly packed.
struct PicturePixels {
    int width = 0, height = 0;
    std::vector<uint8_t> rgb;
};

// All bytes of a file; none where it cannot be read.
std::vector<uint8_t> bytesOf(const std::filesystem::path& file);

// From a file's bytes: PNG, JPEG and TIFF, 8 or 16 bits, colour or grey; an alpha channel is dropped, the
// stated orientation ignored. Nothing where they are no picture.
std::optional<PicturePixels> pictureIn(const std::vector<uint8_t>& bytes);

// What a JPEG's data lacks (jpeg_damage.h): both read it with grey or smears there.
std::optional<std::string> jpegDamageIn(const std::vector<uint8_t>& bytes);

struct GreyPixels {
    int width = 0, height = 0;
    std::vector<float> values; // row-major from the top; 1 is the largest that the file can hold
};

// The same with one channel, and all 16 bits where there are as many.
std::optional<GreyPixels> greyPictureIn(const std::vector<uint8_t>& bytes);

// The file appears whole or not at all. `rgb`: width x height x 3 bytes. Throws std::runtime_error.
void writePngFile(const std::filesystem::path& file, int width, int height, const uint8_t* rgb);

// H.264 in .mp4, in the colours of BT.709 and sRGB, as the file says. What cannot be written (disk full) may
// be found out by finish() only.
class FilmEncoder {
public:
    virtual ~FilmEncoder() = default;
    virtual bool add(const uint8_t* rgb) = 0; // width x height x 3 bytes; false when it failed
    // Nothing is added after it. True when the file is complete.
    virtual bool finish() = 0;
    // Of what failed first, in the system's or the encoder's words; empty where there are none.
    virtual std::string why() const { return {}; }
};

// Odd sizes get a black line more. Null where no encoder is there.
std::unique_ptr<FilmEncoder> openFilmFile(const std::filesystem::path& file, int width, int height,
                                          double framesPerSecond);

// Counts up with every change of what stands below: a module of another build is refused, not called.
constexpr uint32_t kPictureCodecsVersion = 6;

// What the module exports, by the name `heliodonPictureCodecs`.
struct PictureCodecs {
    uint32_t version;
    std::optional<PicturePixels> (*picture)(const std::vector<uint8_t>&);
    std::optional<GreyPixels> (*greyPicture)(const std::vector<uint8_t>&);
    std::optional<std::string> (*jpegDamage)(const std::vector<uint8_t>&);
    bool (*writePng)(const std::filesystem::path&, int, int, const uint8_t*);
    std::unique_ptr<FilmEncoder> (*openFilm)(const std::filesystem::path&, int, int, double);
};

} // namespace heliodon::geometry
