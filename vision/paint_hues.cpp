#include "vision/paint_hues.h"

#include <algorithm>
#include <cmath>

namespace heliodon::vision {
namespace {

// Hues of the paints in linear light; only their order round the circle and their rough places are assumed.
// Saturations count for cyan, light blue and blue alone.
constexpr std::array<float, kPaints> kNominalHue = {0, 1, 20, 47, 130, 190, 209, 230, 325};
constexpr std::array<float, kPaints> kNominalSaturation = {0, 1, 1, 1, 1, 0.8f, 0.47f, 0.82f, 1};

// Degrees that a paint's hue may lie from the nominal. Greens differ more than the others, and nothing else
// is near.
constexpr std::array<float, kPaints> kHueReach = {0, 16, 16, 16, 28, 16, 16, 16, 16};
constexpr float kMagentaBesideRed = 26; // towards red
constexpr float kOwnRed = 8;            // a peak nearer than this to the nominal red is one
constexpr float kHueScale = 8;          // degrees that weigh as much as
constexpr float kSaturationScale = 0.2f;
constexpr float kFarthest = 8; // squared distance, in these scales, from a nominal blue to a peak
constexpr int kFirstBlue = 172, kLastBlue = 248; // degrees
constexpr float kWide = 0.03f;   // of a card of an inch square: 4 in 100 pixels have wide surroundings
constexpr float kWrongShape = 4; // squared distance
constexpr float kEnough = 40;    // pixels of a peak: half of the smallest piece of paint

constexpr Paint kBlues[] = {Paint::cyan, Paint::sky, Paint::blue};
constexpr bool isBlue(size_t paint) {
    return std::find(std::begin(kBlues), std::end(kBlues), static_cast<Paint>(paint)) != std::end(kBlues);
}

float hueDistance(float a, float b) {
    const float d = std::abs(a - b);
    return std::min(d, 360 - d);
}
float squared(float v) {
    return v * v;
}

struct Peak {
    float hue, saturation;
};

std::vector<Peak> findPeaks(const std::array<float, 360>& bins) {
    std::array<float, 360> smooth{};
    for (size_t h = 0; h < 360; ++h)
        for (size_t d = 0; d < 7; ++d) smooth[h] += bins[(h + d + 357) % 360];
    std::vector<Peak> peaks;
    for (size_t h = 0; h < 360; ++h) {
        if (smooth[h] < kEnough) continue;
        bool highest = true;
        for (size_t d = 1; d <= 8; ++d) // first of equals
            highest =
                highest && smooth[h] >= smooth[(h + d) % 360] && smooth[h] > smooth[(h + 360 - d) % 360];
        if (!highest) continue;
        float moment = 0;
        for (size_t d = 0; d < 7; ++d) moment += bins[(h + d + 357) % 360] * (static_cast<float>(d) - 3);
        peaks.push_back({static_cast<float>(h) + moment / smooth[h], 1});
    }
    return peaks;
}

// Share of a peak's pixels that have pixels of their kind at `reach` in all four directions.
float wideShare(const std::vector<Coloured>& coloured, const Peak& peak, int width, int reach) {
    auto belongs = [&](const Coloured& c) {
        return hueDistance(static_cast<float>(c.hue), peak.hue) < kHueScale &&
               std::abs(static_cast<float>(c.saturation) / 255 - peak.saturation) < kSaturationScale;
    };
    std::vector<uint32_t> of; // in order, as `coloured` is
    for (const Coloured& c : coloured)
        if (belongs(c)) of.push_back(c.index);
    if (of.empty()) return 0;
    const size_t last = of.back();
    std::vector<bool> mask(last + 1, false);
    for (const uint32_t i : of) mask[i] = true;
    const auto step = static_cast<size_t>(reach), row = static_cast<size_t>(width) * step;
    size_t wide = 0, asked = 0;
    for (size_t k = 0; k < of.size(); k += 3) {
        const size_t i = of[k];
        ++asked;
        wide +=
            i >= row && i + row <= last && mask[i - row] && mask[i + row] && mask[i - step] && mask[i + step];
    }
    return static_cast<float>(wide) / static_cast<float>(asked);
}

struct Pair {
    float cost;
    size_t paint, peak;
};

// Nearest pairs first, one paint to a peak: so without red walls the arrow's orange is not taken for a red.
std::vector<Pair> matched(std::vector<Pair> pairs, size_t peaks) {
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pair& a, const Pair& b) { return a.cost < b.cost; });
    std::array<bool, kPaints> known{};
    std::vector<bool> given(peaks, false);
    std::erase_if(pairs, [&](const Pair& p) {
        if (known[p.paint] || given[p.peak]) return true;
        known[p.paint] = given[p.peak] = true;
        return false;
    });
    return pairs;
}

} // namespace

PaintTable::PaintTable() {
    for (size_t i = 0; i < kPaints; ++i) tone_[i] = {kNominalHue[i], kNominalSaturation[i]};
    fill();
}

PaintTable::PaintTable(const std::vector<Coloured>& coloured, int width, int reach) : PaintTable() {
    learnHues(coloured);
    learnBlues(coloured, width, reach);
    fill();
}

void PaintTable::learnHues(const std::vector<Coloured>& coloured) {
    const auto isOther = [](const Coloured& c) { return c.hue < kFirstBlue || c.hue > kLastBlue; };
    // White in light of another colour is paler than paint.
    std::array<size_t, 256> levels{};
    size_t all = 0, above = 0, vivid = 255;
    for (const Coloured& c : coloured)
        if (isOther(c)) ++levels[c.saturation], ++all;
    while (vivid > 0 && 10 * (above + levels[vivid]) < all) above += levels[vivid--];
    std::array<float, 360> histogram{};
    for (const Coloured& c : coloured)
        if (isOther(c) && 2 * c.saturation >= vivid) histogram[c.hue] += 1;
    const std::vector<Peak> peaks = findPeaks(histogram);
    // Beside a red of its own, what is still redder than a usual magenta is no other red.
    const bool hasRed = std::any_of(peaks.begin(), peaks.end(), [](const Peak& peak) {
        return hueDistance(kNominalHue[static_cast<size_t>(Paint::red)], peak.hue) < kOwnRed;
    });
    std::vector<Pair> pairs;
    for (size_t paint = 1; paint < kPaints; ++paint) {
        const bool isWide = hasRed && static_cast<Paint>(paint) == Paint::magenta;
        for (size_t k = 0; k < peaks.size() && !isBlue(paint); ++k) {
            const bool isRedder = isWide && peaks[k].hue > kNominalHue[paint];
            const float reach = isRedder ? kMagentaBesideRed : kHueReach[paint];
            if (const float d = hueDistance(kNominalHue[paint], peaks[k].hue); d < reach)
                pairs.push_back({d, paint, k});
        }
    }
    for (const Pair& p : matched(pairs, peaks.size())) tone_[p.paint].hue = peaks[p.peak].hue;
}

void PaintTable::learnBlues(const std::vector<Coloured>& coloured, int width, int reach) {
    constexpr int kHues = (kLastBlue - kFirstBlue) / 2 + 1, kLevels = 256 / kStep, kReach = 2;
    std::array<std::array<float, kLevels>, kHues> histogram{}, smooth{};
    for (const Coloured& c : coloured)
        if (c.hue >= kFirstBlue && c.hue <= kLastBlue)
            histogram[static_cast<size_t>((c.hue - kFirstBlue) / 2)][c.saturation / kStep] += 1;
    // A box would make plateaus, by which a peak hides one beside it.
    auto tent = [](int d) { return 1 - static_cast<float>(std::abs(d)) / (kReach + 1); };
    auto inside = [](int h, int s) { return h >= 0 && h < kHues && s >= 0 && s < kLevels; };
    auto at = [](auto& grid, int h, int s) -> float& {
        return grid[static_cast<size_t>(h)][static_cast<size_t>(s)];
    };
    for (int h = 0; h < kHues; ++h)
        for (int s = 0; s < kLevels; ++s)
            for (int dh = -kReach; dh <= kReach; ++dh)
                for (int ds = -kReach; ds <= kReach; ++ds)
                    if (inside(h + dh, s + ds))
                        at(smooth, h, s) += tent(dh) * tent(ds) * at(histogram, h + dh, s + ds);
    std::vector<Peak> peaks;
    for (int h = 0; h < kHues; ++h)
        for (int s = 0; s < kLevels; ++s) {
            if (at(smooth, h, s) < 0.5f * kEnough) continue;
            bool highest = true;
            float mass = 0, hue = 0, saturation = 0;
            for (int dh = -kReach; dh <= kReach; ++dh)
                for (int ds = -kReach; ds <= kReach; ++ds) {
                    if (!inside(h + dh, s + ds)) continue;
                    const float other = at(smooth, h + dh, s + ds);
                    const bool before = dh < 0 || (dh == 0 && ds < 0); // first of equals
                    highest = highest && (before ? at(smooth, h, s) > other : at(smooth, h, s) >= other);
                    const float n = at(histogram, h + dh, s + ds);
                    mass += n, hue += n * static_cast<float>(h + dh),
                        saturation += n * static_cast<float>(s + ds);
                }
            if (highest)
                peaks.push_back({kFirstBlue + 0.5f + 2 * hue / mass,
                                 (saturation / mass + 0.5f) * static_cast<float>(kStep) / 256});
        }
    std::vector<Pair> pairs;
    for (size_t k = 0; k < peaks.size(); ++k) {
        const bool wide = wideShare(coloured, peaks[k], width, reach) > kWide;
        for (const Paint blue : kBlues) {
            const auto paint = static_cast<size_t>(blue);
            const float shape = wide == (blue == Paint::sky) ? 0 : kWrongShape;
            const float cost = shape + squared((kNominalHue[paint] - peaks[k].hue) / kHueScale) +
                               squared((kNominalSaturation[paint] - peaks[k].saturation) / kSaturationScale);
            if (cost < kFarthest) pairs.push_back({cost, paint, k});
        }
    }
    const std::vector<Pair> seen = matched(pairs, peaks.size());
    float shift = 0; // of their hues: light and maker move all of them alike
    for (const Pair& p : seen)
        shift += (peaks[p.peak].hue - kNominalHue[p.paint]) / static_cast<float>(seen.size());
    for (const Paint blue : kBlues) tone_[static_cast<size_t>(blue)].hue += shift;
    for (const Pair& p : seen) tone_[p.paint] = {peaks[p.peak].hue, peaks[p.peak].saturation};
}

void PaintTable::fill() {
    for (size_t level = 0; level < table_.size(); ++level)
        for (size_t hue = 0; hue < 360; ++hue) {
            const float h = static_cast<float>(hue), s = (static_cast<float>(level) + 0.5f) * kStep / 256;
            float best = 1e9f;
            for (size_t paint = 1; paint < kPaints; ++paint) {
                if (static_cast<Paint>(paint) == Paint::sky) continue;
                const float d = hueDistance(tone_[paint].hue, h);
                if (d < best) best = d, table_[level][hue] = static_cast<Paint>(paint);
            }
            if (!isBlue(static_cast<size_t>(table_[level][hue]))) continue;
            best = 1e9f;
            for (const Paint blue : kBlues) {
                const Tone& tone = tone_[static_cast<size_t>(blue)];
                const float d =
                    squared((tone.hue - h) / kHueScale) + squared((tone.saturation - s) / kSaturationScale);
                if (d < best) best = d, table_[level][hue] = blue;
            }
        }
}

} // namespace heliodon::vision
