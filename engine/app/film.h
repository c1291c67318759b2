// A film (H.264 in .mp4), encoded in a thread of its own so that drawing does not wait for it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "engine/passes/picture.h"
#include "geometry/picture_file.h"

namespace heliodon::app {

// A picture file as it was written by passes::writePng.
passes::Image8 readPicture(const std::filesystem::path& file);

class Film {
public:
    // Written beside `target`, or beside what it links to, and renamed by close(): the film appears whole or
    // not at all. Throws when no encoder is there.
    Film(const std::filesystem::path& target, uint32_t width, uint32_t height, double framesPerSecond);
    // With an encoder of the caller's, which writes the file that `open` is given. Where `open` throws or
    // returns none, what it has begun is removed.
    using Open = std::function<std::unique_ptr<geometry::FilmEncoder>(const std::filesystem::path&)>;
    Film(const std::filesystem::path& target, const Open& open);
    ~Film(); // without close(): stops and removes what was written
    Film(const Film&) = delete;
    Film& operator=(const Film&) = delete;

    // `rgb`: width x height x 3 bytes, sRGB, first row at the top. Waits when the encoder is several frames
    // behind, so that memory stays bounded. Throws what the encoder has failed on before.
    void add(std::vector<uint8_t> rgb);
    void close();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace heliodon::app
