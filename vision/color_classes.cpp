// The paper's P' = (P - Pmin) / Pmax (section 4.1) on linear light that is first divided by the light on the
// white table near by. So neither the tubes' and the projectors' differing white nor the camera's gains enter
// the thresholds: what is left is the paint. The hues that separate the paints follow from those found in the
// picture.
#include "vision/color_classes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "geometry/sketch.h"

namespace heliodon::vision {
namespace {

constexpr int kBlock = 8;          // pixels; white is estimated on blocks
constexpr float kScale = 65535.0f; // linear 16-bit

// Hues of the paints in linear light; only their order round the circle and their rough places are assumed.
constexpr std::array<float, kPaints> kNominalHue = {0, 1, 20, 47, 130, 188, 208, 229, 325};

constexpr double kOverEdge = 2; // inches that a wall may stick out over the table
constexpr float kHueReach = 16; // degrees that a paint's hue may lie from the nominal
constexpr uint8_t kVivid =
    176; // of 255: walls, markers and the arrow are more saturated, the light-blue card less

// The table's disc and, about it, where the top of a 10 in wall at its edge can be.
struct Region {
    cv::Rect box;
    cv::Mat table, all; // masks over the box
};

std::vector<cv::Point> circle(const PlanView& view, double radius, double height) {
    std::vector<cv::Point> points;
    for (int i = 0; i < 96; ++i) {
        const double a = 2 * std::numbers::pi * i / 96;
        const glm::dvec2 p = view.pixel(radius * glm::dvec2(std::cos(a), std::sin(a)), height);
        points.emplace_back(static_cast<int>(std::lround(std::clamp(p.x, -1e4, 1e4))),
                            static_cast<int>(std::lround(std::clamp(p.y, -1e4, 1e4))));
    }
    return points;
}

Region findRegion(const PlanView& view, double radiusInches) {
    const auto disc = circle(view, radiusInches, 0);
    std::vector<cv::Point> all = disc, hull;
    for (const auto& p :
         circle(view, radiusInches + kOverEdge, geometry::heightInches(geometry::HeightClass::red)))
        all.push_back(p);
    cv::convexHull(all, hull);
    Region region;
    region.box = cv::boundingRect(hull) & cv::Rect(0, 0, view.photo().width, view.photo().height);
    if (region.box.width < 4 * kBlock || region.box.height < 4 * kBlock) {
        region.box = {};
        return region;
    }
    region.table = cv::Mat::zeros(region.box.size(), CV_8U);
    region.all = cv::Mat::zeros(region.box.size(), CV_8U);
    cv::fillConvexPoly(region.all, hull, 255, cv::LINE_8, 0);
    const cv::Point corner = region.box.tl();
    auto shifted = [&](std::vector<cv::Point> points) {
        for (auto& p : points) p -= corner;
        return points;
    };
    region.all.setTo(0);
    cv::fillConvexPoly(region.all, shifted(hull), 255);
    cv::fillConvexPoly(region.table, shifted(disc), 255);
    return region;
}

float median(std::vector<float>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// Standard deviation of a pixel on the table over its value: median of second differences, which edges do not
// move.
double relativeNoise(const cv::Mat& linear, const cv::Mat& table) {
    std::vector<float> samples;
    for (int y = 4; y < linear.rows - 4; y += 13) {
        const auto* row = linear.ptr<cv::Vec<uint16_t, 3>>(y);
        for (int x = 4; x < linear.cols - 4; x += 17) {
            if (!table.at<uint8_t>(y, x) || row[x][1] == 0) continue;
            const int bend = row[x - 2][1] - 2 * row[x][1] + row[x + 2][1];
            samples.push_back(static_cast<float>(std::abs(bend)) / static_cast<float>(row[x][1]));
        }
    }
    if (samples.empty()) return 0;
    return static_cast<double>(median(samples)) * 1.4826 /
           std::sqrt(6.0); // the weights 1, -2, 1 add to 6 in variance
}

cv::Mat linearised(const PlanView& view, const cv::Rect& box, const cv::Mat& table) {
    const Photograph& photo = view.photo();
    const cv::Mat bytes(photo.height, photo.width, CV_8UC3, const_cast<uint8_t*>(photo.rgb.data()));
    cv::Mat lut(1, 256, CV_16U), out;
    for (int i = 0; i < 256; ++i)
        lut.at<uint16_t>(i) =
            cv::saturate_cast<uint16_t>(kScale * view.linearFromByte()[static_cast<size_t>(i)]);
    cv::LUT(bytes(box), lut, out);
    // Averages as much as the noise asks for: a token's rim is only about four pixels wide.
    const double sigma = std::clamp(0.5 + 12 * relativeNoise(out, table), 0.5, 1.5);
    const int size = 2 * static_cast<int>(std::ceil(2 * sigma)) + 1;
    cv::GaussianBlur(out, out, cv::Size(size, size), sigma);
    return out;
}

// Light on white per block: blocks that look like the table, spread over those that do not.
struct WhiteMap {
    cv::Mat light; // CV_32FC3, blocks; empty: no table to be seen
};

WhiteMap findWhite(const cv::Mat& linear, const cv::Mat& table) {
    const cv::Size blocks((linear.cols + kBlock - 1) / kBlock, (linear.rows + kBlock - 1) / kBlock);
    cv::Mat small, smallTable, light;
    cv::resize(linear, small, blocks, 0, 0, cv::INTER_AREA);
    cv::resize(table, smallTable, blocks, 0, 0, cv::INTER_AREA);
    small.convertTo(light, CV_32FC3, 1 / kScale);

    std::vector<float> brightness, redGreen, blueGreen;
    auto onTable = [&](int y, int x) { return smallTable.at<uint8_t>(y, x) == 255; };
    for (int y = 0; y < blocks.height; ++y)
        for (int x = 0; x < blocks.width; ++x)
            if (onTable(y, x)) brightness.push_back(light.at<cv::Vec3f>(y, x)[1]);
    if (brightness.size() < 16) return {};
    const float typical = median(brightness);
    if (typical < 1e-4f) return {};
    for (int y = 0; y < blocks.height; ++y)
        for (int x = 0; x < blocks.width; ++x) {
            const cv::Vec3f p = light.at<cv::Vec3f>(y, x);
            if (!onTable(y, x) || p[1] < 0.3f * typical) continue;
            redGreen.push_back(std::log((p[0] + 1e-6f) / p[1]));
            blueGreen.push_back(std::log((p[2] + 1e-6f) / p[1]));
        }
    const float rg = median(redGreen), bg = median(blueGreen);

    // Twice: first against the whole table's white, then, tighter, against the white found near by.
    cv::Mat smooth;
    for (int pass = 0; pass < 2; ++pass) {
        cv::Mat weight(blocks, CV_32F, cv::Scalar(0)), weighted(blocks, CV_32FC3, cv::Scalar::all(0)), spread;
        const float limit = pass == 0 ? 0.32f : 0.25f;
        for (int y = 0; y < blocks.height; ++y)
            for (int x = 0; x < blocks.width; ++x) {
                const cv::Vec3f p = light.at<cv::Vec3f>(y, x);
                if (!onTable(y, x) || p[1] < 0.1f * typical) continue;
                float expectRg = rg, expectBg = bg;
                if (pass == 1) {
                    const cv::Vec3f near = smooth.at<cv::Vec3f>(y, x);
                    if (p[1] < 0.2f * near[1]) continue;
                    expectRg = std::log(near[0] / near[1]), expectBg = std::log(near[2] / near[1]);
                }
                if (std::abs(std::log((p[0] + 1e-6f) / p[1]) - expectRg) > limit) continue;
                if (std::abs(std::log((p[2] + 1e-6f) / p[1]) - expectBg) > limit) continue;
                weight.at<float>(y, x) = 1;
                weighted.at<cv::Vec3f>(y, x) = p;
            }
        if (cv::countNonZero(weight) < 16) return {};
        // A narrow window follows the light; a wide one, with little weight, reaches where no white is near.
        const double narrow = pass == 0 ? 4 : 3;
        cv::Mat weightNarrow, weightWide, lightNarrow, lightWide;
        cv::GaussianBlur(weight, weightNarrow, {}, narrow);
        cv::GaussianBlur(weight, weightWide, {}, 4 * narrow);
        cv::GaussianBlur(weighted, lightNarrow, {}, narrow);
        cv::GaussianBlur(weighted, lightWide, {}, 4 * narrow);
        smooth.create(blocks, CV_32FC3);
        for (int y = 0; y < blocks.height; ++y)
            for (int x = 0; x < blocks.width; ++x) {
                const float total = weightNarrow.at<float>(y, x) + 0.02f * weightWide.at<float>(y, x);
                const cv::Vec3f sum = lightNarrow.at<cv::Vec3f>(y, x) + 0.02f * lightWide.at<cv::Vec3f>(y, x);
                const cv::Vec3f global(typical * std::exp(rg), typical, typical * std::exp(bg));
                const cv::Vec3f value = total > 1e-6f ? sum / total : global;
                for (int c = 0; c < 3; ++c) smooth.at<cv::Vec3f>(y, x)[c] = std::max(value[c], 1e-5f);
            }
    }
    return {smooth};
}

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

std::vector<Coloured> findColoured(const cv::Mat& linear, const Region& region, const WhiteMap& white,
                                   const DetectOptions& options) {
    std::vector<Coloured> out;
    const float minSaturation = static_cast<float>(options.minSaturation);
    // Beyond the table there is only dark floor to tell from the lit top of a wall.
    const float minBright[2] = {static_cast<float>(options.minBrightnessOffTable),
                                static_cast<float>(options.minBrightness)};
    for (int y = 0; y < linear.rows; ++y) {
        const uint16_t* row = linear.ptr<uint16_t>(y);
        const uint8_t* inside = region.all.ptr<uint8_t>(y);
        const uint8_t* onTable = region.table.ptr<uint8_t>(y);
        const cv::Vec3f* light = white.light.ptr<cv::Vec3f>(y / kBlock);
        for (int block = 0; block * kBlock < linear.cols; ++block) {
            const cv::Vec3f w = light[block];
            const float gr = 1 / (kScale * w[0]), gg = 1 / (kScale * w[1]), gb = 1 / (kScale * w[2]);
            const int end = std::min(linear.cols, (block + 1) * kBlock);
            for (int x = block * kBlock; x < end; ++x) {
                const float r = gr * row[3 * x], g = gg * row[3 * x + 1], b = gb * row[3 * x + 2];
                const float high = std::max({r, g, b}), low = std::min({r, g, b});
                if (high - low < minSaturation * high || !inside[x] || high < minBright[onTable[x] != 0])
                    continue;
                const float hue = hueOf(r, g, b, high, low);
                out.push_back(
                    {static_cast<uint32_t>(y) * static_cast<uint32_t>(linear.cols) + static_cast<uint32_t>(x),
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
    const Region region = findRegion(view, rig.tableRadius / geometry::kMetresPerInch);
    ClassImage out;
    out.hueDegrees = kNominalHue;
    out.x0 = region.box.x, out.y0 = region.box.y, out.width = region.box.width,
    out.height = region.box.height;
    out.paint.assign(static_cast<size_t>(region.box.area()), Paint::none);
    out.hasTable = false;
    if (region.box.empty()) return out;
    const cv::Mat linear = linearised(view, region.box, region.table);
    const WhiteMap white = findWhite(linear, region.table);
    if (white.light.empty()) return out;
    out.hasTable = true;
    const auto coloured = findColoured(linear, region, white, options);
    out.hueDegrees = learnHues(coloured);
    const auto paintOfHue = nearestPaint(out.hueDegrees);
    for (const Coloured& c : coloured) out.paint[c.index] = paintOfHue[c.saturation < kVivid][c.hue];
    settleRims(out, coloured);
    return out;
}

} // namespace heliodon::vision
