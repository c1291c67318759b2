// The paper's P' = (P - Pmin) / Pmax (section 4.1) on linear light that is first divided by the light on the
// white table near by. So neither the tubes' and the projectors' differing white nor the camera's gains enter
// the thresholds: what is left is the paint. The hues that separate the paints follow from those found in the
// picture.
#include "vision/color_classes.h"

#include <algorithm>
#include <cmath>

#include <glm/exponential.hpp>

#include "geometry/sketch.h"
#include "vision/chroma.h"
#include "vision/paint_hues.h"
#include "vision/rounding.h"
#include "vision/white_map.h"

namespace heliodon::vision {
namespace {

constexpr double kMarkerReach = 0.4; // inches, more than half of a marker's top, seen nearer than the table
constexpr float kFaint = 0.23f;      // of P': nothing below is card
constexpr float kFaintRim = 0.14f;   // of P' of a token's rim, blurred
constexpr float kSure = 0.6f;        // of the least P' of paint: what rounding leaves of it for certain
constexpr double kNoiseOfFaint = 6;  // deviations
constexpr double kBeyond = 2;        // inches beyond the table's edge that are looked at

// The table itself, where it is not white, and what lies between it and card in a blurred edge or in the
// light that it throws on to card: a sum of both has the table's hue and is no more saturated, nor much
// brighter than one so saturated, as an orange arrow on dark wood is.
bool isTableOrCard(glm::vec3 p, glm::vec3 card, float minSaturation) {
    constexpr float kSameHue = 12, kMore = 1.1f, kBrighter = 3; // degrees; of P'; of the sum
    if (saturationOf(card * p) < minSaturation) return true;
    const glm::vec3 table = 1.0f / card;
    const float most = saturationOf(table);
    if (most < kFaint || saturationOf(p) > kMore * most) return false;
    const float apart = std::abs(hueOf(p) - hueOf(table)), saturation = saturationOf(p);
    const float high = std::max({table.r, table.g, table.b});
    const float share = std::min(1.0f, saturation / (saturation * (1 - high) + most * high)); // of the table
    return std::min(apart, 360 - apart) < kSameHue &&
           std::max({p.r, p.g, p.b}) < kBrighter * (1 - share * (1 - high));
}

// As bright as white in all channels: white in a light of another colour, or so bright that its colour was
// cut off. Paint so pale is darker and paint so bright, as on a dark table, less pale; but for light-blue
// card.
bool isBrightAsWhite(float low, float saturation, float hue, bool whiteTable) {
    constexpr float kAsWhite = 0.8f, kPale = 0.6f;     // of white; of P'
    constexpr float kFirstBlue = 190, kLastBlue = 230; // degrees
    return low > kAsWhite && saturation < kPale && (whiteTable || !(hue > kFirstBlue && hue < kLastBlue));
}

// Whether much of the table returns nearly as much as the brightest that lies on it, which where walls stand
// is card.
bool nothingOutshines(const PlanView& view, const TableRegion& region) {
    constexpr int kStep = 4;                                            // pixels
    constexpr double kBrightest = 0.9993, kNearly = 0.75, kShare = 0.1; // rank; of its light; of the table
    const Photograph& photo = view.photo();
    std::array<size_t, 256> histogram{};
    size_t all = 0;
    for (int y = 0; y < region.height; y += kStep)
        for (int x = 0; x < region.width; x += kStep) {
            if (!region.isTable(x, y)) continue;
            ++histogram[photo.rgb[3 * (static_cast<size_t>(y + region.y0) * static_cast<size_t>(photo.width) +
                                       static_cast<size_t>(x + region.x0)) +
                                  1]];
            ++all;
        }
    size_t level = 0, below = 0, nearly = 0;
    while (level < 255 &&
           static_cast<double>(below + histogram[level]) < kBrightest * static_cast<double>(all))
        below += histogram[level++];
    const auto& linear = view.linearFromByte();
    for (size_t v = 0; v < 256; ++v)
        if (linear[v] > kNearly * linear[level]) nearly += histogram[v];
    return static_cast<double>(nearly) > kShare * static_cast<double>(all);
}

// No brighter than the noise of a dark table, of which each pixel has another colour.
bool isDarkTable(glm::vec3 p, glm::vec3 card, float brightest) {
    p *= card;
    return std::max(std::max(p.r, p.g), p.b) < brightest;
}
constexpr double kNoiseOfWhite = 3, kMostOfWhite = 0.4; // deviations; of P'
constexpr double kNoiseOfTable = 3, kMostNoise = 3;     // deviations; times as bright
constexpr float kGrain = 1.3f;

// White in a shadow that only a second light reaches: darker than the white about it, and white by that
// light.
constexpr float kShade = 0.9f, kShadeWhite = 0.2f;

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

// So saturated a paint is not light-blue card, and most likely a wall's top or a marker on it: they stand in
// the light that no wall keeps from them.
constexpr float kVividPaint = 0.65f; // of P'

struct ColouredPixels {
    std::vector<Coloured> vivid,
        faint; // faint: of a thin rim, that the lens has mixed with the white beside it
};

ColouredPixels findColoured(const PlanView& view, const TableRegion& region, const WhiteMap& white,
                            const DetectOptions& options) {
    ColouredPixels out;
    const double noise = white.noiseOfWhite();
    const float minSaturation = static_cast<float>(
        white.darkTable ? std::clamp(kNoiseOfWhite * noise, options.minSaturation, kMostOfWhite)
                        : options.minSaturation);
    const float leastFaint = std::min(kFaint, std::max(kFaintRim, static_cast<float>(kNoiseOfFaint * noise)));
    // Of P' against a table of another colour; dark ones are noisier than all else.
    const float notTable = white.darkTable
                               ? minSaturation
                               : std::max(minSaturation, std::min(4 * static_cast<float>(white.noise), 0.6f));
    const bool whiteTable = nothingOutshines(view, region);
    const ColourRounding rounding(view);
    // By ground. Beyond the table there is only dark floor to tell from the lit top of a wall.
    // Noise has every colour: where little light comes from, a pixel must stand well out of it.
    const double offTable = std::max(options.minBrightnessOffTable, 4.5 * noise);
    const float minBright[3] = {1e9f, static_cast<float>(offTable),
                                static_cast<float>(options.minBrightness)};
    const float brightest = kGrain + static_cast<float>(std::min(kNoiseOfTable * white.noise, kMostNoise));
    // Averages as much as the noise asks for: a token's rim is only about four pixels wide.
    SoftRows rows(view, region, std::clamp(0.5 + 12 * noise, 0.5, 1.5));
    for (int y = 0; y < region.height; ++y) {
        const float* row = rows.row(y).data();
        const size_t start = static_cast<size_t>(y) * static_cast<size_t>(region.width);
        const Ground* ground = region.ground.data() + start;
        const glm::vec3* light = white.grid.light.data() +
                                 static_cast<size_t>(y / kBlock) * static_cast<size_t>(white.grid.columns);
        const auto firstBlock = static_cast<size_t>(light - white.grid.light.data());
        for (int block = 0; block < white.grid.columns; ++block) {
            const glm::vec3 gain = 1.0f / light[block];
            const int end = std::min(region.width, (block + 1) * kBlock);
            glm::vec3 shade(1), penumbra(1);
            if (white.secondLight) {
                shade = light[block] / *white.secondLight;
                penumbra = glm::sqrt(shade);
            }
            for (int x = block * kBlock; x < end; ++x) {
                const float r = gain.r * row[3 * x], g = gain.g * row[3 * x + 1], b = gain.b * row[3 * x + 2];
                const float high = std::max(std::max(r, g), b), low = std::min(std::min(r, g), b);
                if (high - low < leastFaint * high) continue;
                const bool vivid =
                    high - low >= minSaturation * high ||
                    (high - low >= kFaint * high &&
                     PaintTable::isFadedSky(hueOf(r, g, b, high, low), (high - low) / high, high));
                if (white.lights && white.isMixture({row[3 * x], row[3 * x + 1], row[3 * x + 2]},
                                                    firstBlock + static_cast<size_t>(block)))
                    continue;
                if (white.card && isTableOrCard({r, g, b}, *white.card, notTable)) continue;
                if (high < minBright[static_cast<size_t>(ground[x])]) continue;
                if (white.darkTable && isDarkTable({r, g, b}, *white.card, brightest)) continue;
                if (white.secondLight && (high < kShade || high - low < minSaturation * high)) {
                    const glm::vec3 p(r, g, b);
                    if (saturationOf(p * shade) < kShadeWhite || saturationOf(p * penumbra) < kShadeWhite)
                        continue;
                }
                float hue = hueOf(r, g, b, high, low);
                if (white.lights && high - low > kVividPaint * high) {
                    const glm::vec3 p = glm::vec3(row[3 * x], row[3 * x + 1], row[3 * x + 2]) /
                                        white.full[firstBlock + static_cast<size_t>(block)];
                    if (saturationOf(p) > minSaturation) hue = hueOf(p);
                }
                const float least =
                    rounding.leastSaturation({row[3 * x], row[3 * x + 1], row[3 * x + 2]}, gain);
                if (least < kSure * (vivid ? minSaturation : leastFaint)) continue;
                if (vivid && isBrightAsWhite(low, (high - low) / high, hue, whiteTable)) continue;
                (vivid ? out.vivid : out.faint)
                    .push_back({static_cast<uint32_t>(start) + static_cast<uint32_t>(x),
                                static_cast<uint16_t>(static_cast<int>(hue + 0.5f) % 360),
                                static_cast<uint8_t>(255 * (high - low) / high),
                                static_cast<uint8_t>(std::min(255.0f, 128 * high))});
            }
        }
    }
    return out;
}

constexpr glm::vec3 kSky(0.42f, 0.66f, 0.92f); // light-blue card over white

// Whether light-blue card would be taken for bare table, of which it has the colour.
bool takesSkyForTable(const WhiteMap& white, const DetectOptions& options) {
    return white.card && !white.darkTable &&
           isTableOrCard(kSky, *white.card, static_cast<float>(options.minSaturation));
}

// Whether it is white by the light that falls on much of the table where a second light alone falls on it.
bool takesSkyForShade(const WhiteMap& white, const DetectOptions& options) {
    constexpr double kShare = 0.2; // of the table
    if (!white.secondLight) return false;
    const auto hidden = std::count_if(white.grid.light.begin(), white.grid.light.end(), [&](glm::vec3 light) {
        return saturationOf(kSky * *white.secondLight / light) < options.minSaturation;
    });
    return static_cast<double>(hidden) > kShare * static_cast<double>(white.grid.light.size());
}

// Not on the table, or within two pixels of its edge, which are in part of the floor's colour.
bool mayBeFloor(const TableRegion& region, uint32_t index) {
    constexpr int kEdge = 2;
    const int x = static_cast<int>(index) % region.width, y = static_cast<int>(index) / region.width;
    for (const auto& [i, j] :
         {std::pair{x, y}, {x - kEdge, y}, {x + kEdge, y}, {x, y - kEdge}, {x, y + kEdge}})
        if (i >= 0 && j >= 0 && i < region.width && j < region.height &&
            region.ground[static_cast<size_t>(j) * static_cast<size_t>(region.width) +
                          static_cast<size_t>(i)] != Ground::table)
            return true;
    return false;
}

// The floor beside the table, a cloth or a chair may have a paint's colour. Tops of walls at the table's edge
// cover little there; where one paint covers more, only what is brighter than most of it can be a wall.
void dropFloor(std::vector<Coloured>& coloured, const TableRegion& region, const ClassImage& image) {
    constexpr double kShareOfFloor = 0.06;
    std::array<std::array<int, 256>, kPaints> histogram{};
    for (const Coloured& c : coloured)
        if (region.ground[c.index] != Ground::table)
            ++histogram[static_cast<size_t>(groupOf(image.paint[c.index]))][c.brightness];
    const auto floor = std::count(region.ground.begin(), region.ground.end(), Ground::besideTable);
    auto limitOf = [&](const std::array<int, 256>& levels) {
        int all = 0, below = 0, level = 0;
        for (const int n : levels) all += n;
        if (all < kShareOfFloor * static_cast<double>(floor)) return 0;
        while (level < 255 && below < 0.95 * all) below += levels[static_cast<size_t>(level++)];
        return std::min(255, level + level / 5);
    };
    constexpr std::array kCircle{Paint::red,  Paint::yellow, Paint::green,
                                 Paint::cyan, Paint::blue,   Paint::magenta}; // neighbours in hue
    constexpr size_t n = kCircle.size();
    std::array<int, n> own{};
    std::array<int, 256> rest{}; // of paints that cover little: of all of them where they are noise
    for (size_t i = 0; i < n; ++i) {
        const auto& levels = histogram[static_cast<size_t>(kCircle[i])];
        own[i] = limitOf(levels);
        for (size_t level = 0; own[i] == 0 && level < 256; ++level) rest[level] += levels[level];
    }
    // A floor of a hue between two has some of the other's pixels.
    const int noise = limitOf(rest);
    std::array<int, kPaints> limit{};
    for (size_t i = 0; i < n; ++i)
        limit[static_cast<size_t>(kCircle[i])] =
            own[i] ? own[i] : std::max({noise, own[(i + 1) % n], own[(i + n - 1) % n]});
    std::erase_if(coloured, [&](const Coloured& c) {
        const int brightest = limit[static_cast<size_t>(groupOf(image.paint[c.index]))];
        return c.brightness <= brightest && mayBeFloor(region, c.index);
    });
}

// The blurred rim of cyan paint is pale and may have the skylights' hue: beside vivid cyan it is cyan.
void settleRims(ClassImage& image, const std::vector<Coloured>& coloured, float saturation) {
    const auto vivid = static_cast<uint8_t>(0.8f * 255 * saturation);
    std::vector<uint8_t> vividCyan(image.paint.size(), 0);
    bool any = false;
    for (const Coloured& c : coloured)
        if (c.saturation >= vivid && image.paint[c.index] == Paint::cyan) vividCyan[c.index] = 1, any = true;
    if (!any) return;
    const int w = image.width;
    for (const Coloured& c : coloured) {
        if (c.saturation >= vivid || groupOf(image.paint[c.index]) != Paint::blue) continue;
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

ClassImage classifyPixels(const PlanView& view, const geometry::Rig& rig, const DetectOptions& options,
                          const std::optional<CardWhite>& card) {
    const TableRegion region = findTable(view, rig.tableRadius / geometry::kMetresPerInch, kBeyond);
    ClassImage out;
    out.x0 = region.x0, out.y0 = region.y0, out.width = region.width, out.height = region.height;
    out.paint.assign(region.ground.size(), Paint::none);
    const WhiteMap white = region.ground.empty() ? WhiteMap{} : findWhite(view, region, card);
    out.hasTable = !white.grid.light.empty();
    if (!out.hasTable) return out;
    auto [coloured, faint] = findColoured(view, region, white, options);
    auto paint = [&, &coloured = coloured](const PaintTable& paints) {
        std::fill(out.paint.begin(), out.paint.end(), Paint::none);
        for (const Coloured& c : coloured) out.paint[c.index] = paints.at(c.hue, c.saturation);
    };
    paint(PaintTable{});
    dropFloor(coloured, region, out);
    const double perInch = view.pixelsPerInch(glm::dvec2(0), 0);
    const PaintTable learned(coloured, region.width, std::max(2, static_cast<int>(kMarkerReach * perInch)));
    paint(learned);
    out.white = white.grid, out.noise = white.noiseOfWhite();
    if (white.card) out.whiteOverTable = *white.card;
    out.hidesSky = takesSkyForTable(white, options);
    out.twoLights = white.lights.has_value();
    out.shadeHidesSky = out.twoLights || takesSkyForShade(white, options);
    settleRims(out, coloured, learned.cyanSaturation());
    if (!faint.empty()) {
        constexpr uint8_t kVivid = 205; // only the hue counts
        out.withFaint = out.paint;
        size_t onTable = 0;
        for (const Coloured& c : faint) {
            if (region.ground[c.index] != Ground::table) continue;
            out.withFaint[c.index] = learned.at(c.hue, kVivid);
            ++onTable;
        }
        out.faintShare =
            static_cast<double>(onTable) /
            static_cast<double>(std::count(region.ground.begin(), region.ground.end(), Ground::table));
    }
    return out;
}

} // namespace heliodon::vision
