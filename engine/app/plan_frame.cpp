#include "engine/app/plan_frame.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/trigonometric.hpp>

namespace heliodon::app {

namespace {

constexpr double kPlan = 720, kNarrowest = 600, kLowest = 260, kMargin = 40, kHead = 62, kFoot = 40; // pixels
constexpr double kCaption = 24; // above each of several storeys
constexpr double kLetter = 6;   // wide, of a subtitle
constexpr double kKeyLetter = 6.5;

// In lines of so many letters, at most two; what is longer is cut off.
std::vector<std::string> twoLines(const std::string& words, size_t letters) {
    if (words.size() <= letters) return {words};
    const auto before = [&](const std::string& line) {
        const size_t space = line.rfind(' ', letters);
        return space == std::string::npos || space == 0 ? letters : space;
    };
    const size_t first = before(words);
    std::string rest = words.substr(first + (words[first] == ' '));
    if (rest.size() > letters) rest = rest.substr(0, before(rest)) + " ...";
    return {words.substr(0, first), rest};
}

} // namespace

PlanFrame::PlanFrame(glm::dvec2 low, glm::dvec2 high, size_t storey, size_t storeys, double beside)
    : low_(low), caption_(storeys > 1 ? kCaption : 0), beside_(beside) {
    const glm::dvec2 extent = glm::max(high - low, glm::dvec2(1e-9));
    pixels_ = kPlan / std::max(extent.x, extent.y);
    size_ = pixels_ * extent;
    const auto columns = static_cast<size_t>(std::ceil(std::sqrt(static_cast<double>(storeys))));
    const glm::dvec2 pitch = size_ + glm::dvec2(kMargin, caption_);
    origin_ =
        glm::dvec2(kMargin, kHead + caption_) +
        pitch * glm::dvec2(static_cast<double>(storey % columns), static_cast<double>(storey / columns));
    all_ = pitch * glm::dvec2(static_cast<double>(columns),
                              static_cast<double>((storeys + columns - 1) / columns)) -
           glm::dvec2(kMargin, 0);
}

Chart PlanFrame::chart() const {
    return {std::max(all_.x, kNarrowest) + 2 * kMargin + beside_,
            std::max(all_.y, kLowest) + kHead + kFoot + kMargin};
}

void PlanFrame::title(Chart& chart, const std::string& title, const std::string& subtitle) const {
    chart.text({kMargin, 22}, title, 15);
    double y = 40;
    for (const std::string& line :
         twoLines(subtitle, static_cast<size_t>((chart.width() - kMargin) / kLetter))) {
        chart.text({kMargin, y}, line, 11);
        y += 14;
    }
}

void PlanFrame::caption(Chart& chart, const std::string& words) const {
    chart.text(origin_ - glm::dvec2(0, 8), words, 11);
}

glm::dvec2 PlanFrame::scaleAt() const {
    return {chart().width() - beside_, kHead + 10};
}

double PlanFrame::scaleHeight() const {
    return std::max(size_.y, kLowest) - 20;
}

glm::dvec2 PlanFrame::keysAt() const {
    return {kMargin + 215, chart().height() - kFoot + 8};
}

void PlanFrame::key(Chart& chart, glm::dvec2 at, Ink ink, double thickness, const std::string& words) const {
    const glm::dvec2 p = keysAt() + at;
    chart.line({p, p + glm::dvec2(20, 0)}, ink, thickness);
    chart.text(p + glm::dvec2(28, 4), words, 11);
}

void PlanFrame::keys(Chart& chart, const std::vector<Key>& all) const {
    glm::dvec2 at(0);
    for (const Key& one : all) {
        key(chart, at, one.ink, one.thickness, one.words);
        at.x += 46 + kKeyLetter * static_cast<double>(one.words.size());
    }
}

void PlanFrame::foot(Chart& chart, double worldPerBuilding, double northDeg) const {
    const double metre = pixels_ * worldPerBuilding;
    double length = 1; // building metres, about a fifth of the plan
    while (length * metre > 150) length /= 2;
    while (length * metre < 70) length *= 2;
    const glm::dvec2 at(kMargin, keysAt().y);
    chart.line({at, at + glm::dvec2(length * metre, 0)}, kBlack, 2);
    for (double end : {0.0, length * metre})
        chart.line({at + glm::dvec2(end, -4), at + glm::dvec2(end, 4)}, kBlack, 1.2);
    chart.text(at + glm::dvec2(length * metre + 8, 4), fmt::format("{:g} m", length), 11);
    const double angle = glm::radians(northDeg);
    const glm::dvec2 north(std::cos(angle), -std::sin(angle)), side(-north.y, north.x);
    const glm::dvec2 foot = glm::dvec2(chart.width() - beside_ - kMargin - 20, at.y) - 12.0 * north;
    chart.line({foot, foot + 24.0 * north}, kBlack, 1.5);
    chart.fill({foot + 28.0 * north, foot + 16.0 * north + 5.0 * side, foot + 16.0 * north - 5.0 * side},
               kBlack);
    chart.text(foot + 24.0 * north + 14.0 * side + glm::dvec2(0, 4), "N", 12, Anchor::middle);
}

} // namespace heliodon::app
