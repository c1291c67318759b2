#include "engine/passes/false_colour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <glm/common.hpp>

namespace heliodon::passes {

namespace {

// Rows of five pixels, top first, most significant bit left.
struct Glyph {
    char letter;
    std::array<uint8_t, 7> rows;
};
constexpr std::array<Glyph, 15> kGlyphs{{
    {'0', {0x0E, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0E}},
    {'1', {0x04, 0x0C, 0x04, 0x04, 0x04, 0x04, 0x0E}},
    {'2', {0x0E, 0x11, 0x01, 0x06, 0x08, 0x10, 0x1F}},
    {'3', {0x0E, 0x11, 0x01, 0x06, 0x01, 0x11, 0x0E}},
    {'4', {0x02, 0x06, 0x0A, 0x12, 0x1F, 0x02, 0x02}},
    {'5', {0x1F, 0x10, 0x1E, 0x01, 0x01, 0x11, 0x0E}},
    {'6', {0x06, 0x08, 0x10, 0x1E, 0x11, 0x11, 0x0E}},
    {'7', {0x1F, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08}},
    {'8', {0x0E, 0x11, 0x11, 0x0E, 0x11, 0x11, 0x0E}},
    {'9', {0x0E, 0x11, 0x11, 0x0F, 0x01, 0x02, 0x0C}},
    {'.', {0x00, 0x00, 0x00, 0x00, 0x00, 0x0C, 0x0C}},
    {'k', {0x10, 0x10, 0x12, 0x14, 0x18, 0x14, 0x12}},
    {'l', {0x0C, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0E}},
    {'u', {0x00, 0x00, 0x11, 0x11, 0x11, 0x13, 0x0D}},
    {'x', {0x00, 0x00, 0x11, 0x0A, 0x04, 0x0A, 0x11}},
}};

void fill(Image8& picture, int x0, int y0, int x1, int y1, std::array<uint8_t, 3> colour) {
    for (int y = std::max(y0, 0); y < std::min(y1, picture.height); ++y)
        for (int x = std::max(x0, 0); x < std::min(x1, picture.width); ++x)
            std::copy(colour.begin(), colour.end(), picture.pixel(x, y));
}

void drawText(Image8& picture, int x, int y, int scale, std::string_view text) {
    for (char letter : text) {
        for (const Glyph& glyph : kGlyphs) {
            if (glyph.letter != letter) continue;
            for (int row = 0; row < 7; ++row)
                for (int column = 0; column < 5; ++column)
                    if (glyph.rows[static_cast<size_t>(row)] >> (4 - column) & 1)
                        fill(picture, x + column * scale, y + row * scale, x + (column + 1) * scale,
                             y + (row + 1) * scale, {235, 235, 235});
        }
        x += 6 * scale;
    }
}

std::vector<double> ticks(const FalseScale& scale) {
    std::vector<double> values;
    if (scale.linear) {
        const double span = scale.highLux - scale.lowLux, raw = span / 5;
        const double decade = std::pow(10, std::floor(std::log10(raw))), lead = raw / decade;
        const double step = decade * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10);
        for (double v = std::ceil(scale.lowLux / step - 1e-9) * step; v <= scale.highLux + 1e-9 * span;
             v += step)
            values.push_back(v);
        return values;
    }
    const bool few = scale.highLux / scale.lowLux < 2000;
    for (double decade = std::pow(10, std::floor(std::log10(scale.lowLux))); decade <= scale.highLux;
         decade *= 10)
        for (double lead : {1.0, 2.0, 5.0}) {
            const double v = lead * decade;
            if ((few || lead == 1) && v >= scale.lowLux * (1 - 1e-9) && v <= scale.highLux * (1 + 1e-9))
                values.push_back(v);
        }
    return values;
}

std::string label(double lux) {
    return lux >= 1000 ? fmt::format("{:.3g}k", lux / 1000) : fmt::format("{:.3g}", lux);
}

} // namespace

FalseScale falseScale(const Tone& tone, std::span<const float> lux) {
    std::vector<float> positive;
    for (float value : lux)
        if (value > 0) positive.push_back(value);
    std::sort(positive.begin(), positive.end());
    const auto quantile = [&](double q) {
        return positive.empty()
                   ? 100.0
                   : double{positive[static_cast<size_t>(q * static_cast<double>(positive.size() - 1))]};
    };
    FalseScale scale;
    scale.linear = tone.linearScale;
    const double low = quantile(0.02), high = quantile(0.99);
    if (scale.linear) {
        const double decade = std::pow(10, std::floor(std::log10(high)));
        scale.lowLux = 0;
        scale.highLux = std::ceil(high / decade) * decade;
    } else {
        scale.lowLux = std::pow(10, std::floor(std::log10(low)));
        scale.highLux = std::pow(10, std::ceil(std::log10(high)));
    }
    scale.lowLux = tone.lowLux.value_or(scale.lowLux);
    scale.highLux = tone.highLux.value_or(scale.highLux);
    if (!scale.linear) scale.lowLux = std::max(scale.lowLux, 1e-3);
    if (!(scale.highLux > scale.lowLux)) scale.highLux = 10 * std::max(scale.lowLux, 1e-3);
    return scale;
}

glm::vec3 viridis(double t) {
    constexpr double c[7][3] = {
        {0.2777273272, 0.0054073445, 0.3340998053},   {0.1050930431, 1.4046135299, 1.3845901627},
        {-0.3308618287, 0.2148475595, 0.0950951630},  {-4.6342304990, -5.7991009734, -19.3324409563},
        {6.2282699363, 14.1799333668, 56.6905526007}, {4.7763849977, -13.7451453777, -65.3530326334},
        {-5.4354558559, 4.6458526122, 26.3124352496}};
    glm::dvec3 value{0};
    for (int k = 6; k >= 0; --k) value = value * t + glm::dvec3(c[k][0], c[k][1], c[k][2]);
    return glm::vec3(glm::clamp(value, 0.0, 1.0));
}

namespace {

int legendUnit(int height) {
    return std::max(1, height / 400);
}

} // namespace

int legendWidth(int height) {
    return 72 * legendUnit(height);
}

void drawLegend(Image8& picture, const FalseScale& scale) {
    const int size = legendUnit(picture.height), barWidth = 12 * size, margin = 10 * size;
    const int right = picture.width - margin, left = picture.width - legendWidth(picture.height);
    const int top = margin + 14 * size, bottom = picture.height - margin;
    if (left < 0 || bottom - top < 20) return;
    fill(picture, left, 0, picture.width, picture.height, {24, 24, 24});
    drawText(picture, right - barWidth - 6 * size, margin, size, "lux");
    const auto position = [&](double lux) {
        const double t = scale.linear ? (lux - scale.lowLux) / (scale.highLux - scale.lowLux)
                                      : std::log(lux / scale.lowLux) / std::log(scale.highLux / scale.lowLux);
        return bottom - 1 - static_cast<int>(std::lround(t * (bottom - 1 - top)));
    };
    for (int y = top; y < bottom; ++y) {
        const glm::vec3 colour = 255.0f * viridis(double(bottom - 1 - y) / (bottom - 1 - top)) + 0.5f;
        fill(
            picture, right - barWidth, y, right, y + 1,
            {static_cast<uint8_t>(colour.r), static_cast<uint8_t>(colour.g), static_cast<uint8_t>(colour.b)});
    }
    for (double lux : ticks(scale)) {
        const std::string text = label(lux);
        const int y = position(lux);
        fill(picture, right - barWidth - 3 * size, y, right - barWidth, y + size, {235, 235, 235});
        const int textTop = std::clamp(y - 3 * size, top, bottom - 7 * size);
        drawText(picture, right - barWidth - 5 * size - static_cast<int>(text.size()) * 6 * size, textTop,
                 size, text);
    }
}

} // namespace heliodon::passes
