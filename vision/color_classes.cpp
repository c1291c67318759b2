// The paper's P' = (P - Pmin) / Pmax (section 4.1) on linear light that is first divided by the light on the
// white table near by. So neither the tubes' and the projectors' differing white nor the camera's gains enter
// the thresholds: what is left is the paint. The hues that separate the paints follow from those found in the
// picture.
#include "vision/color_classes.h"

#include <algorithm>
#include <cmath>

#include "geometry/sketch.h"
#include "vision/white_map.h"

namespace heliodon::vision {
namespace {

// Hues of the paints in linear light; only their order round the circle and their rough places are assumed.
constexpr std::array<float, kPaints> kNominalHue = {0, 1, 20, 47, 130, 188, 208, 229, 325};

constexpr double kOverEdge = 2; // inches that a wall may stick out over the table
constexpr float kHueReach = 16; // degrees that a paint's hue may lie from the nominal
// Of 255: walls, markers and the arrow are more saturated, the light-blue card less.
constexpr uint8_t kVivid = 176;

// Hue in degrees of a colour whose smallest component was taken away.
inline float hueOf(float r, float g, float b, float high, float low) {
    const float span = high - low;
    if (high == r) return 60 * (g - b) / span + (g < b ? 360.0f : 0.0f);
    if (high == g) return 120 + 60 * (b - r) / span;
    return 240 + 60 * (r - g) / span;
}

struct Coloured {
    uint32_t index;
    uint16_t hue;       // degrees
    uint8_t saturation; // P' largest component, 0..255
};

// Rows of linear light, softened by a Gaussian; each row of the picture is read once.
class SoftRows {
public:
    SoftRows(const PlanView& view, const TableRegion& region, double sigma)
        : view_(view), region_(region), reach_(std::max(1, static_cast<int>(std::ceil(2 * sigma)))),
          length_(3 * static_cast<size_t>(region.width)), padded_(length_ + 6 * static_cast<size_t>(reach_)),
          soft_(length_) {
        float sum = 0;
        for (int k = 0; k <= reach_; ++k) {
            weight_.push_back(static_cast<float>(std::exp(-k * k / (2 * sigma * sigma))));
            sum += (k ? 2 : 1) * weight_.back();
        }
        for (float& w : weight_) w /= sum;
        ring_.assign(static_cast<size_t>(2 * reach_ + 1), std::vector<float>(length_));
        for (int y = -reach_; y < reach_; ++y) read(y);
    }

    // Rows must be asked for in order, from 0. Three values a pixel.
    const std::vector<float>& row(int y) {
        read(y + reach_);
        const std::vector<float>& middle = slot(y);
        for (size_t i = 0; i < length_; ++i) soft_[i] = weight_[0] * middle[i];
        for (int k = 1; k <= reach_; ++k) {
            const std::vector<float>&above = slot(y - k), &below = slot(y + k);
            const float w = weight_[static_cast<size_t>(k)];
            for (size_t i = 0; i < length_; ++i) soft_[i] += w * (above[i] + below[i]);
        }
        return soft_;
    }

private:
    std::vector<float>& slot(int y) { return ring_[static_cast<size_t>(y + reach_) % ring_.size()]; }

    void read(int y) {
        const Photograph& photo = view_.photo();
        const auto& linear = view_.linearFromByte();
        const int inPhoto = std::clamp(y + region_.y0, 0, photo.height - 1);
        const uint8_t* bytes =
            &photo.rgb[3 * (static_cast<size_t>(inPhoto) * static_cast<size_t>(photo.width) +
                            static_cast<size_t>(region_.x0))];
        const size_t pad = 3 * static_cast<size_t>(reach_);
        for (size_t i = 0; i < length_; ++i) padded_[pad + i] = linear[bytes[i]];
        for (size_t i = 0; i < pad; ++i) {
            padded_[i] = padded_[pad + i % 3];
            padded_[pad + length_ + i] = padded_[pad + length_ - 3 + i % 3];
        }
        std::vector<float>& out = slot(y);
        const float* in = padded_.data() + pad;
        for (size_t i = 0; i < length_; ++i) out[i] = weight_[0] * in[i];
        for (int k = 1; k <= reach_; ++k) {
            const float w = weight_[static_cast<size_t>(k)];
            const float *before = in - 3 * k, *after = in + 3 * k;
            for (size_t i = 0; i < length_; ++i) out[i] += w * (before[i] + after[i]);
        }
    }

    const PlanView& view_;
    const TableRegion& region_;
    int reach_;
    size_t length_;
    std::vector<float> weight_, padded_, soft_;
    std::vector<std::vector<float>> ring_;
};

std::vector<Coloured> findColoured(const PlanView& view, const TableRegion& region, const WhiteMap& white,
                                   const DetectOptions& options) {
    std::vector<Coloured> out;
    const float minSaturation = static_cast<float>(options.minSaturation);
    // By ground. Beyond the table there is only dark floor to tell from the lit top of a wall.
    const float minBright[3] = {1e9f, static_cast<float>(options.minBrightnessOffTable),
                                static_cast<float>(options.minBrightness)};
    // Averages as much as the noise asks for: a token's rim is only about four pixels wide.
    SoftRows rows(view, region, std::clamp(0.5 + 12 * white.noise, 0.5, 1.5));
    for (int y = 0; y < region.height; ++y) {
        const float* row = rows.row(y).data();
        const size_t start = static_cast<size_t>(y) * static_cast<size_t>(region.width);
        const Ground* ground = region.ground.data() + start;
        const glm::vec3* light =
            white.light.data() + static_cast<size_t>(y / kBlock) * static_cast<size_t>(white.columns);
        for (int block = 0; block < white.columns; ++block) {
            const glm::vec3 gain = 1.0f / light[block];
            const int end = std::min(region.width, (block + 1) * kBlock);
            for (int x = block * kBlock; x < end; ++x) {
                const float r = gain.r * row[3 * x], g = gain.g * row[3 * x + 1], b = gain.b * row[3 * x + 2];
                const float high = std::max(std::max(r, g), b), low = std::min(std::min(r, g), b);
                if (high - low < minSaturation * high) continue;
                if (high < minBright[static_cast<size_t>(ground[x])]) continue;
                const float hue = hueOf(r, g, b, high, low);
                out.push_back({static_cast<uint32_t>(start) + static_cast<uint32_t>(x),
                               static_cast<uint16_t>(static_cast<int>(hue + 0.5f) % 360),
                               static_cast<uint8_t>(255 * (high - low) / high)});
            }
        }
    }
    return out;
}

float hueDistance(float a, float b) {
    const float d = std::abs(a - b);
    return std::min(d, 360 - d);
}

struct Peak {
    float hue, mass;
};

std::vector<Peak> findPeaks(const std::array<float, 360>& bins) {
    std::array<float, 360> smooth{};
    for (size_t h = 0; h < 360; ++h)
        for (size_t d = 0; d < 7; ++d) smooth[h] += bins[(h + d + 357) % 360];
    std::vector<Peak> peaks;
    for (size_t h = 0; h < 360; ++h) {
        if (smooth[h] < 40) continue; // half of the smallest piece of paint, in pixels
        bool highest = true;
        for (size_t d = 1; d <= 8; ++d) // first of equals
            highest =
                highest && smooth[h] >= smooth[(h + d) % 360] && smooth[h] > smooth[(h + 360 - d) % 360];
        if (!highest) continue;
        float moment = 0;
        for (size_t d = 0; d < 7; ++d) moment += bins[(h + d + 357) % 360] * (static_cast<float>(d) - 3);
        peaks.push_back({static_cast<float>(h) + moment / smooth[h], smooth[h]});
    }
    return peaks;
}

// Each paint's hue is a peak of the picture's hues near the nominal one; a paint that is not there keeps the
// nominal. Nearest pairs first, one paint to a peak, so that without red walls the arrow's orange is not
// taken for a red.
std::array<float, kPaints> learnHues(const std::vector<Coloured>& coloured) {
    std::array<std::array<float, 360>, 2> histogram{};
    for (const Coloured& c : coloured) histogram[c.saturation < kVivid][c.hue] += 1;
    std::array<float, kPaints> learned = kNominalHue;
    std::array<bool, kPaints> known{};
    for (const bool pale : {false, true}) {
        std::vector<Peak> peaks = findPeaks(histogram[pale]);
        for (;;) {
            float best = kHueReach;
            size_t bestPaint = 0, bestPeak = 0;
            for (size_t paint = 1; paint < kPaints; ++paint)
                for (size_t k = 0; k < peaks.size(); ++k) {
                    if (known[paint] || (static_cast<Paint>(paint) == Paint::sky) != pale) continue;
                    const float d = hueDistance(kNominalHue[paint], peaks[k].hue);
                    if (d < best) best = d, bestPaint = paint, bestPeak = k;
                }
            if (bestPaint == 0) break;
            known[bestPaint] = true;
            learned[bestPaint] = peaks[bestPeak].hue;
            peaks.erase(peaks.begin() + static_cast<std::ptrdiff_t>(bestPeak));
        }
    }
    return learned;
}

// [vivid, pale][hue]. Only a pale pixel can be skylight: the light blue lies between the cyan and the blue in
// hue.
std::array<std::array<Paint, 360>, 2> nearestPaint(const std::array<float, kPaints>& hues) {
    std::array<std::array<Paint, 360>, 2> table{};
    for (size_t pale = 0; pale < 2; ++pale)
        for (size_t hue = 0; hue < 360; ++hue) {
            float best = 1e9f;
            for (size_t paint = 1; paint < kPaints; ++paint) {
                if (static_cast<Paint>(paint) == Paint::sky && !pale) continue;
                const float d = hueDistance(hues[paint], static_cast<float>(hue));
                if (d < best) best = d, table[pale][hue] = static_cast<Paint>(paint);
            }
        }
    return table;
}

// The blurred rim of cyan paint is pale and may have the skylights' hue: beside vivid cyan it is cyan.
void settleRims(ClassImage& image, const std::vector<Coloured>& coloured) {
    std::vector<uint8_t> vividCyan(image.paint.size(), 0);
    bool any = false;
    for (const Coloured& c : coloured)
        if (c.saturation >= kVivid && image.paint[c.index] == Paint::cyan) vividCyan[c.index] = 1, any = true;
    if (!any) return;
    const int w = image.width;
    for (const Coloured& c : coloured) {
        if (c.saturation >= kVivid || groupOf(image.paint[c.index]) != Paint::blue) continue;
        const int x = static_cast<int>(c.index) % w, y = static_cast<int>(c.index) / w;
        for (const auto& [dx, dy] :
             {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {2, 0}, {-2, 0}, {0, 2}, {0, -2}}) {
            if (x + dx < 0 || x + dx >= w || y + dy < 0 || y + dy >= image.height) continue;
            if (vividCyan[static_cast<size_t>(y + dy) * static_cast<size_t>(w) + static_cast<size_t>(x + dx)])
                image.paint[c.index] = Paint::cyan;
        }
    }
}

} // namespace

ClassImage classifyPixels(const PlanView& view, const geometry::Rig& rig, const DetectOptions& options) {
    const TableRegion region = findTable(view, rig.tableRadius / geometry::kMetresPerInch, kOverEdge);
    ClassImage out;
    out.hueDegrees = kNominalHue;
    out.x0 = region.x0, out.y0 = region.y0, out.width = region.width, out.height = region.height;
    out.paint.assign(region.ground.size(), Paint::none);
    const WhiteMap white = region.ground.empty() ? WhiteMap{} : findWhite(view, region);
    out.hasTable = !white.light.empty();
    if (!out.hasTable) return out;
    const auto coloured = findColoured(view, region, white, options);
    out.hueDegrees = learnHues(coloured);
    const auto paintOfHue = nearestPaint(out.hueDegrees);
    for (const Coloured& c : coloured) out.paint[c.index] = paintOfHue[c.saturation < kVivid][c.hue];
    settleRims(out, coloured);
    return out;
}

} // namespace heliodon::vision
