#include "vision/card_white.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "vision/chroma.h"
#include "vision/median.h"

namespace heliodon::vision {
namespace {

// Samples an inch, where the picture has them: three or more across an end of a wall, however fine it is.
constexpr double kSamples = 13;
constexpr int kLeastStride = 2; // pixels from sample to sample
constexpr float kOverTable = 1.05f, kClipped = 250;
constexpr float kCardChroma = 0.2f;      // log chroma from the table's: less is the white of a lamp near by
constexpr double kLeastCard = 0.4;       // square inches: the ends of two walls
constexpr float kFullLight = 0.5f;       // of the level: card that faces the lamps, of that which does not
constexpr float kBrighter = 1.2f;        // than what is brightest in the table's own colour
constexpr float kPaint = 0.5f;           // P' against card
constexpr float kNotTable = 0.3f;        // P' against the table
constexpr double kNextTo = 1;            // inches: faces of high walls in part, ends and rings wholly
constexpr double kShareNextTo = 0.5;     // of card
constexpr double kLeastTop = 0.3;        // square inches
constexpr double kShareOfTops = 1 / 3.0; // arrows and skylights have none
constexpr size_t kMostTried = 8;

// 1 within that many samples of what is not 0.
cv::Mat reach(const cv::Mat& mask, double samples) {
    cv::Mat distance;
    cv::distanceTransform(mask == 0, distance, cv::DIST_L2, 3);
    return distance <= samples;
}

float least(glm::vec3 v) {
    return std::min({v.r, v.g, v.b});
}
float most(glm::vec3 v) {
    return std::max({v.r, v.g, v.b});
}

class CardFinder {
public:
    CardFinder(const PlanView& view, const TableRegion& region, const LightGrid& table)
        : view_(view), region_(region),
          stride_(std::max(kLeastStride, static_cast<int>(view.pixelsPerInch({0, 0}, 0) / kSamples))),
          size_((region.width + stride_ - 1) / stride_, (region.height + stride_ - 1) / stride_),
          perInch_(view.pixelsPerInch({0, 0}, 0) / stride_),
          enough_(static_cast<size_t>(std::ceil(kLeastCard * perInch_ * perInch_))), bins_(kBins * kBins) {
        takeSamples(view, region, table);
        constexpr double kBright = 0.9; // rank
        std::vector<float> green;
        for (int y = 0; y < region.height; y += kBlock)
            for (int x = 0; x < region.width; x += kBlock)
                if (region.isTable(x, y))
                    green.push_back(
                        table
                            .light[static_cast<size_t>(y / kBlock) * static_cast<size_t>(table.columns) +
                                   static_cast<size_t>(x / kBlock)]
                            .g);
        const auto place = static_cast<size_t>(kBright * static_cast<double>(green.size()));
        if (place < green.size()) brightTable_ = ranked(green, place);
    }

    std::optional<CardWhite> find() const {
        // What the table's own white reaches, at the ends of walls for one, is the measure for the others.
        std::optional<Card> best = cardOf(glm::vec3(1), [](Cell cell) { return isTable(cell); });
        for (const auto& [level, cell] : brightCells()) {
            const glm::vec3 colour = colourOf(cell);
            // All that has the cell's colour is no dimmer than what of it is next to paint.
            if (best && kInBin * meanOf({colour, {}, {}, level, false}) < meanOf(*best)) continue;
            const auto about = [&](Cell other) { return distance(cell, other) <= 1; };
            const std::optional<Card> card = cardOf(colour, about);
            if (!card || (best && meanOf(*card) < kBrighter * meanOf(*best)) || !card->isOnTops) continue;
            if (tableReturns(view_, region_, card->seen)) continue;
            return CardWhite{inTheSameLight(*card), card->light};
        }
        if (best && best->level > kDarkTable && best->isOnTops) return CardWhite{best->white, best->light};
        return std::nullopt;
    }

private:
    static constexpr int kBins = 60;
    static constexpr float kBin = 0.08f;  // of log chroma
    static constexpr float kInBin = 1.1f; // what a mean can differ by within bins side by side

    struct Cell { // of the histogram of chroma
        int i, j;
    };
    struct Sample {
        glm::vec3 ratio; // to the table
        glm::vec3 seen;  // as the picture has it
        Cell cell;
        cv::Point place;
        bool mayBeCard;
    };
    struct Card {
        glm::vec3 white;
        glm::vec2 light; // chroma
        glm::vec3 seen;  // as the picture has it
        float level;     // of the dimmest channel, which the least area of card exceeds
        bool isOnTops;
    };

    // The level as the mean of its channels, as it is where the table's colour darkens one of them most.
    static float meanOf(const Card& card) {
        return card.level * (card.white.r + card.white.g + card.white.b) / (3 * least(card.white));
    }

    // Walls stand higher than the table and throw shadows on it: their tops can be in light that the table
    // about them is shaded from. They are in no more than the table has where it is brightest. What is dark
    // stays so: of such a table's light much may be gloss.
    glm::vec3 inTheSameLight(const Card& card) const {
        constexpr float kLeast = 0.5f, kStillDark = 1.01f * kDarkTable;
        const float dimmest = least(card.white);
        if (!(brightTable_ > 0)) return card.white;
        float scale = std::max(card.seen.g / brightTable_ / card.white.g, kLeast);
        if (dimmest > kDarkTable) scale = std::max(scale, kStillDark / dimmest);
        return std::min(scale, 1.0f) * card.white;
    }

    static int binOf(float v) {
        return std::clamp(static_cast<int>(std::floor(v / kBin + 0.5f)) + kBins / 2, 1, kBins - 2);
    }
    static int distance(Cell a, Cell b) { return std::max(std::abs(a.i - b.i), std::abs(a.j - b.j)); }
    static glm::vec3 colourOf(Cell cell) {
        return {std::exp(kBin * static_cast<float>(cell.i - kBins / 2)), 1,
                std::exp(kBin * static_cast<float>(cell.j - kBins / 2))};
    }
    static bool isTable(Cell cell) {
        const int i = cell.i - kBins / 2, j = cell.j - kBins / 2;
        return static_cast<float>(std::max({std::abs(i), std::abs(j), std::abs(i - j)})) * kBin < kCardChroma;
    }

    void takeSamples(const PlanView& view, const TableRegion& region, const LightGrid& table) {
        const Photograph& photo = view.photo();
        const auto& linear = view.linearFromByte();
        for (int y = 0; y < region.height; y += stride_)
            for (int x = 0; x < region.width; x += stride_) {
                const size_t at =
                    static_cast<size_t>(y) * static_cast<size_t>(region.width) + static_cast<size_t>(x);
                if (region.ground[at] != Ground::table) continue;
                const uint8_t* p =
                    &photo.rgb[3 * (static_cast<size_t>(y + region.y0) * static_cast<size_t>(photo.width) +
                                    static_cast<size_t>(x + region.x0))];
                const glm::vec3& bare =
                    table.light[static_cast<size_t>(y / kBlock) * static_cast<size_t>(table.columns) +
                                static_cast<size_t>(x / kBlock)];
                const glm::vec3 light(linear[p[0]], linear[p[1]], linear[p[2]]), ratio = light / bare;
                const bool overexposed =
                    std::max({p[0], p[1], p[2]}) > kClipped; // its colour is lost, but not that it is white
                const bool mayBeCard =
                    overexposed ? std::min({p[0], p[1], p[2]}) > kClipped && least(ratio) > kDarkTable
                                : least(ratio) >= kOverTable;
                if (!mayBeCard && least(ratio) > (1 - kNotTable) * most(ratio)) continue; // of no use
                const glm::vec2 c = chroma(ratio.r, ratio.g, ratio.b);
                const Cell cell{binOf(c[0]), binOf(c[1])};
                samples_.push_back({ratio, light, cell, {x / stride_, y / stride_}, mayBeCard});
                if (mayBeCard) bins_[static_cast<size_t>(cell.i * kBins + cell.j)].push_back(least(ratio));
            }
    }

    // Levels of the bin with those about it.
    std::vector<float> levelsAbout(Cell cell) const {
        std::vector<float> levels;
        for (int d = 0; d < 9; ++d) {
            const auto& bin = bins_[static_cast<size_t>((cell.i + d / 3 - 1) * kBins + cell.j + d % 3 - 1)];
            levels.insert(levels.end(), bin.begin(), bin.end());
        }
        return levels;
    }

    // The level that the least area of card exceeds.
    float levelOf(std::vector<float>& levels) const { return ranked(levels, levels.size() - enough_); }

    // Chromas other than the table's that are common enough, with their levels, the brightest first, none
    // beside another.
    std::vector<std::pair<float, Cell>> brightCells() const {
        std::vector<std::pair<float, Cell>> cells;
        for (int i = 1; i < kBins - 1; ++i)
            for (int j = 1; j < kBins - 1; ++j) {
                if (isTable({i, j})) continue;
                std::vector<float> levels = levelsAbout({i, j});
                if (levels.size() >= enough_) cells.push_back({levelOf(levels), {i, j}});
            }
        std::stable_sort(cells.begin(), cells.end(),
                         [](const auto& a, const auto& b) { return a.first > b.first; });
        std::vector<std::pair<float, Cell>> out;
        for (const auto& candidate : cells) {
            if (out.size() == kMostTried) break;
            if (std::none_of(out.begin(), out.end(), [&](const auto& other) {
                    return distance(candidate.second, other.second) <= 1;
                }))
                out.push_back(candidate);
        }
        return out;
    }

    // What is card if card has that colour over the table's: samples of its chroma next to paint, which has
    // neither card's chroma nor the table's. None where there is too little, or more of it elsewhere.
    template<class Has> std::optional<Card> cardOf(glm::vec3 colour, const Has& has) const {
        cv::Mat paint = cv::Mat::zeros(size_, CV_8U);
        for (const Sample& s : samples_) {
            const glm::vec3 c = s.ratio / colour;
            if (least(c) < (1 - kPaint) * most(c) && least(s.ratio) < (1 - kNotTable) * most(s.ratio))
                paint.at<uint8_t>(s.place) = 1;
        }
        const cv::Mat nextToPaint = reach(paint, kNextTo * perInch_);
        std::vector<float> levels;
        size_t apart = 0;
        for (const Sample& s : samples_) {
            if (!s.mayBeCard || !has(s.cell)) continue;
            if (nextToPaint.at<uint8_t>(s.place))
                levels.push_back(least(s.ratio));
            else
                ++apart;
        }
        if (levels.size() < enough_) return std::nullopt;
        const bool ofTable = colour == glm::vec3(1);
        if (!ofTable &&
            static_cast<double>(levels.size()) < kShareNextTo * static_cast<double>(levels.size() + apart))
            return std::nullopt;
        Card out{{}, {}, {}, levelOf(levels), false};
        std::array<std::vector<float>, 3> channel, seen;
        std::array<std::vector<float>, 2> light;
        cv::Mat card = cv::Mat::zeros(size_, CV_8U);
        for (const Sample& s : samples_) {
            if (!s.mayBeCard || !has(s.cell) || !nextToPaint.at<uint8_t>(s.place)) continue;
            card.at<uint8_t>(s.place) = 1;
            if (least(s.ratio) < kFullLight * out.level) continue;
            const glm::vec2 of = chroma(s.seen.r, s.seen.g, s.seen.b);
            for (int c = 0; c < 3; ++c) channel[static_cast<size_t>(c)].push_back(s.ratio[c]);
            for (int c = 0; c < 3; ++c) seen[static_cast<size_t>(c)].push_back(s.seen[c]);
            for (int c = 0; c < 2; ++c) light[static_cast<size_t>(c)].push_back(of[c]);
        }
        out.light = {median(std::move(light[0])), median(std::move(light[1]))};
        out.white = {median(std::move(channel[0])), median(std::move(channel[1])),
                     median(std::move(channel[2]))};
        out.seen = {median(std::move(seen[0])), median(std::move(seen[1])), median(std::move(seen[2]))};
        out.isOnTops = isOnTops(paint, card);
        return out;
    }

    // Whether card is next to many of the painted tops.
    bool isOnTops(const cv::Mat& paint, const cv::Mat& card) const {
        cv::Mat labels, stats, centres;
        const int count = cv::connectedComponentsWithStats(paint, labels, stats, centres);
        std::vector<uint8_t> has(static_cast<size_t>(count), 0);
        const cv::Mat near = reach(card, kNextTo * perInch_);
        for (int y = 0; y < labels.rows; ++y)
            for (int x = 0; x < labels.cols; ++x)
                if (near.at<uint8_t>(y, x)) has[static_cast<size_t>(labels.at<int>(y, x))] = 1;
        int tops = 0, withCard = 0;
        for (int k = 1; k < count; ++k) { // 0: what is not painted
            if (stats.at<int>(k, cv::CC_STAT_AREA) < kLeastTop * perInch_ * perInch_) continue;
            ++tops;
            withCard += has[static_cast<size_t>(k)];
        }
        return withCard > 0 && withCard >= kShareOfTops * tops;
    }

    const PlanView& view_;
    const TableRegion& region_;
    int stride_; // pixels from sample to sample
    cv::Size size_;
    double perInch_;
    size_t enough_;
    float brightTable_ = 0;       // green of the light that the table returns where it is bright
    std::vector<Sample> samples_; // all that may be card or paint
    std::vector<std::vector<float>> bins_;
};

} // namespace

bool tableReturns(const PlanView& view, const TableRegion& region, glm::vec3 light) {
    constexpr int kStep = 5;                       // pixels
    constexpr double kShare = 0.2;                 // of the table
    constexpr float kNearly = 0.7f, kSame = 0.12f; // of the light; of log chroma
    const Photograph& photo = view.photo();
    const auto& linear = view.linearFromByte();
    const glm::vec2 colour = chroma(light.r, light.g, light.b);
    size_t all = 0, alike = 0;
    for (int y = 0; y < region.height; y += kStep)
        for (int x = 0; x < region.width; x += kStep) {
            if (!region.isTable(x, y)) continue;
            const uint8_t* p =
                &photo.rgb[3 * (static_cast<size_t>(y + region.y0) * static_cast<size_t>(photo.width) +
                                static_cast<size_t>(x + region.x0))];
            const glm::vec3 here(linear[p[0]], linear[p[1]], linear[p[2]]);
            ++all;
            alike += least(here / light) > kNearly &&
                     glm::distance(chroma(here.r, here.g, here.b), colour) < kSame;
        }
    return static_cast<double>(alike) > kShare * static_cast<double>(all);
}

std::optional<CardWhite> findCard(const PlanView& view, const TableRegion& region, const LightGrid& table) {
    return CardFinder(view, region, table).find();
}

} // namespace heliodon::vision
