#include "engine/app/overlay_tags.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>

#include <glm/geometric.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/passes/image_file.h"
#include "engine/passes/lettering.h"

namespace heliodon::app {

namespace {

using vision::OverlayTag;

constexpr int kClear = 4; // pixels between an outline and a tag

std::vector<cv::Point> pointsOf(const OverlayTag& tag) {
    std::vector<cv::Point> points;
    for (const glm::dvec2& p : tag.outlinePx)
        points.emplace_back(static_cast<int>(std::lround(std::clamp(p.x, -1e4, 1e4))),
                            static_cast<int>(std::lround(std::clamp(p.y, -1e4, 1e4))));
    return points;
}

// Where a tag starts from: the outline's middle, or for an arc the point of it that is nearest to that.
glm::dvec2 anchorOf(const OverlayTag& tag) {
    glm::dvec2 middle{};
    std::vector<cv::Point2f> points;
    for (const glm::dvec2& p : tag.outlinePx) {
        middle += p / static_cast<double>(tag.outlinePx.size());
        points.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y));
    }
    const cv::Point2f at(static_cast<float>(middle.x), static_cast<float>(middle.y));
    if (cv::pointPolygonTest(points, at, false) >= 0) return middle;
    return *std::ranges::min_element(tag.outlinePx, {},
                                     [&](const glm::dvec2& p) { return glm::length(p - middle); });
}

// What is taken, as sums over all pixels above and left.
class Taken {
public:
    Taken(int width, int height, std::span<const OverlayTag> tags) {
        cv::Mat mask(height, width, CV_8UC1, cv::Scalar(0));
        for (const OverlayTag& tag : tags) {
            const std::vector<cv::Point> points = pointsOf(tag);
            cv::fillPoly(mask, std::vector{points}, cv::Scalar(1));
            cv::polylines(mask, points, true, cv::Scalar(1), 2 * kClear);
        }
        cv::integral(mask, sums_, CV_32S);
    }

    // Pixels of the box; infinite where it leaves the picture.
    double under(const Box& box) const {
        const int x0 = static_cast<int>(std::floor(box.low.x)), y0 = static_cast<int>(std::floor(box.low.y)),
                  x1 = static_cast<int>(std::ceil(box.high.x)), y1 = static_cast<int>(std::ceil(box.high.y));
        if (x0 < 0 || y0 < 0 || x1 >= sums_.cols || y1 >= sums_.rows)
            return std::numeric_limits<double>::infinity();
        return sums_.at<int>(y1, x1) - sums_.at<int>(y0, x1) - sums_.at<int>(y1, x0) + sums_.at<int>(y0, x0);
    }

private:
    cv::Mat sums_;
};

double common(const Box& a, const Box& b) {
    const glm::dvec2 overlap = glm::min(a.high, b.high) - glm::max(a.low, b.low);
    return std::max(0.0, overlap.x) * std::max(0.0, overlap.y);
}

Box boxAt(glm::dvec2 middle, glm::dvec2 size) {
    return {middle - 0.5 * size, middle + 0.5 * size};
}

Box placeTag(const OverlayTag& tag, glm::dvec2 size, glm::dvec2 pictureMiddle, const Taken& taken,
             std::span<const Box> placed) {
    constexpr int kDirections = 24;
    constexpr double kStep = 3, kFarthest = 200, kCovered = 1e3; // pixels; of cost, a covered pixel
    const glm::dvec2 anchor = anchorOf(tag);
    const glm::dvec2 outward = (anchor - pictureMiddle) / std::max(1.0, glm::length(anchor - pictureMiddle));
    const double side = tag.side == OverlayTag::Side::outer   ? 1
                        : tag.side == OverlayTag::Side::inner ? -1
                                                              : 0;
    constexpr double kWrongSide = 30; // pixels that it may be further away on the right side
    Box best = boxAt(anchor, size);
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < kDirections; ++k) {
        const double angle = 2 * std::numbers::pi * k / kDirections;
        const glm::dvec2 direction(std::cos(angle), std::sin(angle));
        const double against = side == 0 ? 0 : kWrongSide * (1 - side * glm::dot(direction, outward));
        for (double away = 0; away < kFarthest; away += kStep) {
            const Box box = boxAt(anchor + away * direction, size);
            double covered = taken.under(box);
            for (const Box& other : placed) covered += common(box, other);
            const double cost = away + against + kCovered * covered;
            if (cost >= least) continue;
            least = cost;
            best = box;
        }
    }
    return best;
}

} // namespace

std::vector<Box> placeTags(int width, int height, std::span<const OverlayTag> tags,
                           std::span<const glm::dvec2> sizes) {
    const Taken taken(width, height, tags);
    std::vector<size_t> order(tags.size()); // wide ones first: they fit in fewer places
    std::iota(order.begin(), order.end(), size_t{0});
    std::ranges::stable_sort(order, std::ranges::greater{}, [&](size_t i) { return sizes[i].x; });
    std::vector<Box> placed, boxes(tags.size());
    for (const size_t i : order) {
        placed.push_back(placeTag(tags[i], sizes[i], 0.5 * glm::dvec2(width, height), taken, placed));
        boxes[i] = placed.back();
    }
    return boxes;
}

void writeOverlay(const vision::Photograph& photo, const geometry::Rig& rig, const geometry::Sketch& sketch,
                  const std::filesystem::path& png, std::span<const std::array<glm::dvec3, 3>> dark) {
    vision::Overlay overlay = vision::drawOverlay(photo, rig, sketch, dark);
    passes::Image8 picture{overlay.picture.width, overlay.picture.height, std::move(overlay.picture.rgb)};
    const double capital = std::max(8.0, picture.height / 100.0), margin = 0.5 * capital;
    std::vector<glm::dvec2> sizes;
    for (const OverlayTag& tag : overlay.tags) {
        const double swatch = tag.paint ? capital + margin : 0;
        sizes.emplace_back(passes::Lettering{capital}.width(tag.words) + swatch + 2 * margin,
                           capital + 2 * margin);
    }
    const std::vector<Box> boxes = placeTags(picture.width, picture.height, overlay.tags, sizes);
    cv::Mat pixels(picture.height, picture.width, CV_8UC3, picture.rgb.data());
    for (size_t i = 0; i < boxes.size(); ++i) {
        const OverlayTag& tag = overlay.tags[i];
        const cv::Rect plate = cv::Rect(cv::Point(static_cast<int>(std::lround(boxes[i].low.x)),
                                                  static_cast<int>(std::lround(boxes[i].low.y))),
                                        cv::Point(static_cast<int>(std::lround(boxes[i].high.x)),
                                                  static_cast<int>(std::lround(boxes[i].high.y)))) &
                               cv::Rect(0, 0, picture.width, picture.height);
        if (plate.empty()) continue;
        pixels(plate) = 0.3 * pixels(plate);
        double x = boxes[i].low.x + margin;
        const double middle = 0.5 * (boxes[i].low.y + boxes[i].high.y);
        if (tag.paint) {
            const cv::Rect swatch(static_cast<int>(x), static_cast<int>(middle - 0.5 * capital),
                                  static_cast<int>(capital), static_cast<int>(capital));
            const auto& [r, g, b] = *tag.paint;
            cv::rectangle(pixels, swatch, cv::Scalar(r, g, b), cv::FILLED);
            cv::rectangle(pixels, swatch, cv::Scalar(255, 255, 255), 1);
            x += capital + margin;
        }
        passes::Lettering{capital, tag.ink}.draw(picture, x, middle + 0.5 * capital, tag.words);
    }
    passes::writePng(picture, png);
}

} // namespace heliodon::app
