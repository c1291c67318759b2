#include "engine/app/stamp.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

namespace heliodon::app {

namespace {

constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;
constexpr double kCapital = 22; // pixels, of the font at scale 1
constexpr int kLeastHeight = 120;
constexpr const char* kDegree = "\xC2\xB0";
const cv::Scalar kInk(240, 240, 240);

// One line as the font can draw it: pieces between degree signs, which it lacks.
struct Line {
    std::vector<std::string> pieces;
    double scale;
    int pen;

    Line(const std::string& text, double capital) : scale(capital / kCapital) {
        pen = std::max(1, static_cast<int>(std::lround(scale)));
        const std::string degree = kDegree;
        size_t from = 0, at = 0;
        while ((at = text.find(degree, from)) != std::string::npos) {
            pieces.push_back(text.substr(from, at - from));
            from = at + degree.size();
        }
        pieces.push_back(text.substr(from));
    }
    int degreeWidth() const { return static_cast<int>(std::lround(12 * scale)); }
    int width() const {
        int below = 0, sum = degreeWidth() * (static_cast<int>(pieces.size()) - 1);
        for (const std::string& piece : pieces)
            sum += cv::getTextSize(piece, kFont, scale, pen, &below).width;
        return sum;
    }
    // `at`: left end of the baseline.
    void draw(cv::Mat& canvas, cv::Point at) const {
        int below = 0;
        for (size_t k = 0; k < pieces.size(); ++k) {
            if (k > 0) {
                const int radius = std::max(1, static_cast<int>(std::lround(4 * scale)));
                const auto up = static_cast<int>(std::lround((kCapital - 4) * scale));
                cv::circle(canvas, at + cv::Point(degreeWidth() / 2, -up), radius, kInk, pen, cv::LINE_AA);
                at.x += degreeWidth();
            }
            cv::putText(canvas, pieces[k], at, kFont, scale, kInk, pen, cv::LINE_AA);
            at.x += cv::getTextSize(pieces[k], kFont, scale, pen, &below).width;
        }
    }
};

} // namespace

void drawStamp(passes::Image8& picture, const std::vector<std::string>& words) {
    if (picture.height < kLeastHeight || words.empty()) return;
    const double capital = std::max(9.0, picture.height / 44.0);
    const int margin = static_cast<int>(std::lround(0.7 * capital)), room = picture.width - 4 * margin;
    if (room <= 0) return;
    std::vector<Line> lines;
    int widest = 0;
    for (const std::string& text : words) {
        const double wanted = lines.empty() ? capital : std::max(8.0, 0.72 * capital);
        Line line(text, wanted);
        if (line.width() > room) line = Line(text, wanted * room / line.width());
        widest = std::max(widest, line.width());
        lines.push_back(std::move(line));
    }
    const auto advance = [](const Line& line) {
        return static_cast<int>(std::lround(1.6 * kCapital * line.scale));
    };
    int tall = margin;
    for (const Line& line : lines) tall += advance(line);
    cv::Mat canvas(picture.height, picture.width, CV_8UC3, picture.rgb.data());
    const cv::Rect box =
        cv::Rect(0, picture.height - tall - margin / 2, widest + 2 * margin + margin / 2, tall + margin / 2) &
        cv::Rect(0, 0, picture.width, picture.height);
    cv::Mat ground = canvas(box);
    ground.convertTo(ground, -1, 0.35);
    int y = box.y;
    for (const Line& line : lines) {
        y += advance(line);
        line.draw(canvas, {margin, y + margin / 4});
    }
}

std::string sunInWords(const daylight::SunPosition& sun) {
    const double shown = std::abs(sun.altitudeDeg);
    return fmt::format("sun {:.1f}{} {}", shown, kDegree, sun.altitudeDeg < 0 ? "below the horizon" : "high");
}

} // namespace heliodon::app
