#include "engine/app/stamp.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "engine/passes/frame_light.h"
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

void drawNight(passes::Image8& picture) {
    darken(picture, picture.width, 0);
    if (picture.height < kLeastHeight) return;
    const std::string words = "no sun";
    passes::Lettering letters{std::max(9.0, picture.height / 22.0), {200, 200, 200}};
    letters.shrinkTo(0.8 * picture.width, words);
    letters.drawCentred(picture, 0.5 * picture.width, 0.5 * picture.height, words);
}

std::string sunInWords(const daylight::SunPosition& sun) {
    const double shown = std::abs(sun.altitudeDeg);
    return fmt::format("sun {:.1f}\u00B0 {}", shown, sun.altitudeDeg < 0 ? "below the horizon" : "high");
}

std::vector<std::string> stampOf(const SkySource& source, const daylight::Moment& moment, double whiteLux) {
    const std::string white = whiteLux >= 100 ? fmt::format("; white is {:.0f} lux", whiteLux)
                              : whiteLux > passes::kLeastWhite
                                  ? fmt::format("; white is {:.2g} lux", whiteLux)
                                  : "";
    if (!source.followsTime()) return {source.skyInWords() + white};
    return {daylight::timeInWords(moment),
            sunInWords(source.sunAt(moment)) + ", " + source.skyInWords() + white};
}

namespace {

passes::ExrAttributes attributesOf(const SkySource& source, const daylight::Moment& moment, double whiteLux) {
    passes::ExrAttributes attributes;
    attributes.text = {{"software", "Heliodon " HELIODON_VERSION}, {"heliodon:sky", source.skyInWords()}};
    attributes.numbers = {{"heliodon:whiteLux", static_cast<float>(whiteLux)}};
    if (!source.followsTime()) return attributes;
    attributes.text.emplace_back("heliodon:time", daylight::formatTime(moment));
    const daylight::SunPosition sun = source.sunAt(moment);
    for (const auto& [name, value] : {std::pair("latitude", source.site().latitudeDeg),
                                      std::pair("longitude", source.site().longitudeDeg),
                                      std::pair("heliodon:sunAltitudeDeg", sun.altitudeDeg),
                                      std::pair("heliodon:sunAzimuthDeg", sun.azimuthDeg)})
        attributes.numbers.emplace_back(name, static_cast<float>(value));
    return attributes;
}

} // namespace

passes::ExrAttributes previewAttributes(const SkySource& source, const daylight::Moment& moment,
                                        double whiteLux) {
    passes::ExrAttributes attributes = attributesOf(source, moment, whiteLux);
    attributes.text.emplace_back("heliodon:unit", "lux");
    attributes.text.emplace_back("comments", "exitance of diffuse surfaces, lux per linear Rec. 709 channel; "
                                             "luminance in cd/m2 is a pi-th; 0 where nothing is simulated");
    attributes.numbers.emplace_back("whiteLuminance", std::numbers::inv_pi_v<float>); // of 1 lux
    return attributes;
}

passes::ExrAttributes projectorAttributes(const SkySource& source, const daylight::Moment& moment,
                                          double whiteLux) {
    passes::ExrAttributes attributes = attributesOf(source, moment, whiteLux);
    attributes.text.emplace_back("heliodon:unit", "share of full drive");
    attributes.text.emplace_back("comments",
                                 "drive of a projector, linear per Rec. 709 channel, 1 = full, not clipped; "
                                 "heliodon:whiteLux of simulated exitance show as white");
    return attributes;
}

} // namespace heliodon::app
