#include "engine/app/stamp.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/passes/lettering.h"

namespace heliodon::app {

namespace {

constexpr int kLeastHeight = 120;
constexpr double kDark = 0.35; // what is left of the picture beneath the words

void darken(passes::Image8& picture, int x1, int y0) {
    for (int y = std::max(0, y0); y < picture.height; ++y)
        for (int x = 0; x < std::min(x1, picture.width); ++x)
            for (size_t c = 0; c < 3; ++c) {
                uint8_t& value = picture.pixel(x, y)[c];
                value = static_cast<uint8_t>(std::lround(kDark * value));
            }
}

} // namespace

void drawStamp(passes::Image8& picture, const std::vector<std::string>& words) {
    if (picture.height < kLeastHeight || words.empty()) return;
    const double capital = std::max(9.0, picture.height / 44.0);
    const int margin = static_cast<int>(std::lround(0.7 * capital)), room = picture.width - 4 * margin;
    if (room <= 0) return;
    const auto advance = [](const passes::Lettering& line) {
        return static_cast<int>(std::lround(1.6 * line.capital));
    };
    std::vector<passes::Lettering> lines;
    int widest = 0, tall = margin;
    for (const std::string& text : words) {
        passes::Lettering line{lines.empty() ? capital : std::max(8.0, 0.72 * capital), {240, 240, 240}};
        line.shrinkTo(room, text);
        widest = std::max(widest, static_cast<int>(std::ceil(line.width(text))));
        tall += advance(line);
        lines.push_back(line);
    }
    int y = picture.height - tall - margin / 2;
    darken(picture, widest + 2 * margin + margin / 2, y);
    for (size_t k = 0; k < lines.size(); ++k) {
        y += advance(lines[k]);
        lines[k].draw(picture, margin, y + margin / 4, words[k]);
    }
}

std::string sunInWords(const daylight::SunPosition& sun) {
    const double shown = std::abs(sun.altitudeDeg);
    return fmt::format("sun {:.1f}\u00B0 {}", shown, sun.altitudeDeg < 0 ? "below the horizon" : "high");
}

} // namespace heliodon::app
