// Structured light: Gray-code patterns that a projector shows and a camera sees (S. Inokuchi, K. Sato and
// F. Matsuda, "Range imaging system for 3-D object recognition", 1984), each beside its inverse, so that a
// bit is the sign of a difference whatever the surface and the room's light.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "vision/grey_picture.h"
#include "vision/photograph.h"

namespace heliodon::vision {

// Cells of `cell` x `cell` projector pixels carry their column's and row's Gray code.
struct PatternSet {
    int width = 1024, height = 768; // of the projector
    int cell = 16;

    int columns() const { return (width + cell - 1) / cell; }
    int rows() const { return (height + cell - 1) / cell; }
    int columnBits() const; // 0 for a single column
    int rowBits() const;
    // In the order to show them: white, black, x_bitK and x_bitK_inv from the most significant on, y_bitK and
    // y_bitK_inv, and the checkerboard xor_lsb of the last bits with its inverse.
    std::vector<std::string> names() const;
};

// The picture for the projector; `name` is one of names(). Black or white, three equal channels.
Photograph drawPattern(const PatternSet& set, const std::string& name);

// Where four squares of the checkerboard meet.
struct PatternCorner {
    glm::dvec2 projector{}, camera{}; // pixels
};

struct DecodedPatterns {
    std::vector<PatternCorner> corners; // row by row of the projector's picture
    int cell = 0;            // projector pixels along the cells used: the set's, or a power of two more
    double litShare = 0;     // of the camera's picture: lit by the projector
    double decodedShare = 0; // of those: every bit of the cells used sure
    double contrast = 0;     // median of white less black where lit, of the files' range
    std::vector<std::string> doubts; // of pictures that seem to be another pattern's, one line each
};

// `read` gives the camera's picture of the pattern of that name, all of one size (precondition); the
// checkerboard is not asked for where it is not used. A pixel is decided where pattern and inverse differ by
// more than a fifth of what white and black do. Where the camera does not resolve the finest patterns (less
// than a quarter of the light decided, or cells under 4 of its pixels, as with codes of single projector
// pixels) the last bits are left out: without them a Gray code is that of cells twice as large. A corner is
// kept where its four cells are seen and its saddle lies where they say. About 0.3 s of decoding for
// 1392 x 1032.
DecodedPatterns decodePatterns(const PatternSet& set,
                               const std::function<GreyPicture(const std::string&)>& read);

} // namespace heliodon::vision
