#include "engine/app/live_status.h"

#include <algorithm>

#include <fmt/format.h>

#include "engine/app/in_words.h"
#include "vision/detect.h"

namespace heliodon::app {

namespace {

using Colour = std::array<float, 3>;

Colour colourOf(geometry::HeightClass c) {
    return c == geometry::HeightClass::red    ? Colour{1, 0.35f, 0.30f}
           : c == geometry::HeightClass::blue ? Colour{0.35f, 0.60f, 1}
                                              : Colour{0.30f, 0.90f, 0.45f};
}

Colour colourOf(geometry::WindowKind k) {
    return k == geometry::WindowKind::standard  ? Colour{0, 0.92f, 0.96f}
           : k == geometry::WindowKind::picture ? Colour{1, 0.40f, 0.90f}
                                                : Colour{1, 0.88f, 0.20f};
}

std::string duration(double seconds) {
    return seconds < 1 ? fmt::format("{:.0f} ms", 1e3 * seconds) : fmt::format("{:.2f} s", seconds);
}

double at(const nlohmann::json& object, const char* group, const char* name) {
    const nlohmann::json value = object.value(group, nlohmann::json::object()).value(name, nlohmann::json(0));
    return value.is_number() ? value.get<double>() : 0;
}

} // namespace

std::vector<present::OperatorOutline> outlinesOf(const geometry::Sketch& sketch, const geometry::Rig& rig) {
    std::vector<present::OperatorOutline> list;
    list.push_back({vision::tableEdge(rig).outlinePx, "", {0.55f, 0.55f, 0.50f}});
    const auto add = [&](const auto& item, const Colour& colour) {
        list.push_back({item.detection.outlinePx, item.id, colour});
    };
    for (const auto& wall : sketch.walls) add(wall, colourOf(wall.heightClass));
    for (const auto& arc : sketch.arcs) add(arc, colourOf(arc.heightClass));
    for (const auto& window : sketch.windows)
        list.push_back({window.detection.outlinePx, "", colourOf(window.kind)});
    for (const auto& skylight : sketch.skylights) add(skylight, {0.62f, 0.85f, 1});
    for (const auto& token : sketch.tokens) add(token, {1, 1, 1});
    if (sketch.north) list.push_back({sketch.north->detection.outlinePx, "N", {1, 0.62f, 0.15f}});
    return list;
}

void Durations::add(double seconds) {
    constexpr size_t kKept = 4096;
    if (latest_.size() < kKept)
        latest_.push_back(static_cast<float>(seconds));
    else
        latest_[count_ % kKept] = static_cast<float>(seconds);
    ++count_;
    last_ = seconds;
    largest_ = std::max(largest_, seconds);
}

nlohmann::json Durations::summary() const {
    if (empty()) return {{"count", 0}};
    std::vector<float> sorted = latest_;
    std::sort(sorted.begin(), sorted.end());
    const auto rank = [&](double share) {
        return sorted[static_cast<size_t>(share * static_cast<double>(sorted.size() - 1))];
    };
    return {{"count", count_}, {"median", rank(0.5)}, {"p90", rank(0.9)}, {"max", largest_}};
}

void LiveFigures::frameShown() {
    ++frames;
    latestFrames_.push_back(LiveClock::now());
    std::erase_if(latestFrames_, [](LiveClock::time_point t) { return secondsSince(t) > 2; });
}

double LiveFigures::framesPerSecond() const {
    if (latestFrames_.size() < 2) return 0;
    const std::chrono::duration<double> between = latestFrames_.back() - latestFrames_.front();
    return static_cast<double>(latestFrames_.size() - 1) / std::max(1e-3, between.count());
}

nlohmann::json reportOf(const LiveStatus& status, const LiveFigures& figures) {
    return {{"camera", status.camera},
            {"pictures", status.pictures},
            {"detections", status.detections},
            {"sketches", status.sketches},
            {"refusals", status.refusals},
            {"refused", status.pictureRefused.empty() ? status.refused : status.pictureRefused},
            {"camera_losses", status.cameraLosses},
            {"device_losses", status.deviceLosses},
            {"frames", figures.frames},
            {"wheel_to_light", figures.wheelToLight.summary()},
            {"photo_to_light", figures.photoToLight.summary()},
            {"solve", figures.solve.summary()},
            {"draw", figures.draw.summary()}};
}

nlohmann::json reportOf(const LitScene& lit, const passes::Tone& tone) {
    return {{"time", lit.time}, // of the last moment; the report's `sky` and `assumed` are the start's
            {"sky", lit.sky},
            {"mean_lux", lit.figures.meanLux},
            {"max_lux", lit.figures.maxLux},
            {"glare_ratio", lit.figures.glareRatio},
            {"white_lux", tone.whiteLux.value_or(lit.autoWhite)}};
}

std::vector<std::pair<std::string, std::string>> factsOf(const LiveStatus& status, const LitScene* lit,
                                                         const LiveFigures& figures) {
    std::vector<std::pair<std::string, std::string>> facts;
    const auto add = [&](const char* name, std::string value) { facts.emplace_back(name, std::move(value)); };
    if (status.detections > 0) add("seen", inWords(status.seen));
    if (lit) {
        const nlohmann::json& scene = lit->scene->report;
        add("rooms", scene.value("message", ""));
        add("light", lit->figures.maxLux > 0
                         ? fmt::format("mean {:.0f}, most {:.0f} lux; brightest {:.1f} times darkest",
                                       lit->figures.meanLux, lit->figures.maxLux, lit->figures.glareRatio)
                         : "none");
        add("triangles", fmt::format("{}", scene.value("triangles", 0)));
        const nlohmann::json rows = scene.value("form_factors", nlohmann::json::object())
                                        .value("claimed_row_error", nlohmann::json());
        add("error",
            fmt::format("rows {}, closure {:.1e}, solution {:.1e}",
                        rows.is_number() ? fmt::format("{:.1e}", rows.get<double>()) : "unknown",
                        at(scene, "form_factors", "closure_rms"), lit->moment->report.radiosity.bound));
        add("done again", lit->scene->row);
        add("stages", fmt::format("detect {}, rooms {}, factors {}, light {}", duration(status.detectSeconds),
                                  duration(at(scene, "stages", "model")),
                                  duration(at(scene, "stages", "formfactors")), duration(lit->solveSeconds)));
    }
    if (!figures.photoToLight.empty()) add("photo to light", duration(figures.photoToLight.last()));
    if (!figures.wheelToLight.empty()) add("wheel to light", duration(figures.wheelToLight.last()));
    add("drawing",
        fmt::format("{}, {:.0f} frames/s", duration(figures.draw.last()), figures.framesPerSecond()));
    return facts;
}

} // namespace heliodon::app
