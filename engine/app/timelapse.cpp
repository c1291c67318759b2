#include <algorithm>
#include <csignal>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "engine/app/commands.h"
#include "engine/app/film.h"
#include "engine/app/light_report.h"
#include "engine/app/moment.h"
#include "engine/app/pictures.h"
#include "engine/app/progress.h"
#include "engine/app/scene_input.h"
#include "engine/passes/image_file.h"
#include "geometry/input_error.h"
#include "geometry/whole_file.h"

namespace heliodon::app {

namespace {

namespace fs = std::filesystem;

constexpr size_t kSolvedTogether = 8; // moments that share passes over the form factors

volatile std::sig_atomic_t interrupted = 0;

// Ctrl-C ends after the frame at hand, so that what is on disk is whole; a second one ends at once.
class InterruptGuard {
public:
    InterruptGuard()
        : before_(std::signal(SIGINT, [](int) {
              interrupted = 1;
              std::signal(SIGINT, SIG_DFL);
          })) {}
    ~InterruptGuard() { std::signal(SIGINT, before_); }
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;

private:
    void (*before_)(int);
};

// The views of one frame, as films or as numbered pictures. Pictures of several views have the view in their
// names.
class FrameSink {
public:
    FrameSink(const TimelapseArguments& arguments, std::vector<std::string> views)
        : arguments_(arguments), views_(std::move(views)), asFilm_(arguments.output.extension() == ".mp4") {
        if (!asFilm_)
            prepareFolder(arguments.output);
        else if (arguments.resume)
            throw geometry::InputError("--resume", "", "goes on into a folder of pictures, not into a film");
        else if (arguments.picture.exr)
            throw geometry::InputError("--exr", "", "goes into a folder of pictures, not into a film");
    }

    fs::path picture(size_t view, size_t frame, const char* extension) const {
        const std::string name = views_.size() == 1
                                     ? fmt::format("{:05}{}", frame, extension)
                                     : fmt::format("{}-{:05}{}", views_[view], frame, extension);
        return arguments_.output / name;
    }

    // Pictures appear whole or not at all, so one that is there is done.
    bool done(size_t frame) const {
        if (!arguments_.resume) return false;
        for (size_t v = 0; v < views_.size(); ++v)
            if (!fs::exists(picture(v, frame, ".png")) ||
                (arguments_.picture.exr && !fs::exists(picture(v, frame, ".exr"))))
                return false;
        return true;
    }

    void add(size_t view, size_t frame, passes::Image8&& image) {
        if (!asFilm_) {
            passes::writePng(image, picture(view, frame, ".png"));
            return;
        }
        while (films_.size() <= view) {
            fs::path file = arguments_.output;
            if (views_.size() > 1)
                file.replace_filename(fmt::format("{}-{}.mp4", file.stem().string(), views_[films_.size()]));
            films_.push_back(std::make_unique<Film>(file, static_cast<uint32_t>(image.width),
                                                    static_cast<uint32_t>(image.height),
                                                    arguments_.framesPerSecond));
        }
        films_[view]->add(std::move(image.rgb));
    }

    void close() {
        for (auto& film : films_) film->close();
    }

private:
    const TimelapseArguments& arguments_;
    std::vector<std::string> views_;
    bool asFilm_;
    std::vector<std::unique_ptr<Film>> films_;
};

// One exposure for the whole film: the brightest that one of a few moments spread over it asks for.
double whiteForAll(Run& run, const SkySource& source, const std::vector<daylight::Moment>& times,
                   compute::DaylightTransport& transport, const passes::FrameRenderer& renderer) {
    constexpr size_t kSamples = 5;
    std::vector<daylight::Sky> skies;
    for (size_t k = 0; k < std::min(kSamples, times.size()); ++k)
        skies.push_back(source.skyAt(
            times[k * (times.size() - 1) / std::max<size_t>(1, std::min(kSamples, times.size()) - 1)]));
    double white = 0;
    for (const compute::Moment& moment : solveLight(run, transport, skies))
        white = std::max(white, renderer.autoWhite(moment.lighting));
    return white;
}

std::string tableRow(const daylight::Moment& time, const daylight::SunPosition& sun,
                     const LightFigures& figures) {
    return fmt::format("{},{:.3f},{:.3f},{:.2f},{:.2f},{:.3f}\n", daylight::formatTime(time), sun.azimuthDeg,
                       sun.altitudeDeg, figures.meanLux, figures.maxLux, figures.glareRatio);
}

} // namespace

void execute(Run& run, const TimelapseArguments& arguments) {
    const daylight::Moment from = daylight::parseTime(arguments.from, "--from"),
                           to = daylight::parseTime(arguments.to, "--to");
    const std::vector<daylight::Moment> times = daylight::timeSeries(
        from, to, daylight::parseDuration(arguments.step, "--step"), "--from, --to, --step");
    const Scene scene = loadScene(run, arguments.scene);
    const bool projectors = arguments.view.empty() ? scene.rig.has_value() : arguments.view == "projectors";
    if (projectors && !scene.rig)
        throw geometry::InputError("--view", "", "projectors need a rig, expected --rig RIG.json");
    MomentArguments moment = arguments.moment;
    moment.time = arguments.from;
    const SkySource source(run, moment, scene);

    std::vector<std::string> views;
    if (projectors)
        for (size_t p = 0; p < scene.rig->projectors.size(); ++p)
            views.push_back(fmt::format("projector-{}", p));
    else
        views.push_back("preview");
    FrameSink sink(arguments, views);

    const auto transport = makeTransport(run, scene.mesh);
    passes::FrameRenderer renderer = makeRenderer(run, scene);
    passes::PreviewOptions preview;
    passes::ProjectorOptions projector;
    preview.tone = toned(preview.tone, arguments.picture, arguments.picture.falseColor);
    projector.tone = toned(projector.tone, arguments.picture, arguments.picture.falseColor);
    if (!preview.tone.whiteLux) preview.tone.whiteLux = whiteForAll(run, source, times, *transport, renderer);
    projector.tone.whiteLux = preview.tone.whiteLux;

    const InterruptGuard guard;
    Progress progress("frames", times.size(), run.showsProgress());
    std::string table = "time,sun_azimuth_deg,sun_altitude_deg,mean_lux,max_lux,glare_ratio\n";
    size_t drawn = 0;
    for (size_t first = 0; first < times.size(); first += kSolvedTogether) {
        const size_t count = std::min(kSolvedTogether, times.size() - first);
        std::vector<daylight::Sky> skies;
        for (size_t k = 0; k < count; ++k) skies.push_back(source.skyAt(times[first + k]));
        const std::vector<compute::Moment> moments = solveLight(run, *transport, skies);
        for (size_t k = 0; k < count; ++k) {
            const size_t frame = first + k;
            table += tableRow(times[frame], source.sunAt(times[frame]), lightFigures(scene.mesh, moments[k]));
            progress.advance(frame + 1);
            if (sink.done(frame)) continue;
            const StageTimer timer(run, "render");
            const compute::Lighting& light = moments[k].lighting;
            if (projectors) {
                std::vector<passes::Image8> pictures = renderer.projectors(light, projector);
                for (size_t v = 0; v < pictures.size(); ++v) sink.add(v, frame, std::move(pictures[v]));
            } else {
                sink.add(0, frame, renderer.preview(light, preview));
            }
            if (arguments.picture.exr) {
                const std::vector<passes::ImageF> linear =
                    projectors ? renderer.projectorsHdr(light, projector)
                               : std::vector{renderer.previewHdr(light, preview)};
                for (size_t v = 0; v < linear.size(); ++v)
                    passes::writeExr(linear[v], sink.picture(v, frame, ".exr"));
            }
            ++drawn;
            if (interrupted)
                throw std::runtime_error(
                    fmt::format("interrupted after frame {} of {}", frame + 1, times.size()));
        }
    }
    {
        const StageTimer timer(run, "encode");
        sink.close();
    }
    fs::path tableFile = arguments.output / "frames.csv";
    if (arguments.output.extension() == ".mp4")
        tableFile = fs::path(arguments.output).replace_extension(".csv");
    geometry::writeWholeText(tableFile, table);
    run.report()["frames"] = {
        {"count", times.size()}, {"drawn", drawn}, {"white_lux", *preview.tone.whiteLux}};
}

} // namespace heliodon::app
