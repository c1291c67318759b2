// From an overhead photograph to the sketch that lies on the table.
// After section 4.1 of "A Spatially Augmented Reality Sketching Interface for Architectural Daylighting
// Design" (Sheng, Yapo, Young, Cutler, 2011): the colour transform P' = (P - Pmin) / Pmax, ordering and
// thresholds, connected components, robust fits, back-projection to the height that the colour states.
// vision/README.md says where ours goes further.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "geometry/rig.h"
#include "geometry/sketch.h"
#include "vision/photograph.h"

namespace heliodon::vision {

// Lengths are inches on the table. The defaults are those of the paper's walls and markers; hues are learned
// from each picture.
struct DetectOptions {
    double gamma = 2.2;                 // light = (value / 255) ^ gamma
    double minSaturation = 0.33;        // of P' after local white balance: below it a pixel is white (0..1)
    double minBrightness = 0.09;        // largest channel over local white: darker is floor or noise (0..1)
    double minBrightnessOffTable = 0.2; // the same beyond the table's edge
    double wallThickness = 0.375;       // foam core; another one that all walls share is found (0.2 to 0.6)
    double shortestWall = 1.9;          // shorter ones are not made; what looks like one is a smear of colour
    double unpaintedEnd = 0.5;          // the paint of a wall stops so far before its end
    double markerThickness = 0.03;      // window markers and skylights: folded card
    double tokenSide = 1.5;             // outside of the coloured rim
    double tokenBand = 0.2;             // width of the rim and of the white ring within
    double tokenThickness = 0.06;
    double arrowLength = 3;
    double chipWhite = 0.863; // white ring's reflectance over that of a chip with sRGB 255
};

struct DetectionResult {
    // Ids "w1", "a1", "win1", "sky1", "token1", ordered as they lie in the picture, from the top.
    geometry::Sketch sketch;
    // What was seen and not understood, one line each; also when nothing was seen.
    std::vector<std::string> warnings;
    size_t wallsLeftOut = 0; // pieces with a wall's paint that were not read as walls; warnings name them
};

// Deterministic. An empty table, a black picture or noise gives a sketch without walls and a warning.
// Throws InputError when the photograph's size is not that of the rig's camera. About 0.03 s for 1392 x 1032.
DetectionResult detectSketch(const Photograph& photo, const geometry::Rig& rig,
                             const DetectOptions& options = {});

// The table's edge in the picture of a calibrated camera: a rig that does not fit the picture shows.
geometry::Detection tableEdge(const geometry::Rig& rig);

// The name of an outline, still to be lettered.
struct OverlayTag {
    enum class Side { any, outer, inner }; // outer: away from the picture's middle
    std::string words;
    std::array<uint8_t, 3> ink{};
    std::vector<glm::dvec2> outlinePx; // not empty
    Side side = Side::any;
    std::optional<std::array<uint8_t, 3>> paint; // of a token
};

struct Overlay {
    Photograph picture;
    std::vector<OverlayTag> tags;
};

// The photograph, brightened, with the table's edge as the rig has it and the outline of every primitive.
// `dark`: triangles in the world, metres, that no projector reaches; hatched.
Overlay drawOverlay(const Photograph& photo, const geometry::Rig& rig, const geometry::Sketch& sketch,
                    std::span<const std::array<glm::dvec3, 3>> dark = {});

} // namespace heliodon::vision
