#include "engine/app/bench_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "engine/passes/label_places.h"
#include "engine/passes/lettering.h"

namespace heliodon::app {

namespace {

constexpr double kWidth = 860, kPanelHeight = 470, kTop = 34;                // pixels
constexpr double kLeft = 62, kRight = 640, kAbove = 58, kBelow = 56;         // of a panel's axes
constexpr double kMark = 4.5, kLetters = 12, kSmallLetters = 11, kLine = 15, // radius, sizes, distance
    kRightSide = 30;                                                         // as passes::Label::towards
constexpr Ink kGrid{226, 226, 226}, kFinerGrid{243, 243, 243}, kFront{214, 214, 214};

struct Style {
    Ink ink;
    const char* numbers; // what settings say
};

const Style& styleOf(const std::string& kernel) {
    static const std::map<std::string, Style> styles{
        {"exact", {{192, 57, 43}, "row error asked"}},  {"hierarchical", {{217, 130, 0}, "row error asked"}},
        {"hemicube", {{36, 99, 180}, "pixels"}},        {"montecarlo", {{142, 68, 173}, "rays a patch"}},
        {"embree hemicube", {{46, 139, 87}, "pixels"}}, {"embree rays", {{122, 166, 42}, "rays a patch"}},
        {"view3d", {{85, 85, 85}, "its epsilon"}}};
    static const Style others{{0, 128, 138}, "row error asked"};
    const auto found = styles.find(kernel);
    return found == styles.end() ? others : found->second;
}

Ink paler(Ink ink) {
    for (uint8_t& c : ink) c = static_cast<uint8_t>(255 - (255 - c) * 2 / 5);
    return ink;
}

std::string panelName(const BenchResult& r) {
    return fmt::format("{}, {} patches", r.scene, r.patches);
}

std::string secondsText(double seconds) {
    return seconds >= 0.999 ? fmt::format("{:g} s", seconds) : fmt::format("{:g} ms", 1000 * seconds);
}

// A logarithmic axis with some air about its values, at least a decade.
class Axis {
public:
    Axis(double least, double most, double from, double to) : from_(from), to_(to) {
        const double middle = 0.5 * (std::log10(least) + std::log10(most)),
                     half = std::max(0.5, 0.54 * (std::log10(most) - std::log10(least)) + 0.05);
        low_ = middle - half, high_ = middle + half;
    }

    double at(double value) const {
        return from_ + (to_ - from_) * (std::log10(value) - low_) / (high_ - low_);
    }

    // 1, 2 .. 9 of each decade; which of them have their number beside them.
    struct Tick {
        double value;
        bool named;
    };
    std::vector<Tick> ticks() const {
        std::vector<Tick> ticks;
        for (int decade = static_cast<int>(std::floor(low_)); decade <= high_; ++decade)
            for (int lead = 1; lead < 10; ++lead) {
                const double value = lead * std::pow(10, decade), place = std::log10(value);
                if (place < low_ || place > high_) continue;
                ticks.push_back({value, lead == 1 || (high_ - low_ < 2.5 && (lead == 2 || lead == 5))});
            }
        return ticks;
    }

private:
    double from_, to_, low_, high_;
};

class Panel {
public:
    Panel(Chart& chart, std::vector<BenchResult> results, double top, const std::string& clock)
        : chart_(chart), results_(std::move(results)), top_(top),
          x_(axis([](const BenchResult& r) { return secondsOf(r.compared.least); },
                  [](const BenchResult& r) { return secondsOf(r.compared.most); }, kLeft, kRight)),
          y_(axis(errorOf, errorOf, bottom(), top + kAbove)) {
        chart_.text({kLeft, top_ + 24}, panelName(results_.front()), 15);
        grid(clock);
        lines();
        for (const BenchResult& r : results_) bar(r);
        for (const BenchResult& r : results_) mark(placeOf(r), r);
        labels();
        legend();
    }

private:
    static double secondsOf(double seconds) { return std::max(seconds, 1e-6); }
    static double errorOf(const BenchResult& r) { return std::max(r.rowError, 1e-8); }
    double bottom() const { return top_ + kPanelHeight - kBelow; }
    glm::dvec2 placeOf(const BenchResult& r) const {
        return {x_.at(secondsOf(r.compared.median)), y_.at(errorOf(r))};
    }

    template<class Low, class High>
    Axis axis(const Low& low, const High& high, double from, double to) const {
        double least = INFINITY, most = 0;
        for (const BenchResult& r : results_) least = std::min(least, low(r)), most = std::max(most, high(r));
        return {least, most, from, to};
    }

    void grid(const std::string& clock) {
        for (const bool named : {false, true}) { // finer lines lie below
            for (const Axis::Tick& tick : x_.ticks())
                if (tick.named == named)
                    chart_.line({{x_.at(tick.value), top_ + kAbove}, {x_.at(tick.value), bottom()}},
                                named ? kGrid : kFinerGrid, named ? 1 : 0.5);
            for (const Axis::Tick& tick : y_.ticks())
                if (tick.named == named)
                    chart_.line({{kLeft, y_.at(tick.value)}, {kRight, y_.at(tick.value)}},
                                named ? kGrid : kFinerGrid, named ? 1 : 0.5);
        }
        for (const Axis::Tick& tick : x_.ticks())
            if (tick.named)
                chart_.text({x_.at(tick.value), bottom() + 17}, secondsText(tick.value), kLetters,
                            Anchor::middle);
        for (const Axis::Tick& tick : y_.ticks())
            if (tick.named)
                chart_.text({kLeft - 7, y_.at(tick.value) + 4}, errorText(tick.value), kLetters, Anchor::end);
        chart_.line({{kLeft, top_ + kAbove}, {kLeft, bottom()}, {kRight, bottom()}}, kGrey, 1);
        chart_.text({0.5 * (kLeft + kRight), bottom() + 36}, clock + " time", kLetters, Anchor::middle);
        chart_.text({kLeft, top_ + kAbove - 10}, "RMS row error", kLetters);
    }

    // The front, and what belongs to one kernel in the order of its settings.
    void lines() {
        std::vector<const BenchResult*> best;
        for (const BenchResult& r : results_)
            if (r.onFront) best.push_back(&r);
        std::sort(best.begin(), best.end(),
                  [](auto* a, auto* b) { return a->compared.median < b->compared.median; });
        std::vector<glm::dvec2> front;
        for (const BenchResult* r : best) front.push_back(placeOf(*r));
        line(std::move(front), kFront, 5);
        for (const std::string& kernel : kernels()) {
            std::vector<glm::dvec2> series;
            for (const BenchResult& r : results_)
                if (r.kernel == kernel) series.push_back(placeOf(r));
            line(std::move(series), paler(styleOf(kernel).ink), 1);
        }
    }

    void line(std::vector<glm::dvec2> points, Ink ink, double thickness) {
        for (size_t k = 1; k < points.size(); ++k) drawn_.push_back({points[k - 1], points[k]});
        if (points.size() > 1) chart_.line(std::move(points), ink, thickness);
    }

    std::vector<std::string> kernels() const {
        std::vector<std::string> names;
        for (const BenchResult& r : results_)
            if (std::find(names.begin(), names.end(), r.kernel) == names.end()) names.push_back(r.kernel);
        return names;
    }

    // Where the runs of a setting differ by more than its mark is wide.
    void bar(const BenchResult& r) {
        const double y = placeOf(r).y, from = x_.at(secondsOf(r.compared.least)),
                     to = x_.at(secondsOf(r.compared.most));
        if (to - from < kMark) return;
        const Ink ink = paler(styleOf(r.kernel).ink);
        line({{from, y}, {to, y}}, ink, 1.4);
        for (const double x : {from, to}) chart_.line({{x, y - kMark}, {x, y + kMark}}, ink, 1.4);
    }

    // A square for other programs.
    void mark(glm::dvec2 at, const BenchResult& r, bool explained = true) {
        std::vector<glm::dvec2> outline;
        const int corners = r.peer ? 4 : 24;
        const double radius = r.peer ? kMark * std::numbers::sqrt2 * 0.9 : kMark;
        for (int k = 0; k <= corners; ++k) {
            const double angle = 2 * std::numbers::pi * (k + 0.5) / corners;
            outline.push_back(at + radius * glm::dvec2(std::cos(angle), std::sin(angle)));
        }
        const Ink ink = styleOf(r.kernel).ink;
        chart_.fill(outline, r.onFront && explained ? ink : kPaper);
        chart_.line(std::move(outline), ink, 1.4);
        if (explained)
            chart_.explain(fmt::format("{} {}: row error {:.2g} in {:.3g} s ({:.3g} to {:.3g} in {} run{})",
                                       r.kernel, r.setting, r.rowError, r.compared.median, r.compared.least,
                                       r.compared.most, r.runs, r.runs > 1 ? "s" : ""));
    }

    void labels() {
        std::vector<passes::Label> labels;
        for (const BenchResult& r : results_)
            labels.push_back({{placeOf(r)},
                              {passes::Lettering{0.73 * kSmallLetters}.width(r.setting), kSmallLetters},
                              {kRightSide, 0}});
        const std::vector<passes::Box> boxes =
            passes::placeLabels(labels, {{kLeft, top_ + kAbove}, {kRight + 20, bottom()}}, kMark + 2, drawn_);
        for (size_t k = 0; k < boxes.size(); ++k) {
            const Ink ink = styleOf(results_[k].kernel).ink;
            const glm::dvec2 at = labels[k].outline[0],
                             near{std::clamp(at.x, boxes[k].low.x, boxes[k].high.x),
                                  std::clamp(at.y, boxes[k].low.y, boxes[k].high.y)},
                             way = near - at;
            const double far = std::hypot(way.x, way.y);
            if (far > 3 * kMark) chart_.line({at + way * (kMark / far), near}, ink, 0.5);
            chart_.text({boxes[k].low.x, boxes[k].high.y - 0.15 * kSmallLetters}, results_[k].setting,
                        kSmallLetters, Anchor::start, ink, true);
        }
    }

    void legend() {
        const double x = kRight + 42;
        double y = top_ + kAbove + 8;
        for (const std::string& kernel : kernels()) {
            const auto first = std::find_if(results_.begin(), results_.end(),
                                            [&](const BenchResult& r) { return r.kernel == kernel; });
            mark({x, y - 4}, *first, false);
            chart_.text({x + 13, y}, kernel, kLetters, Anchor::start, styleOf(kernel).ink);
            chart_.text({x + 13, y + kLine - 1}, styleOf(kernel).numbers, kSmallLetters, Anchor::start,
                        kGrey);
            y += 2.3 * kLine;
        }
        chart_.line({{x - 5, y - 4}, {x + 6, y - 4}}, kFront, 5);
        chart_.text({x + 13, y}, "filled: nothing faster", kSmallLetters, Anchor::start, kGrey);
        chart_.text({x + 13, y + kLine - 1}, "is as good", kSmallLetters, Anchor::start, kGrey);
        y += 2 * kLine;
        if (std::ranges::any_of(results_, [](const BenchResult& r) { return r.runs > 1; })) {
            chart_.text({x + 13, y}, "bar: all runs", kSmallLetters, Anchor::start, kGrey);
            y += kLine;
        }
        if (std::any_of(results_.begin(), results_.end(), [](const BenchResult& r) { return r.peer; }))
            chart_.text({x + 13, y}, "squares: other programs", kSmallLetters, Anchor::start, kGrey);
    }

    Chart& chart_;
    std::vector<BenchResult> results_;
    double top_;
    Axis x_, y_;
    std::vector<passes::Line> drawn_; // what labels should not cover
};

// Results of each scene and size, in the order of the first of each.
std::vector<std::vector<BenchResult>> panels(const std::vector<BenchResult>& results) {
    std::vector<std::vector<BenchResult>> groups;
    for (const BenchResult& r : results) {
        auto group = std::find_if(groups.begin(), groups.end(),
                                  [&](const auto& g) { return panelName(g.front()) == panelName(r); });
        if (group == groups.end()) group = groups.insert(groups.end(), std::vector<BenchResult>{});
        group->push_back(r);
    }
    return groups;
}

} // namespace

Chart plotOf(const std::vector<BenchResult>& results, const std::string& device, const std::string& clock) {
    const auto groups = panels(results);
    Chart chart(kWidth, kTop + kPanelHeight * static_cast<double>(groups.size()));
    chart.text({kLeft, 22}, "Form factors on " + device, kLetters, Anchor::start, kGrey);
    for (size_t k = 0; k < groups.size(); ++k)
        Panel(chart, groups[k], kTop + kPanelHeight * static_cast<double>(k), clock);
    return chart;
}

} // namespace heliodon::app
