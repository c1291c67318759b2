#include "engine/app/bench_results.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/app/table_file.h"

namespace heliodon::app {

namespace {

// Values as the CSV has them, from the JSON: one list of columns for both.
template<class Result> std::string csv(const std::vector<Result>& results) {
    std::string text;
    const nlohmann::ordered_json columns = jsonOf(Result{});
    for (const auto& [key, value] : columns.items()) text += (text.empty() ? "" : ",") + key;
    text += "\n";
    for (const Result& result : results) {
        const nlohmann::ordered_json row = jsonOf(result);
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

} // namespace

std::string errorText(double error) {
    const int decade = static_cast<int>(std::floor(std::log10(error) + 1e-6));
    return fmt::format("{:.3g}e{}", error / std::pow(10, decade), decade);
}

void markFront(std::vector<BenchResult>& results) {
    const auto known = [](const BenchResult& r) { return std::max(r.rowError, r.referenceError); };
    for (BenchResult& r : results)
        r.onFront = std::none_of(results.begin(), results.end(), [&](const BenchResult& o) {
            const bool nowhereWorse = o.compared.median <= r.compared.median && known(o) <= known(r),
                       better = o.compared.median < r.compared.median || known(o) < known(r);
            return o.scene == r.scene && o.patches == r.patches && nowhereWorse && better;
        });
}

nlohmann::ordered_json jsonOf(const BenchResult& r) {
    return {{"scene", r.scene},
            {"patches", r.patches},
            {"kernel", r.kernel},
            {"setting", r.setting},
            {"peer", r.peer},
            {"runs", r.runs},
            {"seconds", r.wall.median},
            {"seconds_min", r.wall.least},
            {"seconds_max", r.wall.most},
            {"cpu_seconds", r.cpu.median},
            {"cpu_seconds_min", r.cpu.least},
            {"cpu_seconds_max", r.cpu.most},
            {"device_seconds", r.deviceSeconds},
            {"row_error", r.rowError},
            {"row_error_max", r.rowErrorMax},
            {"entry_error_max", r.entryMax},
            {"reference_error", r.referenceError},
            {"claimed_row_error", r.claimedRowError},
            {"closure_max", r.closureMax},
            {"closure_rms", r.closureRms},
            {"reciprocity_rms", r.reciprocityRms},
            {"pairs_apart", r.pairsApart},
            {"pairs_hidden", r.pairsHidden},
            {"pairs_visible", r.pairsVisible},
            {"pairs_partial", r.pairsPartial},
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

} // namespace heliodon::app
