#include "engine/app/chart.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "engine/passes/false_colour.h"
#include "engine/passes/image_file.h"
#include "engine/passes/lettering.h"
#include "geometry/input_error.h"
#include "geometry/whole_file.h"

namespace heliodon::app {

namespace {

constexpr double kPngScale = 2;
constexpr int kShift = 4; // fractional bits of OpenCV's polygon corners

std::string hex(Ink ink) {
    return fmt::format("#{:02x}{:02x}{:02x}", ink[0], ink[1], ink[2]);
}

} // namespace

std::string escaped(const std::string& words) {
    std::string result;
    for (char letter : words)
        result += letter == '&' ? "&amp;" : letter == '<' ? "&lt;" : std::string(1, letter);
    return result;
}

void Chart::fill(std::vector<glm::dvec2> outline, Ink ink) {
    items_.push_back({Item::Kind::fill, {std::move(outline)}, ink, 0.3, {}, Anchor::start, false});
}

void Chart::fill(std::vector<std::vector<glm::dvec2>> outlines, Ink ink) {
    items_.push_back({Item::Kind::fill, std::move(outlines), ink, 1, {}, Anchor::start, false});
}

void Chart::rectangle(double x, double y, double width, double height, Ink ink) {
    fill({{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}}, ink);
}

void Chart::line(std::vector<glm::dvec2> points, Ink ink, double thickness) {
    items_.push_back({Item::Kind::line, {std::move(points)}, ink, thickness, {}, Anchor::start, false});
}

void Chart::text(glm::dvec2 at, const std::string& words, double size, Anchor anchor, Ink ink, bool halo) {
    items_.push_back({Item::Kind::text, {{at}}, ink, size, words, anchor, halo});
}

void refuseNoDrawing(const std::filesystem::path& file) {
    if (!file.empty() && file.extension() != ".svg" && file.extension() != ".png")
        throw geometry::InputError(file.string(), "", "is no kind of drawing, expected .png or .svg");
}

void Chart::write(const std::filesystem::path& file) const {
    refuseNoDrawing(file);
    if (file.extension() == ".svg")
        geometry::writeWholeText(file, svg());
    else
        writePng(file);
}

std::string Chart::svg() const {
    std::string text =
        fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" "
                    "viewBox=\"0 0 {0:g} {1:g}\" font-family=\"sans-serif\">\n"
                    "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
                    width_, height_);
    for (const Item& item : items_) {
        std::string path;
        for (const auto& outline : item.outlines) {
            for (size_t k = 0; k < outline.size(); ++k)
                path += fmt::format("{}{:.2f} {:.2f}", k ? 'L' : 'M', outline[k].x, outline[k].y);
            if (item.kind == Item::Kind::fill) path += 'Z';
        }
        const std::string title =
            item.title.empty() ? "" : fmt::format("<title>{}</title>", escaped(item.title));
        switch (item.kind) {
        case Item::Kind::fill: // a hairline of its own colour closes the seams between neighbours
            text += fmt::format("<path d=\"{0}\" fill=\"{1}\" fill-rule=\"evenodd\" stroke=\"{1}\" "
                                "stroke-width=\"{2:g}\">{3}</path>\n",
                                path, hex(item.ink), item.size, title);
            break;
        case Item::Kind::line:
            text += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:g}\" "
                                "stroke-linecap=\"round\">{}</path>\n",
                                path, hex(item.ink), item.size, title);
            break;
        case Item::Kind::text:
            text += fmt::format("<text x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"{:g}\" text-anchor=\"{}\" "
                                "fill=\"{}\"{}>{}{}</text>\n",
                                item.outlines[0][0].x, item.outlines[0][0].y, item.size,
                                item.anchor == Anchor::start    ? "start"
                                : item.anchor == Anchor::middle ? "middle"
                                                                : "end",
                                hex(item.ink),
                                item.halo ? " stroke=\"#fff\" stroke-width=\"3\" paint-order=\"stroke\"" : "",
                                title, escaped(item.words));
            break;
        }
    }
    return text + "</svg>\n";
}

void Chart::writePng(const std::filesystem::path& file) const {
    passes::Image8 image{static_cast<int>(std::lround(kPngScale * width_)),
                         static_cast<int>(std::lround(kPngScale * height_)),
                         {}};
    image.rgb.assign(3 * static_cast<size_t>(image.width) * static_cast<size_t>(image.height), 255);
    const cv::Mat canvas(image.height, image.width, CV_8UC3, image.rgb.data());
    const auto scalar = [](Ink ink) { return cv::Scalar(ink[0], ink[1], ink[2]); };
    const auto fixed = [](glm::dvec2 p) {
        return cv::Point(static_cast<int>(std::lround(p.x * kPngScale * (1 << kShift))),
                         static_cast<int>(std::lround(p.y * kPngScale * (1 << kShift))));
    };
    for (const Item& item : items_) {
        std::vector<std::vector<cv::Point>> outlines;
        for (const auto& outline : item.outlines)
            std::transform(outline.begin(), outline.end(), std::back_inserter(outlines.emplace_back()),
                           fixed);
        const int thickness = std::max(1, static_cast<int>(std::lround(item.size * kPngScale)));
        if (item.kind == Item::Kind::fill) {
            cv::fillPoly(canvas, outlines, scalar(item.ink), cv::LINE_8, kShift);
        } else if (item.kind == Item::Kind::line) {
            cv::polylines(canvas, outlines, false, scalar(item.ink), thickness, cv::LINE_AA, kShift);
        } else {
            // Capitals as tall as those of a sans-serif font of that size.
            passes::Lettering letters{0.73 * item.size * kPngScale, item.ink};
            if (item.halo) letters.halo = 1.5 * kPngScale;
            const double shift = item.anchor == Anchor::start ? 0 : item.anchor == Anchor::middle ? 0.5 : 1;
            const glm::dvec2 at = kPngScale * item.outlines[0][0];
            letters.draw(image, at.x - shift * letters.width(item.words), at.y, item.words);
        }
    }
    passes::writePng(image, file);
}

double ValueScale::share(double value) const {
    if (logarithmic) {
        if (value <= low) return 0;
        return std::min(1.0, std::log(value / low) / std::log(high / low));
    }
    return std::clamp((value - low) / (high - low), 0.0, 1.0);
}

bool ValueScale::isBelow(double value) const {
    return logarithmic && value < low * (1 - 1e-9);
}

Ink ValueScale::ink(double value) const {
    if (isBelow(value)) return kDark;
    const glm::vec3 colour = passes::viridis(share(value));
    Ink ink;
    for (int c = 0; c < 3; ++c) ink[static_cast<size_t>(c)] = static_cast<uint8_t>(255 * colour[c] + 0.5f);
    return ink;
}

ValueScale luxScale(std::vector<double> lux) {
    const passes::FalseScale held = passes::scaleHolding(std::move(lux));
    return {held.lowLux, held.highLux, true, "lux", passes::legendTicks(held)};
}

ValueScale percentScale() {
    ValueScale scale;
    for (int v = 0; v <= 100; v += 10) scale.ticks.push_back(v);
    return scale;
}

void drawScale(Chart& chart, const ValueScale& scale, glm::dvec2 at, double height) {
    constexpr double kWidth = 16;
    constexpr int kSteps = 128;
    for (int k = 0; k < kSteps; ++k) {
        const double t = (k + 0.5) / kSteps;
        const double value = scale.logarithmic ? scale.low * std::pow(scale.high / scale.low, t)
                                               : scale.low + t * (scale.high - scale.low);
        chart.rectangle(at.x, at.y + height * (1 - (k + 1.0) / kSteps), kWidth, height / kSteps + 0.3,
                        scale.ink(value));
    }
    for (double tick : scale.ticks) {
        const double y = at.y + height * (1 - scale.share(tick));
        chart.line({{at.x + kWidth, y}, {at.x + kWidth + 4, y}}, kBlack, 0.8);
        chart.text({at.x + kWidth + 7, y + 4}, passes::legendNumber(tick), 11);
    }
    chart.text({at.x, at.y - 8}, scale.unit, 12);
    if (!scale.logarithmic) return;
    chart.rectangle(at.x, at.y + height + 12, kWidth, 9, kDark);
    chart.text({at.x + kWidth + 7, at.y + height + 21}, passes::belowScale({scale.low, scale.high}), 11);
}

} // namespace heliodon::app
