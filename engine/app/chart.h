// Flat drawings for reports: polygons, lines and words, written as SVG or, drawn twice as large, as PNG.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

namespace heliodon::app {

using Ink = std::array<uint8_t, 3>; // sRGB
inline constexpr Ink kBlack{20, 20, 20}, kDark{0, 0, 0}, kGrey{130, 130, 130}, kPaper{255, 255, 255};

// Words as they may stand in SVG.
std::string escaped(const std::string& words);

enum class Anchor { start, middle, end };

class Chart {
public:
    Chart(double width, double height) : width_(width), height_(height) {}

    // Coordinates in pixels of the SVG, y down. What is drawn later lies on top.
    void fill(std::vector<glm::dvec2> outline, Ink ink);
    // One area within several outlines; what lies within an even number of them is a hole.
    void fill(std::vector<std::vector<glm::dvec2>> outlines, Ink ink);
    void rectangle(double x, double y, double width, double height, Ink ink);
    void line(std::vector<glm::dvec2> points, Ink ink, double thickness);
    // `at`: left end, middle or right end of the baseline; letters about `size` pixels tall. UTF-8. With a
    // halo, words stay legible on any colour.
    void text(glm::dvec2 at, const std::string& words, double size, Anchor anchor = Anchor::start,
              Ink ink = kBlack, bool halo = false);

    // What a viewer of the SVG shows when the pointer is on the last thing drawn. PNG has none.
    void explain(const std::string& words) { items_.back().title = words; }

    double width() const { return width_; }
    double height() const { return height_; }

    // By extension, .svg or .png; whole or not at all.
    void write(const std::filesystem::path& file) const;
    std::string svg() const;

private:
    struct Item {
        enum class Kind { fill, line, text } kind;
        std::vector<std::vector<glm::dvec2>> outlines; // a line's points or a text's place are the only one
        Ink ink;
        double size = 0;
        std::string words;
        Anchor anchor = Anchor::start;
        bool halo = false;
        std::string title = {};
    };
    void writePng(const std::filesystem::path& file) const;

    double width_, height_;
    std::vector<Item> items_;
};

// Throws InputError where Chart::write could not: a file of another ending; none is fine.
void refuseNoDrawing(const std::filesystem::path& file);

// A scale of colours with what its numbers mean.
struct ValueScale {
    double low = 0, high = 100;
    bool logarithmic = false;
    std::string unit = "%";
    std::vector<double> ticks; // numbers beside the bar, and lines of equal value in plans

    double share(double value) const; // 0 at low, 1 at high, clamped
    bool isBelow(double value) const; // a logarithmic scale: darker than what it tells apart
    Ink ink(double value) const;      // viridis, or black
};

// Logarithmic: passes::scaleHolding() of these.
ValueScale luxScale(std::vector<double> lux);
ValueScale percentScale();

// A bar with numbers, `height` tall, its left edge at `at`, and some 21 pixels below it black, where the
// scale is logarithmic.
void drawScale(Chart& chart, const ValueScale& scale, glm::dvec2 at, double height);

} // namespace heliodon::app
