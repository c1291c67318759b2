#include "compute/sky_elements.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace heliodon::compute {

namespace {

constexpr std::array<uint32_t, 7> kTregenzaRow{30, 30, 24, 24, 18, 12, 6};
constexpr std::array<uint32_t, 8> kTregenzaFirst{0, 30, 60, 84, 108, 126, 138, 144};
constexpr double kPi = std::numbers::pi;

double rowHeight(uint32_t division) {
    return 0.5 * kPi / (7.0 * division + 0.5);
}

} // namespace

uint32_t skyElementOf(glm::dvec3 d, uint32_t division) {
    const uint32_t square = division * division;
    if (d.y <= 0) return 144 * square + 1;
    const auto row = static_cast<uint32_t>(std::asin(std::min(d.y, 1.0)) / rowHeight(division));
    if (row >= 7 * division) return 144 * square;
    const uint32_t band = row / division, count = kTregenzaRow[band] * division;
    const double turn = std::atan2(d.x, -d.z) / (2 * kPi);
    const auto k = static_cast<uint32_t>(std::floor((turn + 1) * count + 0.5)) % count;
    return kTregenzaFirst[band] * square + (row - band * division) * count + k;
}

double SkyElement::solidAngle() const {
    return width * (std::sin(highAltitude) - std::sin(lowAltitude));
}

SkyElement skyElement(uint32_t element, uint32_t division) {
    const uint32_t square = division * division;
    const double height = rowHeight(division);
    if (element >= 144 * square) return {7 * division * height, kPi / 2, 0, 2 * kPi};
    uint32_t band = 0;
    while (element >= kTregenzaFirst[band + 1] * square) ++band;
    const uint32_t count = kTregenzaRow[band] * division, inBand = element - kTregenzaFirst[band] * square;
    const uint32_t row = band * division + inBand / count;
    return {row * height, (row + 1) * height, 2 * kPi * (inBand % count) / count, 2 * kPi / count};
}

std::vector<float> skyElementMeans(uint32_t division, const std::function<double(glm::dvec3)>& luminance,
                                   double ground, uint32_t samples) {
    const uint32_t count = skyElementCount(division) - 1;
    std::vector<float> means(count + 1);
    for (uint32_t k = 0; k < count; ++k) {
        const SkyElement e = skyElement(k, division);
        const double low = std::sin(e.lowAltitude), high = std::sin(e.highAltitude);
        double sum = 0;
        for (uint32_t i = 0; i < samples; ++i)
            for (uint32_t j = 0; j < samples; ++j) {
                const double up = low + (high - low) * (i + 0.5) / samples;
                const double azimuth = e.azimuth + e.width * ((j + 0.5) / samples - 0.5);
                const double flat = std::sqrt(std::max(0.0, 1 - up * up));
                sum += luminance({flat * std::sin(azimuth), up, -flat * std::cos(azimuth)});
            }
        means[k] = static_cast<float>(sum / (samples * samples));
    }
    means[count] = static_cast<float>(ground);
    return means;
}

} // namespace heliodon::compute
