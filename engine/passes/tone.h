// How light becomes a picture.
#pragma once

#include <optional>

namespace heliodon::passes {

enum class ToneMap {
    // Proportional up to white: the default; equal light sums to equal light over several projectors. What is
    // brighter in a channel keeps its luminance and hue as far as white has them, and is paler.
    linear,
    soft, // compresses highlights (Reinhard): `whiteLux` is shown at about 0.6 of white, 20 times that as
          // white
    falseColour // lux as colour, scale "viridis"
};

struct Tone {
    ToneMap map = ToneMap::linear;
    // Simulated exitance shown as white, lux; none: FrameRenderer::autoWhite of the light at hand.
    std::optional<double> whiteLux;
    // False colour shows illuminance on the surfaces, logarithmically. Ends of its scale in lux; none:
    // decades that hold the light at hand.
    std::optional<double> lowLux, highLux;
    bool legend = true; // scale with numbers, at the right of previews
};

} // namespace heliodon::passes
