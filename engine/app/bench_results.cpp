#include "engine/app/bench_results.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "engine/app/chart.h"
#include "engine/app/table_file.h"

namespace heliodon::app {

namespace {

std::string panelName(const BenchResult& r) {
    return fmt::format("{}, {} patches", r.scene, r.patches);
}

// Values as the CSV has them, from the JSON: one list of columns for both.
template<class Result> std::string csv(const std::vector<Result>& results) {
    std::string text;
    for (const Result& result : results) {
        const nlohmann::ordered_json row = jsonOf(result);
        if (text.empty()) {
            for (const auto& [key, value] : row.items()) text += (text.empty() ? "" : ",") + key;
            text += "\n";
        }
        std::string line;
        for (const auto& [key, value] : row.items()) {
            if (!line.empty()) line += ",";
            line += value.is_number_float() ? fmt::format("{:.6g}", value.template get<double>())
                    : value.is_string()     ? csvField(value.template get<std::string>())
                                            : value.dump();
        }
        text += line + "\n";
    }
    return text;
}

const char* colourOf(const std::string& kernel) {
    static const std::map<std::string, const char*> colours{
        {"exact", "#c0392b"},        {"hemicube", "#2463b4"},        {"montecarlo", "#8e44ad"},
        {"hierarchical", "#d98200"}, {"embree hemicube", "#2e8b57"}, {"embree rays", "#7aa62a"},
        {"view3d", "#555555"}};
    const auto found = colours.find(kernel);
    return found == colours.end() ? "#00808a" : found->second;
}

std::string secondsText(int decade) {
    return decade >= 0 ? fmt::format("{:g} s", std::pow(10, decade))
                       : fmt::format("{:g} ms", std::pow(10, decade + 3));
}

class Panel {
public:
    static constexpr double kWidth = 760, kHeight = 420;

    Panel(std::vector<BenchResult> results, double top, std::string clock)
        : results_(std::move(results)), top_(top), clock_(std::move(clock)) {
        double x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY;
        for (const BenchResult& r : results_) {
            x0 = std::min(x0, logSeconds(r));
            x1 = std::max(x1, logSeconds(r));
            y0 = std::min(y0, logError(r));
            y1 = std::max(y1, logError(r));
        }
        firstX_ = static_cast<int>(std::floor(x0 - 0.1));
        lastX_ = std::max(firstX_ + 1, static_cast<int>(std::ceil(x1 + 0.1)));
        firstY_ = static_cast<int>(std::floor(y0));
        lastY_ = std::max(firstY_ + 1, static_cast<int>(std::ceil(y1)));
    }

    std::string svg() const {
        std::string text =
            fmt::format("<text x=\"70\" y=\"{:.0f}\" font-size=\"15\" font-weight=\"bold\">{}</text>\n",
                        top_ + 24, escaped(panelName(results_.front())));
        text += grid() + front();
        for (const BenchResult& r : results_) text += mark(r);
        return text + labels();
    }

private:
    static double logSeconds(const BenchResult& r) { return std::log10(std::max(r.comparedSeconds, 1e-6)); }
    static double logError(const BenchResult& r) { return std::log10(std::max(r.rowError, 1e-8)); }
    double x(double logValue) const {
        return 70 + (kWidth - 240) * (logValue - firstX_) / (lastX_ - firstX_);
    }
    double y(double logValue) const {
        return top_ + kHeight - 50 - (kHeight - 95) * (logValue - firstY_) / (lastY_ - firstY_);
    }

    std::string grid() const {
        std::string text;
        for (int e = firstY_; e <= lastY_; ++e)
            text += fmt::format("<path d=\"M{0:.1f} {2:.1f}H{1:.1f}\" stroke=\"#ddd\"/>"
                                "<text x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"end\">1e{5}</text>\n",
                                x(firstX_), x(lastX_), y(e), x(firstX_) - 6, y(e) + 4, e);
        for (int e = firstX_; e <= lastX_; ++e)
            text += fmt::format("<path d=\"M{0:.1f} {1:.1f}V{2:.1f}\" stroke=\"#ddd\"/>"
                                "<text x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\">{4}</text>\n",
                                x(e), y(lastY_), y(firstY_), y(firstY_) + 16, secondsText(e));
        return text +
               fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"middle\">{} time</text>\n"
                           "<text transform=\"translate(18 {:.0f}) rotate(-90)\" text-anchor=\"middle\">RMS "
                           "row error</text>\n",
                           0.5 * (x(firstX_) + x(lastX_)), y(firstY_) + 34, clock_,
                           0.5 * (y(firstY_) + y(lastY_)));
    }

    std::string front() const {
        std::vector<const BenchResult*> best;
        for (const BenchResult& r : results_)
            if (r.onFront) best.push_back(&r);
        std::sort(best.begin(), best.end(),
                  [](auto* a, auto* b) { return a->comparedSeconds < b->comparedSeconds; });
        std::string path;
        for (const BenchResult* r : best)
            path +=
                fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x(logSeconds(*r)), y(logError(*r)));
        return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#999\" stroke-dasharray=\"4 3\"/>\n", path);
    }

    std::string mark(const BenchResult& r) const {
        const double px = x(logSeconds(r)), py = y(logError(r));
        const char* colour = colourOf(r.kernel);
        const char* fill = r.onFront ? colour : "white";
        const std::string title =
            fmt::format("<title>{}: error {:.2g} in {:.3g} s</title>", escaped(r.kernel + " " + r.setting),
                        r.rowError, r.comparedSeconds);
        if (r.peer)
            return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"8\" height=\"8\" stroke=\"{}\" "
                               "fill=\"{}\">{}</rect>\n",
                               px - 4, py - 4, colour, fill, title);
        return fmt::format(
            "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.5\" stroke=\"{}\" fill=\"{}\">{}</circle>\n", px, py,
            colour, fill, title);
    }

    // To the right of the marks, pushed down where they would cover one another.
    std::string labels() const {
        std::vector<const BenchResult*> order;
        for (const BenchResult& r : results_) order.push_back(&r);
        std::sort(order.begin(), order.end(), [](auto* a, auto* b) { return a->rowError > b->rowError; });
        struct Place {
            double x, y, width;
        };
        std::vector<Place> placed;
        std::string text;
        for (const BenchResult* r : order) {
            const std::string words = r->kernel + " " + r->setting;
            Place place{x(logSeconds(*r)) + 9, y(logError(*r)) + 4, 6 * static_cast<double>(words.size())};
            const auto covers = [&](const Place& other) {
                return place.x < other.x + other.width && other.x < place.x + place.width &&
                       std::abs(place.y - other.y) < 12 - 1e-6; // less what y + 12 - y may be short of 12
            };
            for (auto other = placed.begin(); other != placed.end();)
                if (covers(*other)) {
                    place.y = other->y + 12;
                    other = placed.begin();
                } else
                    ++other;
            placed.push_back(place);
            text += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"11\" fill=\"{}\">{}</text>\n",
                                place.x, place.y, colourOf(r->kernel), escaped(words));
        }
        return text;
    }

    std::vector<BenchResult> results_;
    double top_;
    std::string clock_;
    int firstX_ = 0, lastX_ = 0, firstY_ = 0, lastY_ = 0; // decades
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

void markFront(std::vector<BenchResult>& results) {
    for (BenchResult& r : results)
        r.onFront = std::none_of(results.begin(), results.end(), [&](const BenchResult& o) {
            return panelName(o) == panelName(r) && o.comparedSeconds < r.comparedSeconds &&
                   o.rowError < r.rowError;
        });
}

nlohmann::ordered_json jsonOf(const BenchResult& r) {
    return {{"scene", r.scene},
            {"patches", r.patches},
            {"kernel", r.kernel},
            {"setting", r.setting},
            {"peer", r.peer},
            {"seconds", r.wallSeconds},
            {"cpu_seconds", r.cpuSeconds},
            {"device_seconds", r.deviceSeconds},
            {"row_error", r.rowError},
            {"row_error_max", r.rowErrorMax},
            {"entry_error_max", r.entryMax},
            {"reference_error", r.referenceError},
            {"claimed_row_error", r.claimedRowError},
            {"closure_max", r.closureMax},
            {"closure_rms", r.closureRms},
            {"reciprocity_rms", r.reciprocityRms},
            {"pairs_per_second", r.pairsPerSecond},
            {"rays_per_second", r.raysPerSecond},
            {"bytes_per_second", r.bytesPerSecond},
            {"peak_bytes", r.peakBytes},
            {"roofline_fraction", r.rooflineFraction},
            {"pareto", r.onFront}};
}

nlohmann::ordered_json jsonOf(const GatherResult& r) {
    return {{"scene", r.scene},
            {"patches", r.patches},
            {"columns", r.columns},
            {"seconds", r.wallSeconds},
            {"native_seconds", r.nativeSeconds},
            {"ratio", r.wallSeconds / r.nativeSeconds},
            {"bytes_per_second", r.bytesPerSecond},
            {"roofline_fraction", r.rooflineFraction},
            {"error", r.error}};
}

std::string csvOf(const std::vector<BenchResult>& results) {
    return csv(results);
}
std::string csvOf(const std::vector<GatherResult>& results) {
    return csv(results);
}

std::string plotOf(const std::vector<BenchResult>& results, const std::string& device,
                   const std::string& clock) {
    const auto groups = panels(results);
    const double height = 40 + Panel::kHeight * static_cast<double>(groups.size());
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
        "height=\"{1:.0f}\" font-family=\"sans-serif\" font-size=\"12\">\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
        "<text x=\"70\" y=\"20\" fill=\"#555\">{2}; squares: other programs; filled: none "
        "is both faster and better</text>\n",
        Panel::kWidth, height, escaped(device));
    for (size_t k = 0; k < groups.size(); ++k)
        svg += Panel(groups[k], 30 + Panel::kHeight * static_cast<double>(k), clock).svg();
    return svg + "</svg>\n";
}

} // namespace heliodon::app
