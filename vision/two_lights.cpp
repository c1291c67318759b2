#include "vision/two_lights.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "vision/median.h"
#include "vision/two_means.h"

namespace heliodon::vision {
namespace {

constexpr float kDim = 0.03f;   // of the typical green: below it colours are noise
constexpr float kAside = 0.02f; // of chromaticity, white a third: as far from the line as mixtures are seen
constexpr float kPast = 0.02f;  // the same past its ends
constexpr double kLargestCard = 3.5; // inches: skylights

float rank(std::vector<float>& values, double share) {
    return ranked(values, static_cast<size_t>(share * static_cast<double>(values.size() - 1)));
}

} // namespace

glm::vec2 TwoLights::chromaticity(glm::vec3 light) const {
    light /= typical_;
    const float sum = light.r + light.g + light.b;
    return sum > 0 ? glm::vec2(light.r, light.b) / sum : glm::vec2(0);
}

std::optional<TwoLights> TwoLights::find(const std::vector<LitBlock>& blocks, glm::vec3 typical,
                                         float noise) {
    constexpr float kVivid = 0.25f;       // from the middle: paint
    constexpr double kShareOfLine = 0.85; // of the blocks
    constexpr double kAlone = 0.02;       // of them on either side
    constexpr float kApart = 0.035f;      // of chromaticity, from the middle to either side
    constexpr float kOfNoise = 1.6f;      // four deviations of chromaticity
    TwoLights out;
    out.typical_ = typical;
    std::vector<glm::vec2> points;
    for (const LitBlock& block : blocks) {
        if (!block.isTable || !block.isEven || block.light.g < kDim * typical.g) continue;
        const glm::vec2 c = out.chromaticity(block.light);
        if (glm::distance(c, glm::vec2(1 / 3.0f)) < kVivid) points.push_back(c);
    }
    if (points.size() < 64) return std::nullopt;
    std::vector<float> x, y;
    for (const glm::vec2 c : points) x.push_back(c.x), y.push_back(c.y);
    out.middle_ = {rank(x, 0.5), rank(y, 0.5)};
    // The line through most of them: each counts the less the farther it lies beside it.
    out.along_ = glm::normalize(glm::vec2(-1, 1));
    for (int pass = 0; pass < 8; ++pass) {
        const glm::vec2 across(-out.along_.y, out.along_.x);
        const auto weight = [&](glm::vec2 c) {
            const float aside = glm::dot(c - out.middle_, across) / kAside;
            return 1 / (1 + aside * aside * aside * aside);
        };
        float sum = 0, xx = 0, xy = 0, yy = 0;
        glm::vec2 mean(0);
        for (const glm::vec2 c : points) mean += weight(c) * c, sum += weight(c);
        mean *= 1 / sum;
        for (const glm::vec2 c : points) {
            const float w = weight(c);
            const glm::vec2 d = c - mean;
            xx += w * d.x * d.x, xy += w * d.x * d.y, yy += w * d.y * d.y;
        }
        const float angle = 0.5f * std::atan2(2 * xy, xx - yy);
        out.along_ = {std::cos(angle), std::sin(angle)};
        if (out.along_.y < out.along_.x) out.along_ *= -1; // the second light is the bluer one
        out.middle_ += glm::dot(mean - out.middle_, glm::vec2(-out.along_.y, out.along_.x)) *
                       glm::vec2(-out.along_.y, out.along_.x);
    }
    const glm::vec2 across(-out.along_.y, out.along_.x);
    std::vector<float> places;
    for (const glm::vec2 c : points)
        if (std::abs(glm::dot(c - out.middle_, across)) < kAside)
            places.push_back(glm::dot(c - out.middle_, out.along_));
    if (static_cast<double>(places.size()) < kShareOfLine * static_cast<double>(points.size()))
        return std::nullopt;
    const float apart = std::max(kApart, kOfNoise * noise);
    if (rank(places, kAlone) > -apart || rank(places, 1 - kAlone) < apart) return std::nullopt;
    constexpr double kFew = 0.005;
    out.begin_ = rank(places, kFew), out.end_ = rank(places, 1 - kFew);
    const auto colour = [&](float at) {
        const glm::vec2 c = out.middle_ + at * out.along_;
        const glm::vec3 light = typical * glm::vec3(c.x, 1 - c.x - c.y, c.y);
        return light / light.g;
    };
    out.first_ = colour(out.begin_), out.second_ = colour(out.end_);
    return out;
}

float TwoLights::shareOfSecond(glm::vec3 light) const {
    return (glm::dot(chromaticity(light) - middle_, along_) - begin_) / (end_ - begin_);
}

bool TwoLights::isMixture(glm::vec3 light, float noise) const {
    constexpr float kOfNoise = 0.6f,
                    kPastNoise = 0.2f; // of chromaticity; blue paint lies beyond the bluer light
    const glm::vec2 c = chromaticity(light) - middle_;
    const float at = glm::dot(c, along_);
    return std::abs(c.y * along_.x - c.x * along_.y) < std::max(kAside, kOfNoise * noise) &&
           at > begin_ - std::max(kPast, kPastNoise * noise) &&
           at < end_ + std::max(kPast, kPastNoise * noise);
}

glm::vec2 TwoLights::amounts(glm::vec3 light) const {
    const glm::vec3 a = first_ / typical_, b = second_ / typical_, p = light / typical_;
    const float aa = glm::dot(a, a), ab = glm::dot(a, b), bb = glm::dot(b, b), ap = glm::dot(a, p),
                bp = glm::dot(b, p);
    const float det = aa * bb - ab * ab;
    const glm::vec2 both((ap * bb - bp * ab) / det, (bp * aa - ap * ab) / det);
    if (both.x < 0) return {0, std::max(bp / bb, 0.0f)};
    if (both.y < 0) return {std::max(ap / aa, 0.0f), 0};
    return both;
}

namespace {

// Of each light what falls where nothing keeps it off: the logarithm is quadratic in the place, as it nearly
// is of lamps that are not much nearer than the table is wide; what is darker than that is in a shadow.
cv::Mat unshaded(const cv::Mat& white) {
    constexpr int kTerms = 6, kPasses = 12;
    constexpr double kShadow = 0.1, kTooBright = 0.3; // of the logarithm, below and over
    constexpr float kLeast = 0.05f;                   // of the light that is brightest
    const auto termsAt = [&](int row, int column) {
        const double y = 2.0 * row / white.rows - 1, x = 2.0 * column / white.cols - 1;
        return cv::Matx<double, kTerms, 1>(1, x, y, x * x, x * y, y * y);
    };
    cv::Mat out(white.size(), CV_32FC2);
    for (int light = 0; light < 2; ++light) {
        std::vector<std::pair<cv::Matx<double, kTerms, 1>, double>> points;
        std::vector<float> amounts;
        for (const cv::Vec3f& v : cv::Mat_<cv::Vec3f>(white))
            if (v[2] > 0) amounts.push_back(v[light]);
        const float brightest = rank(amounts, 0.99), least = kLeast * brightest;
        for (int j = 0; j < white.rows; ++j)
            for (int i = 0; i < white.cols; ++i)
                if (const cv::Vec3f& v = white.at<cv::Vec3f>(j, i); v[2] > 0 && v[light] > least)
                    points.push_back({termsAt(j, i), std::log(static_cast<double>(v[light]))});
        cv::Matx<double, kTerms, 1> fit = fit.zeros();
        for (int pass = 0; pass < kPasses; ++pass) {
            cv::Matx<double, kTerms, kTerms> normal = 1e-6 * normal.eye();
            cv::Matx<double, kTerms, 1> side = side.zeros();
            for (const auto& [terms, value] : points) {
                const double over = value - terms.dot(fit);
                if (pass > 0 && (over > kTooBright || over < (pass < kPasses / 2 ? -2 : -1) * kShadow))
                    continue;
                normal += terms * terms.t();
                side += value * terms;
            }
            fit = normal.solve(side, cv::DECOMP_CHOLESKY);
        }
        for (int j = 0; j < white.rows; ++j)
            for (int i = 0; i < white.cols; ++i)
                out.at<cv::Vec2f>(j, i)[light] =
                    std::min(brightest, static_cast<float>(std::exp(termsAt(j, i).dot(fit))));
    }
    return out;
}

} // namespace

std::optional<MixedLight> mixedLight(const TwoLights& lights, const std::vector<LitBlock>& blocks, int rows,
                                     int columns, float typicalGreen, double blocksPerInch) {
    constexpr float kLit = 0.75f, kMostly = 0.7f; // of the unshaded light; of the table near by
    const auto blocksOf = [&](double inches, int least) {
        return std::max(least, static_cast<int>(std::lround(inches * blocksPerInch)));
    };
    const auto blurred = [](const cv::Mat& from, int reach) { return twoMeans(from, 2 * reach + 1); };
    cv::Mat white(rows, columns, CV_32FC3, cv::Scalar::all(0)); // amounts of both, weight
    for (size_t i = 0; i < blocks.size(); ++i) {
        const LitBlock& block = blocks[i];
        if (!block.isTable || !block.isEven || block.light.g < kDim * typicalGreen ||
            !lights.isMixture(block.light))
            continue;
        const glm::vec2 both = lights.amounts(block.light);
        white.ptr<cv::Vec3f>()[i] = {both.x, both.y, 1};
    }
    // Means of few blocks are less noisy than what the largest of them would be.
    cv::Mat soft = blurred(white, 1);
    soft.forEach<cv::Vec3f>([&](cv::Vec3f& v, const int* at) {
        v = white.at<cv::Vec3f>(at)[2] > 0 ? cv::Vec3f(v[0] / v[2], v[1] / v[2], 1) : cv::Vec3f(0, 0, 0);
    });
    const cv::Mat full = unshaded(soft);
    // Where shadows are about, what is small may be one; elsewhere it is a card.
    cv::Mat mask(rows, columns, CV_8U), labels, stats, centres;
    for (size_t i = 0; i < blocks.size(); ++i) mask.data[i] = white.ptr<cv::Vec3f>()[i][2] > 0;
    cv::connectedComponentsWithStats(mask, labels, stats, centres, 4);
    const double largest = kLargestCard * kLargestCard * blocksPerInch * blocksPerInch;
    const auto isSmall = [&](size_t i) {
        return stats.at<int>(labels.ptr<int>()[i], cv::CC_STAT_AREA) < largest;
    };
    cv::Mat lit(rows, columns, CV_32FC2, cv::Scalar::all(0)); // in both lights, at all
    for (size_t i = 0; i < blocks.size(); ++i) {
        if (!mask.data[i] || isSmall(i)) continue;
        const cv::Vec3f& s = soft.ptr<cv::Vec3f>()[i];
        const cv::Vec2f& f = full.ptr<cv::Vec2f>()[i];
        const bool isLit = s[0] > kLit * f[0] && s[1] > kLit * f[1];
        lit.ptr<cv::Vec2f>()[i] = {isLit ? 1.0f : 0.0f, 1};
    }
    const int about = blocksOf(2, 3);
    cv::blur(lit, lit, {2 * about + 1, 2 * about + 1}, {-1, -1}, cv::BORDER_CONSTANT);
    const auto isOpen = [&](size_t i) {
        const cv::Vec2f& l = lit.ptr<cv::Vec2f>()[i];
        return l[1] > 1e-6f && l[0] > kMostly * l[1];
    };
    size_t found = 0;
    for (size_t i = 0; i < blocks.size(); ++i) {
        if (!mask.data[i]) continue;
        if (isSmall(i) && isOpen(i))
            white.ptr<cv::Vec3f>()[i] = {0, 0, 0};
        else
            ++found;
    }
    if (found < 64) return std::nullopt;
    MixedLight out;
    const int wide = blocksOf(0.6, 2);
    const cv::Mat sum = blurred(white, 1) + 0.01 * blurred(white, wide) + 1e-4 * blurred(white, 6 * wide);
    for (size_t i = 0; i < blocks.size(); ++i) {
        const auto lightOf = [&](const cv::Vec3f& s) {
            return glm::max(lights.mix(glm::vec2(s[0], s[1]) / s[2]), glm::vec3(1e-5f));
        };
        const cv::Vec3f& s = sum.ptr<cv::Vec3f>()[i];
        const cv::Vec2f& f = full.ptr<cv::Vec2f>()[i];
        out.local.push_back(s[2] > 1e-9f ? lightOf(s) : lights.mix(glm::vec2(typicalGreen / 2)));
        out.full.push_back(glm::max(lights.mix({f[0], f[1]}), glm::vec3(1e-5f)));
        out.open.push_back(isOpen(i));
    }
    return out;
}

} // namespace heliodon::vision
