#include "vision/white_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "geometry/sketch.h"
#include "vision/card_white.h"
#include "vision/chroma.h"
#include "vision/median.h"
#include "vision/rounding.h"
#include "vision/two_lights.h"
#include "vision/two_means.h"

namespace heliodon::vision {
namespace {

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

// Median of second differences, which edges do not move.
double relativeNoise(const PlanView& view, const TableRegion& region) {
    const Photograph& photo = view.photo();
    const auto& linear = view.linearFromByte();
    std::vector<float> samples;
    for (int y = 4; y < region.height - 4; y += 13)
        for (int x = 4; x < region.width - 4; x += 17) {
            if (!region.isTable(x, y)) continue;
            const size_t at = 3 * (static_cast<size_t>(y + region.y0) * static_cast<size_t>(photo.width) +
                                   static_cast<size_t>(x + region.x0)) +
                              1;
            const float here = linear[photo.rgb[at]];
            if (here > 0)
                samples.push_back(std::abs(linear[photo.rgb[at - 6]] - 2 * here + linear[photo.rgb[at + 6]]) /
                                  here);
        }
    if (samples.empty()) return 0;
    return static_cast<double>(median(std::move(samples))) * 1.4826 /
           std::sqrt(6.0); // 1, -2, 1: six times the variance
}

constexpr float kBlockSamples = 4; // root of how many pixels a block's mean is of

// Mean light of each block, from every second pixel of every second row; w: 1 where all of it is table.
std::vector<cv::Vec4f> blockMeans(const PlanView& view, const TableRegion& region, const WhiteMap& map) {
    const Photograph& photo = view.photo();
    const auto& linear = view.linearFromByte();
    std::vector<cv::Vec4f> out(static_cast<size_t>(map.grid.columns) * static_cast<size_t>(map.grid.rows));
    for (int j = 0; j < map.grid.rows; ++j)
        for (int i = 0; i < map.grid.columns; ++i) {
            cv::Vec4f sum(0, 0, 0, 1);
            float n = 0;
            for (int y = j * kBlock; y < std::min(region.height, (j + 1) * kBlock); y += 2)
                for (int x = i * kBlock; x < std::min(region.width, (i + 1) * kBlock); x += 2) {
                    const size_t at =
                        static_cast<size_t>(y) * static_cast<size_t>(region.width) + static_cast<size_t>(x);
                    if (region.ground[at] != Ground::table) sum[3] = 0;
                    const uint8_t* p =
                        &photo
                             .rgb[3 * (static_cast<size_t>(y + region.y0) * static_cast<size_t>(photo.width) +
                                       static_cast<size_t>(x + region.x0))];
                    for (int c = 0; c < 3; ++c) sum[c] += linear[p[c]];
                    n += 1;
                }
            for (int c = 0; c < 3; ++c) sum[c] /= n;
            out[static_cast<size_t>(j) * static_cast<size_t>(map.grid.columns) + static_cast<size_t>(i)] =
                sum;
        }
    return out;
}

// Whether the quarters of a block have one colour: else paint or the edge of a shadow covers a part.
bool isEven(const PlanView& view, const TableRegion& region, int column, int row) {
    constexpr float kApart = 0.12f; // of P'
    const Photograph& photo = view.photo();
    const auto& linear = view.linearFromByte();
    std::array<glm::vec3, 4> quarter{};
    for (int y = 0; y < kBlock; ++y)
        for (int x = 0; x < kBlock; ++x) {
            const int inPhotoX = std::min(region.x0 + column * kBlock + x, photo.width - 1),
                      inPhotoY = std::min(region.y0 + row * kBlock + y, photo.height - 1);
            const uint8_t* p =
                &photo.rgb[3 * (static_cast<size_t>(inPhotoY) * static_cast<size_t>(photo.width) +
                                static_cast<size_t>(inPhotoX))];
            quarter[static_cast<size_t>(2 * (2 * y / kBlock) + 2 * x / kBlock)] +=
                glm::vec3(linear[p[0]], linear[p[1]], linear[p[2]]);
        }
    const glm::vec3 all = quarter[0] + quarter[1] + quarter[2] + quarter[3];
    return std::all_of(quarter.begin(), quarter.end(), [&](glm::vec3 q) {
        return saturationOf(q / glm::max(all, glm::vec3(1e-6f))) < kApart;
    });
}

// About as a Gaussian of that deviation does it.
cv::Mat spread(const cv::Mat& from, double sigma) {
    return twoMeans(from, static_cast<int>(std::lround(std::sqrt(6 * sigma * sigma + 1))) | 1);
}

// P' of the block's mean against a white: 0 where it has the white's chroma.
float saturation(const cv::Vec4f& p, const cv::Vec3f& white) {
    const float r = p[0] / white[0], g = p[1] / white[1], b = p[2] / white[2];
    const float high = std::max({r, g, b});
    return high > 0 ? (high - std::min({r, g, b})) / high : 1;
}

float brightest(const cv::Vec4f& p, const cv::Vec3f& white) {
    return std::max({p[0] / white[0], p[1] / white[1], p[2] / white[2]});
}

glm::vec2 chromaOf(const cv::Vec4f& p) {
    return chroma(p[0], p[1], p[2]);
}

// A white seen by the light of its neighbours, or by a lamp that the picture is not balanced for. Lights that
// follow one another smoothly over the table may differ by more: each block is held against those about it.
constexpr float kWhite = 0.2f; // of P'; the palest card has more
constexpr int kPasses = 3;     // each reaches some blocks further
constexpr float kShade = 0.8f; // brighter than that is no shadow: light-blue card returns more of the blue
constexpr float kSameLight = 0.12f;     // of log chroma
constexpr float kBetween = 0.07f;       // the same across the line that mixtures of two lights follow
constexpr double kShareOfTable = 0.012; // what a second light must have to itself; one skylight has less

// By its chroma; where the file rounds colours so that white may seem to be none, it has the benefit.
bool isWhite(const cv::Vec4f& p, const cv::Vec3f& white, const ColourRounding& rounding) {
    const float seen = saturation(p, white);
    if (seen < kWhite) return true;
    const float sure =
        rounding.leastSaturation({p[0], p[1], p[2]}, {1 / white[0], 1 / white[1], 1 / white[2]});
    const float ofWhite = 1 - (1 - seen) / (1 - sure); // what rounding makes of none
    return ofWhite > kWhite && sure < kWhite;
}

// Where the lamp that dominates is shut out, another light of another colour is alone: the commonest chroma
// of the dark blocks that are not white by the first light. Paint is vivid, or as bright as the white about
// it.
std::optional<glm::vec2> findSecondLight(const std::vector<cv::Vec4f>& blocks,
                                         const std::vector<cv::Vec3f>& near, float typical) {
    constexpr int kBins = 80;
    constexpr float kBin = 0.05f;
    std::vector<int> histogram(kBins * kBins, 0);
    std::vector<glm::vec2> dark;
    size_t table = 0;
    for (size_t i = 0; i < blocks.size(); ++i) {
        const cv::Vec4f& p = blocks[i];
        if (p[3] == 0) continue;
        ++table;
        const float s = saturation(p, near[i]);
        if (p[1] < 0.03f * typical || s < kWhite || s > 0.6f || brightest(p, near[i]) > kShade) continue;
        dark.push_back(chromaOf(p));
    }
    auto binOf = [&](float v) { return std::clamp(static_cast<int>(v / kBin) + kBins / 2, 1, kBins - 2); };
    for (const auto& c : dark) ++histogram[static_cast<size_t>(binOf(c[0]) * kBins + binOf(c[1]))];
    int best = 0, bestX = 0, bestY = 0;
    for (int x = 1; x < kBins - 1; ++x)
        for (int y = 1; y < kBins - 1; ++y) {
            int sum = 0;
            for (int dx = -1; dx <= 1; ++dx)
                for (int dy = -1; dy <= 1; ++dy)
                    sum += histogram[static_cast<size_t>((x + dx) * kBins + y + dy)];
            if (sum > best) best = sum, bestX = x, bestY = y;
        }
    if (best < kShareOfTable * static_cast<double>(table)) return std::nullopt;
    glm::vec2 mean(0, 0);
    for (const auto& c : dark)
        if (std::abs(binOf(c[0]) - bestX) <= 1 && std::abs(binOf(c[1]) - bestY) <= 1) mean += c;
    return mean * (1.0f / static_cast<float>(best));
}

// The chroma of a mixture of two lights, within the tolerance.
bool isMixture(const glm::vec2& c, const glm::vec2& first, const glm::vec2& second) {
    const glm::vec2 line = second - first, off = c - first;
    const float t = std::clamp(glm::dot(line, off) / std::max(glm::dot(line, line), 1e-6f), 0.0f, 1.0f);
    return glm::length(off - t * line) < (t < 1 ? kBetween : kSameLight);
}

bool isDark(const CardWhite& card) {
    return std::min({card.overTable.r, card.overTable.g, card.overTable.b}) > kDarkTable;
}

// Card instead of the table. A dark table's own colour is all noise and rounding, and says nothing of the
// light's: there card's is that of all of it.
void holdAgainstCard(WhiteMap& map, const CardWhite& card) {
    map.card = card.overTable;
    map.darkTable = isDark(card);
    const glm::vec3 colour(std::exp(card.light[0]), 1, std::exp(card.light[1]));
    for (glm::vec3& light : map.grid.light)
        light = map.darkTable ? light.g * card.overTable.g * colour : light * card.overTable;
}

// Light that blocks of table return, spread over those that are none.
struct Light {
    std::vector<cv::Vec3f> near;     // of each block; empty: no table
    std::optional<glm::vec2> second; // chroma of a light that alone reaches the shadows
};

// `typical`: green of most blocks; `global`: the table's colour at that level; `most`: brighter blocks, over
// typical, are no table.
Light lightOnTable(const std::vector<cv::Vec4f>& blocks, int rows, int columns, float typical,
                   const cv::Vec3f& global, float most, const ColourRounding& rounding) {
    // Against the whole table's white, then against that found near by, then with what only a second light
    // reaches.
    Light out{std::vector<cv::Vec3f>(blocks.size(), global), {}};
    auto& [near, second] = out;
    for (int pass = 0; pass < kPasses + 2; ++pass) {
        if (pass == kPasses) {
            second = findSecondLight(blocks, near, typical);
            if (!second) break;
        }
        cv::Mat white(rows, columns, CV_32FC4, cv::Scalar::all(0));
        int found = 0;
        for (size_t i = 0; i < blocks.size(); ++i) {
            const auto& p = blocks[i];
            if (p[3] == 0 || p[1] < 0.03f * typical || p[1] > most * typical) continue;
            const bool asNear =
                p[1] > 0.1f * typical && p[1] > 0.2f * near[i][1] && isWhite(p, near[i], rounding);
            const bool shaded = second && brightest(p, near[i]) < kShade &&
                                isMixture(chromaOf(p), chroma(near[i][0], near[i][1], near[i][2]), *second);
            if (!asNear && !shaded) continue;
            white.ptr<cv::Vec4f>()[i] = p;
            ++found;
        }
        if (found < 16) return {};
        // A narrow window follows the light; a wide one, with little weight, reaches where no white is near.
        const double sigma = pass == 0 ? 4 : 3;
        const cv::Mat sum = spread(white, sigma) + 0.02 * spread(white, 4 * sigma);
        for (size_t i = 0; i < blocks.size(); ++i) {
            const cv::Vec4f& s = sum.ptr<cv::Vec4f>()[i];
            for (int c = 0; c < 3; ++c) near[i][c] = s[3] > 1e-6f ? std::max(s[c] / s[3], 1e-5f) : global[c];
        }
    }
    return out;
}

} // namespace

bool WhiteMap::isMixture(glm::vec3 seen, size_t block) const {
    constexpr float kDark = 0.3f,
                    kBluer = 0.5f; // of the light on the table near by; of the way between the lights
    const glm::vec3& local = grid.light[block];
    const float bluer = lights->shareOfSecond(seen) - lights->shareOfSecond(local);
    // On a black table faces outshine what is about them: in the open, too, the lamp alone can meet them.
    if (open[block] && !(darkTable && bluer < 0)) return false;
    if (seen.g < kDark * local.g && bluer > kBluer) return false;
    const float dim = lights->typicalGreen() / std::max(seen.g, 1e-5f);
    return lights->isMixture(seen, static_cast<float>(noise) * std::sqrt(dim));
}

TableRegion findTable(const PlanView& view, double radiusInches, double overEdge) {
    auto disc = circle(view, radiusInches, 0);
    std::vector<cv::Point> all = disc, hull;
    for (const auto& p :
         circle(view, radiusInches + overEdge, geometry::heightInches(geometry::HeightClass::red)))
        all.push_back(p);
    cv::convexHull(all, hull);
    TableRegion region;
    const cv::Rect box = cv::boundingRect(hull) & cv::Rect(0, 0, view.photo().width, view.photo().height);
    if (box.width < 4 * kBlock || box.height < 4 * kBlock) return region;
    region.x0 = box.x, region.y0 = box.y, region.width = box.width, region.height = box.height;
    region.ground.assign(static_cast<size_t>(box.area()), Ground::outside);
    cv::Mat mask(box.size(), CV_8U, region.ground.data());
    for (auto* points : {&hull, &disc})
        for (auto& p : *points) p -= box.tl();
    cv::fillConvexPoly(mask, hull, cv::Scalar(static_cast<double>(Ground::besideTable)));
    cv::fillConvexPoly(mask, disc, cv::Scalar(static_cast<double>(Ground::table)));
    return region;
}

WhiteMap findWhite(const PlanView& view, const TableRegion& region, const std::optional<CardWhite>& known) {
    WhiteMap out;
    out.grid.x0 = region.x0, out.grid.y0 = region.y0, out.grid.square = kBlock;
    out.grid.columns = (region.width + kBlock - 1) / kBlock,
    out.grid.rows = (region.height + kBlock - 1) / kBlock;
    const std::vector<cv::Vec4f> blocks = blockMeans(view, region, out);
    std::vector<float> brightness, red, blue;
    for (const auto& p : blocks)
        if (p[3] > 0) brightness.push_back(p[1]);
    if (brightness.size() < 16) return out;
    const float typical = median(std::move(brightness));
    if (typical < 1e-4f) return out;
    for (const auto& p : blocks) {
        if (p[3] == 0 || p[1] < 0.3f * typical) continue;
        red.push_back(p[0] / p[1]), blue.push_back(p[2] / p[1]);
    }
    const cv::Vec3f global(typical * std::max(median(std::move(red)), 1e-3f), typical,
                           typical * std::max(median(std::move(blue)), 1e-3f));

    constexpr float kAny = 1e9f, kOfDark = 2.5f;       // times as bright as most of the table
    constexpr float kNoBrighter = 1.3f, kPale = 0.35f; // times as bright as the table near by; of P'
    const ColourRounding rounding(view);
    Light light;
    std::optional<CardWhite> card;
    const auto cardOf = [&](const LightGrid& grid) -> std::optional<CardWhite> {
        if (!known) return findCard(view, region, grid);
        return known->overTable == kWhiteTable.overTable ? std::nullopt : known;
    };
    // Card is held over the light that it was measured over: false, and the light before stays, where there
    // is none.
    const auto read = [&](float most, bool needsCard) {
        Light found = lightOnTable(blocks, out.grid.rows, out.grid.columns, typical, global, most, rounding);
        if (found.near.empty()) return false;
        LightGrid grid = out.grid;
        grid.light.clear();
        for (const auto& w : found.near) grid.light.emplace_back(w[0], w[1], w[2]);
        const std::optional<CardWhite> seen = cardOf(grid);
        if (needsCard && !seen) return false;
        light = std::move(found), out.grid = std::move(grid), card = seen;
        return true;
    };
    // The map before stays where that is false.
    const auto readMixture = [&](float most) {
        std::vector<LitBlock> lit;
        for (const auto& p : blocks)
            lit.push_back({{p[0], p[1], p[2]}, p[3] > 0 && p[1] <= most * typical, true});
        const glm::vec3 colour(global[0], global[1], global[2]);
        if (!TwoLights::find(lit, colour, 0)) return false;
        out.noise = relativeNoise(view, region);
        for (int j = 0, i = 0; j < out.grid.rows; ++j)
            for (int k = 0; k < out.grid.columns; ++k, ++i)
                if (LitBlock& block = lit[static_cast<size_t>(i)]; block.isTable)
                    block.isEven = isEven(view, region, k, j);
        const auto lights = TwoLights::find(lit, colour, static_cast<float>(out.noise) / kBlockSamples);
        if (!lights) return false;
        auto mixed = mixedLight(*lights, lit, out.grid.rows, out.grid.columns, typical,
                                view.pixelsPerInch({0, 0}, 0) / kBlock);
        if (!mixed) return false;
        out.lights = lights, out.full = std::move(mixed->full), out.open = std::move(mixed->open),
        out.grid.light = std::move(mixed->local);
        return true;
    };
    // Card no brighter than the table, in a mixture of the lights: the table is as white, in another one.
    const auto cardInMixture = [&]() -> std::optional<CardWhite> {
        LightGrid full = out.grid;
        full.light = out.full;
        const auto seen = cardOf(full);
        const glm::vec3 colour(global[0], global[1], global[2]);
        if (seen && !known && seen->overTable.g < kNoBrighter && saturationOf(seen->overTable) < kPale &&
            out.lights->isMixture(colour * seen->overTable))
            return std::nullopt;
        return seen;
    };
    if (readMixture(kAny)) {
        card = cardInMixture();
        if (card && isDark(*card) && readMixture(kOfDark)) {
            const auto again = cardInMixture();
            if (again) card = again;
        }
        if (card) {
            holdAgainstCard(out, *card);
            for (glm::vec3& all : out.full) all *= card->overTable;
        }
        return out;
    }
    if (!read(kAny, false)) return out;
    // Card in all its faces is of a black table's chroma, but is not table.
    if (card && isDark(*card)) read(kOfDark, true);
    if (card) holdAgainstCard(out, *card);
    if (light.second)
        out.secondLight = glm::vec3(std::exp((*light.second)[0]), 1, std::exp((*light.second)[1]));
    out.noise = relativeNoise(view, region);
    return out;
}

} // namespace heliodon::vision
