#include "engine/app/overlay_tags.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <glm/geometric.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/passes/image_file.h"
#include "engine/passes/label_places.h"
#include "engine/passes/lettering.h"

namespace heliodon::app {

namespace {

using vision::OverlayTag;

constexpr double kClear = 4, kRightSide = 30; // pixels: between an outline and a tag, for the right side

glm::dvec2 middleOf(const std::vector<glm::dvec2>& outline) {
    return std::accumulate(outline.begin(), outline.end(), glm::dvec2(0)) /
           static_cast<double>(outline.size());
}

// Where a tag should be seen from its outline, as Label::towards.
glm::dvec2 towards(const OverlayTag& tag, glm::dvec2 pictureMiddle) {
    if (tag.side == OverlayTag::Side::any) return {0, 0};
    const glm::dvec2 outward = middleOf(tag.outlinePx) - pictureMiddle;
    const double sign = tag.side == OverlayTag::Side::outer ? 1 : -1;
    return sign * kRightSide * outward / std::max(1.0, glm::length(outward));
}

} // namespace

void writeOverlay(const vision::Photograph& photo, const geometry::Rig& rig, const geometry::Sketch& sketch,
                  const std::filesystem::path& png, std::span<const std::array<glm::dvec3, 3>> dark) {
    vision::Overlay overlay = vision::drawOverlay(photo, rig, sketch, dark);
    passes::Image8 picture{overlay.picture.width, overlay.picture.height, std::move(overlay.picture.rgb)};
    const double capital = std::max(8.0, picture.height / 100.0), margin = 0.5 * capital;
    const glm::dvec2 size(picture.width, picture.height);
    std::vector<passes::Label> labels;
    for (const OverlayTag& tag : overlay.tags) {
        const double swatch = tag.paint ? capital + margin : 0;
        labels.push_back(
            {tag.outlinePx,
             {passes::Lettering{capital}.width(tag.words) + swatch + 2 * margin, capital + 2 * margin},
             towards(tag, 0.5 * size)});
    }
    const std::vector<passes::Box> boxes = passes::placeLabels(labels, {{0, 0}, size}, kClear);
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
