#include "vision/card_white.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "vision/light_samples.h"

namespace heliodon::vision {
namespace {

constexpr int kStride = 2; // pixels from sample to sample
constexpr float kOverTable = 1.05f, kClipped = 250;
constexpr float kCardChroma = 0.2f;   // log chroma from the table's: less is the white of a lamp near by
constexpr double kLeastCard = 0.4;    // square inches: the ends of two walls
constexpr double kShareOfMost = 0.25; // of what is commonest: rims and patches of light are rarer than card
constexpr double kFullLight = 0.9;    // of the levels: card that faces the lamps, of that which does not
constexpr float kPaint = 0.5f;        // P' against the table
constexpr double kNextTo = 1;         // inches: faces of high walls in part, ends and rings wholly
constexpr double kShareNextTo = 0.5;  // of card
constexpr double kLeastTop = 0.3;     // square inches
constexpr double kShareOfTops = 1 / 3.0; // arrows and skylights have none

// 1 within that many samples of what is not 0.
cv::Mat reach(const cv::Mat& mask, double samples) {
    cv::Mat distance;
    cv::distanceTransform(mask == 0, distance, cv::DIST_L2, 3);
    return distance <= samples;
}

class CardFinder {
public:
    CardFinder(const PlanView& view, const TableRegion& region, const LightGrid& table)
        : paint_(cv::Mat::zeros((region.height + kStride - 1) / kStride,
                                (region.width + kStride - 1) / kStride, CV_8U)),
          perInch_(view.pixelsPerInch({0, 0}, 0) / kStride), bins_(kBins * kBins) {
        takeSamples(view, region, table);
    }

    std::optional<glm::vec3> find() {
        if (samples_.empty()) return std::nullopt;
        sort();
        const std::optional<Cell> cell = brightest();
        if (!cell) return std::nullopt;
        std::array<std::vector<float>, 3> channel;
        cv::Mat card = cv::Mat::zeros(paint_.size(), CV_8U);
        for (const Sample& s : samples_) {
            if (std::abs(s.cell.i - cell->i) > 1 || std::abs(s.cell.j - cell->j) > 1) continue;
            for (int c = 0; c < 3; ++c) channel[static_cast<size_t>(c)].push_back(s.ratio[c]);
            card.at<uint8_t>(s.place) = 1;
        }
        const glm::vec3 white(median(channel[0]), median(channel[1]), median(channel[2]));
        const glm::vec2 c = chroma(white.r, white.g, white.b);
        const float off = std::max({std::abs(c[0]), std::abs(c[1]), std::abs(c[0] - c[1])});
        if (off < kCardChroma || !isOnTops(card)) return std::nullopt;
        return white;
    }

private:
    static constexpr int kBins = 60;
    static constexpr float kBin = 0.08f; // of log chroma

    struct Cell { // of the histogram of chroma
        int i, j;
    };
    struct Sample {
        glm::vec3 ratio; // to the table
        Cell cell;
        cv::Point place;
    };
    struct Bin {
        std::vector<float> levels; // of the dimmest channel
        size_t apart = 0;          // how many are not next to paint
    };

    static int binOf(float v) {
        return std::clamp(static_cast<int>(std::floor(v / kBin + 0.5f)) + kBins / 2, 1, kBins - 2);
    }

    // All that is brighter than the table, and where paint is.
    void takeSamples(const PlanView& view, const TableRegion& region, const LightGrid& table) {
        const Photograph& photo = view.photo();
        const auto& linear = view.linearFromByte();
        for (int y = 0; y < region.height; y += kStride)
            for (int x = 0; x < region.width; x += kStride) {
                const size_t at =
                    static_cast<size_t>(y) * static_cast<size_t>(region.width) + static_cast<size_t>(x);
                if (region.ground[at] != Ground::table) continue;
                const uint8_t* p =
                    &photo.rgb[3 * (static_cast<size_t>(y + region.y0) * static_cast<size_t>(photo.width) +
                                    static_cast<size_t>(x + region.x0))];
                const glm::vec3& bare =
                    table.light[static_cast<size_t>(y / kBlock) * static_cast<size_t>(table.columns) +
                                static_cast<size_t>(x / kBlock)];
                const glm::vec3 ratio = glm::vec3(linear[p[0]], linear[p[1]], linear[p[2]]) / bare;
                const cv::Point place(x / kStride, y / kStride);
                const float least = std::min({ratio.r, ratio.g, ratio.b});
                const float most = std::max({ratio.r, ratio.g, ratio.b});
                if (least < 1 && least < (1 - kPaint) * most) paint_.at<uint8_t>(place) = 1;
                if (least < kOverTable || std::max({p[0], p[1], p[2]}) > kClipped) continue;
                const glm::vec2 c = chroma(ratio.r, ratio.g, ratio.b);
                samples_.push_back({ratio, {binOf(c[0]), binOf(c[1])}, place});
            }
    }

    void sort() {
        const cv::Mat nextToPaint = reach(paint_, kNextTo * perInch_);
        for (const Sample& s : samples_) {
            Bin& bin = bins_[static_cast<size_t>(s.cell.i * kBins + s.cell.j)];
            bin.levels.push_back(std::min({s.ratio.r, s.ratio.g, s.ratio.b}));
            bin.apart += nextToPaint.at<uint8_t>(s.place) == 0;
        }
    }

    // The bin with those about it.
    template<class Take> void forBinsAbout(int i, int j, const Take& take) const {
        for (int d = 0; d < 9; ++d) take(bins_[static_cast<size_t>((i + d / 3 - 1) * kBins + j + d % 3 - 1)]);
    }

    size_t countAbout(int i, int j) const {
        size_t count = 0;
        forBinsAbout(i, j, [&](const Bin& bin) { count += bin.levels.size(); });
        return count;
    }

    // Of chromas that are common enough, and mostly next to paint.
    std::optional<Cell> brightest() const {
        size_t most = 0;
        for (int i = 1; i < kBins - 1; ++i)
            for (int j = 1; j < kBins - 1; ++j) most = std::max(most, countAbout(i, j));
        const double enough =
            std::max(kLeastCard * perInch_ * perInch_, kShareOfMost * static_cast<double>(most));
        float best = 0;
        std::optional<Cell> where;
        for (int i = 1; i < kBins - 1; ++i)
            for (int j = 1; j < kBins - 1; ++j) {
                const auto count = static_cast<double>(countAbout(i, j));
                size_t apart = 0;
                forBinsAbout(i, j, [&](const Bin& bin) { apart += bin.apart; });
                if (count < enough || static_cast<double>(apart) > (1 - kShareNextTo) * count) continue;
                std::vector<float> levels;
                forBinsAbout(i, j, [&](const Bin& bin) {
                    levels.insert(levels.end(), bin.levels.begin(), bin.levels.end());
                });
                const auto rank = levels.begin() + static_cast<std::ptrdiff_t>(kFullLight * (count - 1));
                std::nth_element(levels.begin(), rank, levels.end());
                if (*rank > best) best = *rank, where = {i, j};
            }
        return where;
    }

    // Whether card is next to many of the painted tops.
    bool isOnTops(const cv::Mat& card) const {
        cv::Mat labels, stats, centres;
        const int count = cv::connectedComponentsWithStats(paint_, labels, stats, centres);
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

    cv::Mat paint_; // 1 where a sample is painted
    double perInch_;
    std::vector<Sample> samples_;
    std::vector<Bin> bins_;
};

} // namespace

std::optional<glm::vec3> findCard(const PlanView& view, const TableRegion& region, const LightGrid& table) {
    return CardFinder(view, region, table).find();
}

} // namespace heliodon::vision
