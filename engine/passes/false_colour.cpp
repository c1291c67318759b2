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
    const bool few = scale.highLux / scale.lowLux < 3000;
    const auto is = [](double v, double end) { return std::abs(v - end) <= 1e-6 * end; };
    for (double decade = std::pow(10, std::floor(std::log10(scale.lowLux) + 1e-9));
         decade <= scale.highLux * (1 + 1e-6); decade *= 10)
        for (double lead : {1.0, 2.0, 5.0}) {
            const double v = lead * decade;
            if ((few || lead == 1 || is(v, scale.lowLux) || is(v, scale.highLux)) &&
                v >= scale.lowLux * (1 - 1e-6) && v <= scale.highLux * (1 + 1e-6))
                values.push_back(v);
        }
    return values;
}

std::string legendNumber(double lux) {
    return lux >= 1000 ? fmt::format("{:.3g}k", lux / 1000) : fmt::format("{:.3g}", lux);
}

std::string belowScale(const FalseScale& scale) {
    return "< " + legendNumber(scale.lowLux);
}

FalseScale scaleHolding(std::vector<double> lux) {
    std::erase_if(lux, [](double v) { return !(v > 0); });
    std::sort(lux.begin(), lux.end());
    // Rounded outwards: of a few values the scale holds each.
    const auto quantile = [&](double q) {
        const double rank = q * (static_cast<double>(lux.size()) - 1);
        return lux.empty() ? 100.0 : lux[static_cast<size_t>(q < 0.5 ? std::floor(rank) : std::ceil(rank))];
    };
    // From and to the next of 1, 2, 5 times a power of ten.
    const auto step = [](double v, bool up) {
        const double decade = std::pow(10, std::floor(std::log10(v) + 1e-9));
        double best = up ? 10 * decade : decade;
        for (double lead : {1.0, 2.0, 5.0})
            if (up ? lead * decade >= v * (1 - 1e-6) && lead * decade < best
                   : lead * decade <= v * (1 + 1e-6))
                best = lead * decade;
        return best;
    };
    FalseScale scale;
    scale.lowLux = step(std::max(quantile(0.01), 0.1), false);
    scale.highLux = step(std::max({quantile(0.995), 1.0, 5 * scale.lowLux}), true);
    return scale;
}

FalseScale falseScale(const Tone& tone, std::span<const float> lux) {
    FalseScale scale;
    if (!tone.lowLux || !tone.highLux) scale = scaleHolding({lux.begin(), lux.end()});
    scale.lowLux = std::max(tone.lowLux.value_or(scale.lowLux), 1e-3);
    scale.highLux = tone.highLux.value_or(scale.highLux);
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
    constexpr int kLeastHeight = 76; // a bar of 20 rows between "lux", what is below it and the margins
    return height < kLeastHeight ? 0 : 72 * legendUnit(height);
}

void drawLegend(Image8& picture, const FalseScale& scale) {
    const int size = legendUnit(picture.height), barWidth = 12 * size, margin = 10 * size;
    const int right = picture.width - margin, left = picture.width - legendWidth(picture.height);
    const int black = picture.height - margin - 10 * size; // from here to the margin
    const int top = margin + 18 * size, bottom = black - 8 * size;
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
    const auto write = [&](const std::string& text, double baseline) {
        letters.draw(picture, right - barWidth - 5 * size - letters.width(text), baseline, text);
    };
    // Numbers below one another: where they have no room, those that are no powers of ten go.
    double before = 1e9;
    const std::vector<double> ticks = legendTicks(scale);
    const double factor = position(1) - position(2);
    for (double lux : ticks) {
        const double power = std::log10(lux);
        if (factor < 1.2 * letters.capital && std::abs(power - std::round(power)) > 1e-6) continue;
        const int y = position(lux);
        const double baseline = y + 0.5 * (size + letters.capital);
        if (baseline > before - 1.1 * letters.capital) continue;
        before = baseline;
        fill(picture, right - barWidth - 3 * size, y, right - barWidth, y + size, kInk);
        write(legendNumber(lux), baseline);
    }
    fill(picture, right - barWidth, black, right, picture.height - margin, kInk);
    fill(picture, right - barWidth + 1, black + 1, right - 1, picture.height - margin - 1, {0, 0, 0});
    write(belowScale(scale), picture.height - margin);
}

} // namespace heliodon::passes
