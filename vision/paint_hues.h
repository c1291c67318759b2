// Which paint a hue and a saturation mean, learned from the picture.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vision/color_classes.h"

namespace heliodon::vision {

// A pixel that is not white by the light about it.
struct Coloured {
    uint32_t index;
    uint16_t hue;       // degrees
    uint8_t saturation; // P' largest component, 0..255
    uint8_t brightness; // largest channel over local white, 1 as 128
};

class PaintTable {
public:
    PaintTable(); // nominal paints
    // A paint's hue is a peak of the picture's near the nominal one. Cyan, light blue and blue differ by
    // little more than their saturation, which faded paint and a camera's overlapping filters lower: they are
    // peaks in hue and saturation, and light-blue card is wide where walls and markers are narrow. `width`:
    // of the picture that the indices count in; `reach`: pixels, more than half the width of a marker's top.
    PaintTable(const std::vector<Coloured>& coloured, int width, int reach);

    Paint at(uint16_t hue, uint8_t saturation) const { return table_[saturation / kStep][hue]; }
    // Light-blue card that a camera or the years have faded; white in a bluish shadow is darker.
    static bool isFadedSky(float hue, float saturation, float brightness) {
        return hue > 195 && hue < 226 && saturation > 0.23f && brightness > 0.72f && brightness < 1.5f;
    }
    float cyanSaturation() const { return tone_[static_cast<size_t>(Paint::cyan)].saturation; }

private:
    static constexpr size_t kStep = 8; // of 256
    struct Tone {
        float hue = 0, saturation = 0; // degrees, 0..1
    };
    void learnHues(const std::vector<Coloured>& coloured);
    void learnBlues(const std::vector<Coloured>& coloured, int width, int reach);
    void fill();

    std::array<Tone, kPaints> tone_{};
    std::array<std::array<Paint, 360>, 256 / kStep> table_{};
};

} // namespace heliodon::vision
