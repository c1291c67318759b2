#include <algorithm>
#include <exception>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/resource.h>

#include "compute/stopwatch.h"
#include "engine/app/commands.h"
#include "engine/app/finite_light.h"
#include "engine/app/frame_sink.h"
#include "engine/app/light_report.h"
#include "engine/app/moment.h"
#include "engine/app/output_folder.h"
#include "engine/app/pictures.h"
#include "engine/app/progress.h"
#include "engine/app/projector_reach.h"
#include "engine/app/scene_input.h"
#include "engine/app/sky_tint.h"
#include "engine/app/stamp.h"
#include "geometry/input_error.h"

namespace heliodon::app {

namespace {

constexpr size_t kSolvedTogether = 8; // moments that share passes over the form factors
constexpr size_t kSolvedAhead = 16;   // moments that may wait to be drawn
// Moments that are solved from what was found before, and so give the same bits only with those before them:
// a series that is resumed begins at the first of such a chapter. A multiple of kSolvedTogether.
constexpr size_t kChapter = 128;

using Solved = std::shared_ptr<const compute::Moment>; // the frame before's where its light is the same

// Solves moments in a thread of its own, ahead of whoever draws them.
class MomentStream {
public:
    // From the chapter of moment `from` on. `painted`: of whose projectors' pictures scatter is left out,
    // white being `whiteLux`; null: of none.
    MomentStream(const SkySource& source, const std::vector<daylight::Moment>& times, size_t from,
                 compute::DaylightTransport& transport, bool tinted, const passes::PaintedPatches* painted,
                 double whiteLux)
        : source_(source), times_(times), first_(from / kChapter * kChapter), transport_(transport),
          tinted_(tinted), painted_(painted), whiteLux_(whiteLux), thread_([this] { run(); }) {}
    ~MomentStream() { stop(); }
    MomentStream(const MomentStream&) = delete;
    MomentStream& operator=(const MomentStream&) = delete;

    size_t first() const { return first_; }
    // Of the next frame. Throws what the thread threw.
    Solved next() {
        std::optional<Solved> solved = queue_.pop();
        if (solved) return *solved;
        stop();
        if (failure_) std::rethrow_exception(failure_);
        throw std::logic_error("more frames asked for than there are");
    }
    void stop() {
        queue_.close();
        if (thread_.joinable()) thread_.join();
    }
    // After stop().
    double seconds() const { return seconds_; }
    size_t repeated() const { return repeated_; }
    const std::optional<passes::ScatterReport>& worstScatter() const { return worstScatter_; }

private:
    void run() {
        try {
            for (size_t first = first_; first < times_.size(); first += kSolvedTogether)
                if (!solve(first, std::min(kSolvedTogether, times_.size() - first))) break;
        } catch (...) {
            failure_ = std::current_exception();
        }
        queue_.close();
    }

    bool solve(size_t first, size_t count) {
        const compute::Stopwatch watch;
        if (first % kChapter == 0) {
            transport_.forgetLights();
            before_.reset();
        }
        std::vector<daylight::Sky> skies;
        std::vector<bool> fresh;
        for (size_t k = 0; k < count; ++k) {
            const daylight::Sky sky = source_.skyAt(times_[first + k]);
            fresh.push_back(!before_ || !sameLight(*before_, sky));
            if (fresh.back()) skies.push_back(sky);
            before_ = sky;
        }
        std::vector<compute::Moment> moments = transport_.light(skies);
        for (const compute::Moment& moment : moments) expectFinite(moment);
        if (tinted_) tintLight(transport_, skies, moments);
        for (compute::Moment& moment : moments) leaveOutScatter(moment.lighting);
        seconds_ += watch.seconds();
        size_t next = 0;
        for (size_t k = 0; k < count; ++k) {
            if (fresh[k])
                last_ = std::make_shared<compute::Moment>(std::move(moments[next++]));
            else
                ++repeated_;
            if (!queue_.push(last_)) return false;
        }
        return true;
    }

    void leaveOutScatter(compute::Lighting& light) {
        if (!painted_) return;
        const passes::ScatterReport scatter = passes::leaveOutScatter(
            transport_.mesh(), *painted_, whiteLux_, transport_.parts().gather, false, light);
        if (!worstScatter_ || scatter.error > worstScatter_->error) worstScatter_ = scatter;
    }

    const SkySource& source_;
    const std::vector<daylight::Moment>& times_;
    size_t first_;
    compute::DaylightTransport& transport_;
    bool tinted_;
    const passes::PaintedPatches* painted_;
    double whiteLux_;
    std::optional<passes::ScatterReport> worstScatter_; // of moments
    BoundedQueue<Solved> queue_{kSolvedAhead};
    std::optional<daylight::Sky> before_;
    Solved last_;
    std::exception_ptr failure_;
    double seconds_ = 0;
    size_t repeated_ = 0;
    std::thread thread_; // last: it uses all of the above
};

// Skies of a few moments spread over the film, and of the one that is brightest outside.
std::vector<daylight::Sky> brightAndSpread(const SkySource& source,
                                           const std::vector<daylight::Moment>& times) {
    constexpr size_t kSpread = 7;
    std::vector<daylight::Sky> skies;
    const size_t count = std::min(kSpread, times.size());
    for (size_t k = 0; k < count; ++k)
        skies.push_back(source.skyAt(times[k * (times.size() - 1) / std::max<size_t>(1, count - 1)]));
    constexpr size_t kLooked = 2000;
    const size_t stride = (times.size() + kLooked - 1) / kLooked;
    std::pair<double, size_t> brightest{-1, 0};
    for (size_t k = 0; k < times.size(); k += stride)
        brightest = std::max(brightest, {daylight::globalHorizontalIlluminance(source.skyAt(times[k])), k});
    skies.push_back(source.skyAt(times[brightest.second]));
    return skies;
}

// What is drawn of each frame.
class FramePainter {
public:
    FramePainter(Run& run, const Scene& scene, const TimelapseArguments& arguments, bool projectors)
        : run_(run), projectors_(projectors), exr_(arguments.picture.exr), stamp_(arguments.stamp),
          device_(run.anotherDevice()), renderer_(makeRenderer(run, scene, device_.get())),
          preview_(sized({}, arguments.picture)) {
        preview_.tone = toned(preview_.tone, arguments.picture, arguments.picture.falseColor);
        projector_.tone = toned(projector_.tone, arguments.picture, arguments.picture.falseColor);
    }

    // One exposure and one false-colour scale for the whole film: the brightest exposure that one of a few of
    // its moments asks for, and a scale that holds their light.
    double settleTone(const SkySource& source, const std::vector<daylight::Moment>& times,
                      compute::DaylightTransport& transport) {
        passes::Tone& tone = preview_.tone;
        const bool falseColour = tone.map == passes::ToneMap::falseColour;
        if (!tone.whiteLux || falseColour) {
            const std::vector<compute::Moment> samples =
                solveLights(run_, transport, brightAndSpread(source, times));
            settle(tone, renderer_, samples);
        }
        projector_.tone.whiteLux = tone.whiteLux;
        projector_.tone.lowLux = tone.lowLux, projector_.tone.highLux = tone.highLux;
        return *tone.whiteLux;
    }

    const passes::FrameScene& scene() const { return renderer_.scene(); }

    // Frames of the same light are drawn once.
    void paint(size_t frame, const Solved& solved, const SkySource& source, const daylight::Moment& time,
               FrameSink& sink) {
        if (solved != drawn_) {
            const StageTimer timer(run_, "render");
            drawn_ = solved;
            const compute::Lighting& light = solved->lighting;
            if (projectors_ && exr_) {
                passes::ProjectorPictures both = renderer_.projectorsBoth(light, projector_);
                pictures_ = std::move(both.bytes), linear_ = std::move(both.floats);
            } else if (projectors_) {
                pictures_ = renderer_.projectors(light, projector_);
            } else {
                pictures_ = {renderer_.preview(light, preview_)};
                if (exr_) linear_ = {renderer_.previewHdr(light, preview_)};
            }
        }
        const StageTimer timer(run_, "hand_over"); // long where the encoder is slower than everything else
        std::vector<passes::Image8> pictures = pictures_;
        const double white = *preview_.tone.whiteLux;
        if (!projectors_ && stamp_)
            drawStamp(pictures[0],
                      stampOf(source, time, preview_.tone.map == passes::ToneMap::falseColour ? 0 : white));
        sink.add(frame, std::move(pictures), linear_,
                 !exr_         ? passes::ExrAttributes{}
                 : projectors_ ? projectorAttributes(source, time, white)
                               : previewAttributes(source, time, white));
    }

private:
    Run& run_;
    bool projectors_, exr_, stamp_;
    std::unique_ptr<gpu::Device> device_;
    passes::FrameRenderer renderer_;
    passes::PreviewOptions preview_;
    passes::ProjectorOptions projector_;
    Solved drawn_;
    std::vector<passes::Image8> pictures_;
    std::vector<passes::ImageF> linear_;
};

// Steadiness of a long run, from each frame's time.
nlohmann::json frameTimes(std::vector<float> milliseconds) {
    if (milliseconds.empty()) return {};
    const auto rank = [](std::vector<float> values, double share) {
        const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
        std::nth_element(values.begin(), values.begin() + at, values.end());
        return values[static_cast<size_t>(at)];
    };
    const auto quarter = static_cast<std::ptrdiff_t>((milliseconds.size() + 3) / 4);
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return {{"median_ms", rank(milliseconds, 0.5)},
            {"p99_ms", rank(milliseconds, 0.99)},
            {"first_quarter_median_ms", rank({milliseconds.begin(), milliseconds.begin() + quarter}, 0.5)},
            {"last_quarter_median_ms", rank({milliseconds.end() - quarter, milliseconds.end()}, 0.5)},
            {"peak_memory_bytes", 1024 * static_cast<int64_t>(usage.ru_maxrss)}};
}

constexpr const char* kTableHeader = "time,sun_azimuth_deg,sun_altitude_deg,mean_lux,max_lux,glare_ratio\n";

// `sun`: null where the sky does not follow time.
std::string tableRow(const daylight::Moment& time, const daylight::SunPosition* sun,
                     const LightFigures& figures) {
    const std::string place = sun ? fmt::format("{:.3f},{:.3f}", sun->azimuthDeg, sun->altitudeDeg) : ",";
    return fmt::format("{},{},{:.2f},{:.2f},{:.3f}\n", daylight::formatTime(time), place, figures.meanLux,
                       figures.maxLux, figures.glareRatio);
}

std::vector<std::string> viewsOf(Run& run, const TimelapseArguments& arguments, const Scene& scene) {
    const bool projectors = scene.rig && !scene.rig->projectors.empty();
    const std::string view =
        !arguments.view.empty() ? arguments.view : (projectors ? "projectors" : "preview");
    if (view == "none") {
        if (arguments.output.extension() == ".mp4")
            throw geometry::InputError("--view", "", "none draws nothing, expected a folder for frames.csv");
        return {};
    }
    if (view == "preview") {
        if (scene.rig && arguments.view.empty()) warnOfNoProjectors(run, arguments.scene.rig);
        return {"preview"};
    }
    if (!scene.rig)
        throw geometry::InputError("--view", "", "projectors need a rig, expected --rig RIG.json");
    if (!projectors)
        throw geometry::InputError(arguments.scene.rig.string(), "projectors",
                                   "there is none to show anything on");
    std::vector<std::string> views;
    for (size_t p = 0; p < scene.rig->projectors.size(); ++p) views.push_back(fmt::format("projector-{}", p));
    return views;
}

// H.264 as players know it holds even numbers of pixels.
void refuseOddFilm(const TimelapseArguments& arguments) {
    if (arguments.output.extension() != ".mp4" || arguments.picture.size.empty()) return;
    const passes::PreviewOptions options = sized({}, arguments.picture);
    if (options.width % 2 != 0 || options.height % 2 != 0)
        throw geometry::InputError("--size", arguments.picture.size,
                                   "is odd, expected even numbers of pixels for a film");
}

// Options of pictures that are not made.
void warnOfUnused(Run& run, const TimelapseArguments& arguments, const std::vector<std::string>& views) {
    const bool preview = !views.empty() && views[0] == "preview", projectors = !views.empty() && !preview;
    const auto warn = [&](bool unused, const char* option, const char* why) {
        if (unused) run.warn(fmt::format("{} is not used: {}", option, why));
    };
    warn(arguments.output.extension() != ".mp4" &&
             arguments.framesPerSecond != TimelapseArguments{}.framesPerSecond,
         "--fps", "it is for films (-o FILM.mp4)");
    warn(projectors && !arguments.picture.size.empty(), "--size",
         "it is for previews, pictures of projectors have the rig's sizes");
    warn(preview && arguments.picture.compensateScatter, "--compensate-scatter",
         "it is for pictures of projectors");
    if (!views.empty()) return;
    constexpr const char* kNone = "--view none draws nothing";
    const PictureArguments& picture = arguments.picture;
    warn(picture.exr, "--exr", kNone);
    warn(picture.falseColor, "--false-color", kNone);
    warn(picture.skyColour, "--sky-color", kNone);
    warn(picture.exposure.has_value(), "--exposure", kNone);
    warn(!picture.size.empty(), "--size", kNone);
    warn(picture.compensateScatter, "--compensate-scatter", kNone);
}

// What is not under the name that was given.
void noteFilms(Run& run, const Scene& scene, const FrameSink& sink, const std::vector<std::string>& views) {
    const std::vector<std::filesystem::path> films = sink.films();
    if (films.size() > 1) {
        std::vector<std::string> names;
        for (const std::filesystem::path& film : films) names.push_back(film.string());
        run.note(fmt::format("one film a projector: {}", fmt::join(names, ", ")));
    }
    if (films.empty() || views[0] == "preview") return;
    for (const geometry::Projector& p : scene.rig->projectors)
        if (p.width % 2 != 0 || p.height % 2 != 0)
            run.warn(
                fmt::format("projector '{}' has {} x {} pixels, its film {} x {}: films have even numbers",
                            p.id, p.width, p.height, p.width + p.width % 2, p.height + p.height % 2));
}

struct Frames {
    size_t drawn = 0, dark = 0;
    size_t night = 0;                // of the dark ones: the sun is down
    std::vector<float> milliseconds; // of each that was not kept
};

// Takes each moment's light that was not kept, draws what the sink has not yet and hands it on. `painter`:
// null where nothing is drawn.
Frames makeFrames(Run& run, const Scene& scene, const SkySource& source,
                  const std::vector<daylight::Moment>& times, MomentStream& stream, FramePainter* painter,
                  FrameSink& sink) {
    Frames frames;
    Progress progress("frames", times.size(), run.showsProgress());
    Solved before;
    LightFigures figures;
    FrameTally tally;
    for (size_t frame = stream.first(); frame < times.size(); ++frame) {
        const compute::Stopwatch watch;
        const Solved solved = stream.next();
        if (frame < sink.kept()) continue;
        if (solved != before) figures = lightFigures(scene.mesh, *solved);
        before = solved;
        tally.add(solved->report);
        const daylight::SunPosition sun = source.sunAt(times[frame]);
        if (source.followsTime() && figures.maxLux <= 0) ++frames.dark, frames.night += !sun.isUp();
        if (painter && !sink.done(frame)) {
            painter->paint(frame, solved, source, times[frame], sink);
            ++frames.drawn;
        }
        sink.addRow(tableRow(times[frame], source.followsTime() ? &sun : nullptr, figures));
        progress.advance(frame + 1);
        frames.milliseconds.push_back(static_cast<float>(1e3 * watch.seconds()));
    }
    stream.stop();
    run.addStageSeconds("solve", stream.seconds());
    tally.report(run, scene.worldPerBuilding);
    if (stream.repeated() > 0)
        run.skipped(fmt::format("{} frames: the same light as the frame before", stream.repeated()));
    return frames;
}

std::string whyDark(const Scene& scene, const Frames& frames) {
    if (!mayBeLit(scene.mesh)) return "no window leads outside and nothing emits light";
    if (frames.night == frames.dark) return "the sun is below the horizon";
    const std::string other = "the sun is up and the sky without light";
    return frames.night == 0 ? other
                             : fmt::format("the sun is below the horizon, but in {} of them {}",
                                           frames.dark - frames.night, other);
}

void reportFrames(Run& run, const Scene& scene, const Frames& frames, size_t kept, double white) {
    const size_t count = frames.milliseconds.size();
    run.report()["frames"] = frameTimes(frames.milliseconds);
    run.report()["frames"].update({{"count", kept + count},
                                   {"kept", kept},
                                   {"drawn", frames.drawn},
                                   {"dark", frames.dark},
                                   {"white_lux", white}});
    if (kept > 0) run.skipped(fmt::format("{} frames: --resume, an earlier run has made them", kept));
    if (frames.dark > 0)
        run.note(fmt::format("{} of {} frames are dark: {}", frames.dark, count, whyDark(scene, frames)));
}

} // namespace

void execute(Run& run, const TimelapseArguments& arguments) {
    const daylight::Moment from = daylight::parseTime(arguments.from, "--from"),
                           to = daylight::parseTime(arguments.to, "--to");
    const std::vector<daylight::Moment> times = daylight::timeSeries(
        from, to, daylight::parseDuration(arguments.step, "--step"), "--from, --to, --step");
    refuseOddFilm(arguments);
    checkSize(run, arguments.picture); // now, not after the form factors
    const Scene scene = loadScene(run, arguments.scene);
    MomentArguments moment = arguments.moment;
    moment.time = arguments.from;
    const SkySource source(run, moment, scene);
    const std::vector<std::string> views = viewsOf(run, arguments, scene);
    warnOfUnused(run, arguments, views);
    FrameJob job = frameJobOf(run, arguments, scene, views, times.size());
    FrameSink sink({arguments.output, arguments.framesPerSecond, arguments.picture.exr, arguments.resume,
                    std::move(job), kTableHeader});
    run.willWrite([&](const std::filesystem::path& place) { return sink.writes(place); });
    if (sink.complete()) {
        run.note(fmt::format("{}: an earlier run has made all of it", arguments.output.string()));
        run.skipped("everything: --resume, and an earlier run has made all of it");
        run.report()["frames"] = {{"count", times.size()}, {"kept", times.size()}, {"drawn", 0}};
        return;
    }
    noteFilms(run, scene, sink, views);
    warnOfStrangers(run, arguments.output, sink.strangers());

    const auto transport = makeTransport(run, scene.mesh, {.forPictures = !views.empty()});
    std::optional<FramePainter> painter;
    double white = 0;
    if (!views.empty()) {
        const bool projectors = views[0] != "preview";
        if (projectors) reportReach(run, scene);
        painter.emplace(run, scene, arguments, projectors);
        white = painter->settleTone(source, times, *transport);
    } else {
        run.skipped("pictures: --view none");
    }

    const bool scatter = arguments.picture.compensateScatter && painter && views[0] != "preview";
    MomentStream stream(source, times, sink.kept(), *transport, arguments.picture.skyColour,
                        scatter ? &painter->scene().painted : nullptr, white);
    const Frames frames = makeFrames(run, scene, source, times, stream, painter ? &*painter : nullptr, sink);
    {
        const StageTimer timer(run, "encode"); // what is left of it
        sink.close();
    }
    reportFrames(run, scene, frames, sink.kept(), white);
    if (stream.worstScatter())
        run.report()["scatter"] = scatterEntry(*stream.worstScatter(), scene.rig->surfaceReflectance);
}

} // namespace heliodon::app
