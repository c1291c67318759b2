// Films, for the module behind picture_file.h alone.
#pragma once

#include "geometry/picture_file.h"

namespace heliodon::geometry {

// As openFilmFile says. BT.709 matrix and primaries, sRGB transfer, limited range, and the file says so: what
// is silent about it, players take for BT.601 or BT.709 by its height.
std::unique_ptr<FilmEncoder> openFilm(const std::filesystem::path& file, int width, int height,
                                      double framesPerSecond);

} // namespace heliodon::geometry
