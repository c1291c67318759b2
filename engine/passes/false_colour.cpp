#include "engine/passes/false_colour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "engine/passes/lettering.h"

namespace heliodon::passes {

namespace {

constexpr std::array<uint8_t, 3> kInk{235, 235, 235};

void fill(Image8& picture, int x0, int y0, int x1, int y1, std::array<uint8_t, 3> colour) {
    for (int y = std::max(y0, 0); y < std::min(y1, picture.height); ++y)
        for (int x = std::max(x0, 0); x < std::min(x1, picture.width); ++x)
            std::copy(colour.begin(), colour.end(), picture.pixel(x, y));
}

} // namespace

std::vector<double> legendTicks(const FalseScale& scale) {
    std::vector<double> values;
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

std::string legendNumber(double lux) {
    return lux >= 1000 ? fmt::format("{:.3g}k", lux / 1000) : fmt::format("{:.3g}", lux);
}

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
    scale.lowLux = tone.lowLux.value_or(std::pow(10, std::floor(std::log10(quantile(0.02)))));
    scale.highLux = tone.highLux.value_or(std::pow(10, std::ceil(std::log10(quantile(0.99)))));
    scale.lowLux = std::max(scale.lowLux, 1e-3);
    if (!(scale.highLux > scale.lowLux)) scale.highLux = 10 * scale.lowLux;
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
    constexpr int kLeastHeight = 54; // a bar of 20 rows between "lux" and the margins
    return height < kLeastHeight ? 0 : 72 * legendUnit(height);
}

void drawLegend(Image8& picture, const FalseScale& scale) {
    const int size = legendUnit(picture.height), barWidth = 12 * size, margin = 10 * size;
    const int right = picture.width - margin, left = picture.width - legendWidth(picture.height);
    const int top = margin + 14 * size, bottom = picture.height - margin;
    if (left < 0 || left == picture.width) return;
    fill(picture, left, 0, picture.width, picture.height, {24, 24, 24});
    const Lettering letters{9.0 * size, kInk};
    letters.draw(picture, right - letters.width("lux"), margin + letters.capital, "lux");
    const auto position = [&](double lux) {
        const double t = std::log(lux / scale.lowLux) / std::log(scale.highLux / scale.lowLux);
        return bottom - 1 - static_cast<int>(std::lround(t * (bottom - 1 - top)));
    };
    for (int y = top; y < bottom; ++y) {
        const glm::vec3 colour = 255.0f * viridis(double(bottom - 1 - y) / (bottom - 1 - top)) + 0.5f;
        fill(
            picture, right - barWidth, y, right, y + 1,
            {static_cast<uint8_t>(colour.r), static_cast<uint8_t>(colour.g), static_cast<uint8_t>(colour.b)});
    }
    for (double lux : legendTicks(scale)) {
        const std::string text = legendNumber(lux);
        const int y = position(lux);
        fill(picture, right - barWidth - 3 * size, y, right - barWidth, y + size, kInk);
        const double baseline =
            std::clamp(y + 0.5 * (size + letters.capital), top + letters.capital, 1.0 * bottom);
        letters.draw(picture, right - barWidth - 5 * size - letters.width(text), baseline, text);
    }
}

} // namespace heliodon::passes
