#include <algorithm>
#include <thread>

#include <fmt/format.h>

#include "compute/gpu/error.h"
#include "compute/gpu/image.h"
#include "engine/app/blinds.h"
#include "engine/app/commands.h"
#include "engine/app/file_watch.h"
#include "engine/app/interrupt.h"
#include "engine/app/live_controls.h"
#include "engine/app/live_outputs.h"
#include "engine/app/live_script.h"
#include "engine/app/live_status.h"
#include "engine/app/output_folder.h"
#include "engine/app/pictures.h"
#include "engine/app/projector_displays.h"
#include "geometry/input_error.h"
#include "geometry/whole_file.h"
#include "vision/camera.h"

namespace heliodon::app {

namespace {

constexpr double kOperatorBusy = 1.0 / 30, kOperatorIdle = 0.25; // seconds from one drawing to the next

constexpr double kIdleWait = 0.02; // seconds that events are waited for

constexpr const char* kLastSnapshot = "end";

// Events, light and windows, in the thread that the window system wants: nothing here takes longer than
// drawing does.
class LiveSession {
public:
    LiveSession(Run& run, const LiveArguments& arguments)
        : run_(run), arguments_(arguments), rigFile_(arguments.scene.rig), rig_(rigOf(run, arguments)),
          source_(run, arguments.moment, sceneOfRig()), controls_(source_, arguments),
          script_(scriptOf(arguments)), outputs_(std::in_place, run, rig_, arguments), slots_(run),
          light_(board_, present::wakeUp, [this] { makeSceneAgain(); }),
          maker_(arguments.scene, rig_, slots_, board_, tables_,
                 [this](SceneChange change) { light_.change(std::move(change)); }),
          table_(rig_, arguments.camera, cameraOptions(), board_, tables_) {
        run.noteAssumed();
        run.note(fmt::format("showing {}; Esc or Q in a window, or Ctrl-C here, ends", outputs_->inWords()));
    }

    void show() {
        while (ended_.empty()) {
            throwIfInterrupted();
            board_.rethrow();
            try {
                turn();
            } catch (const gpu::Error& error) {
                openOutputsAgain(error);
            }
        }
        if (!arguments_.snapshots.empty()) snapshot(kLastSnapshot);
    }

    void end(const std::string& why) {
        if (ended_.empty()) ended_ = why;
    }

    void report() {
        say();
        if (step_ < script_.size())
            run_.warn(fmt::format("{}: ended with {} of its {} steps not done{}", arguments_.script.string(),
                                  script_.size() - step_, script_.size(),
                                  ended_.empty() ? "" : ": " + ended_));
        const LiveStatus status = board_.read();
        nlohmann::json& report = run_.report();
        report["live"] = reportOf(status, figures_);
        report["live"]["ended"] = ended_;
        report["live"]["seconds"] = secondsSince(started_);
        report["live"]["moments_solved"] = light_.solved();
        report["live"]["moments_repeated"] = light_.repeated();
        report["live"]["done_again"] = rows_;
        report["live"]["outputs"] = outputs_ ? outputs_->report() : nlohmann::json::array();
        report["table"] = status.scene;
        // Of the latest sketch and the latest drawing.
        report["stages"] = status.scene.value("stages", nlohmann::json::object());
        report["stages"]["detect"] = status.detectSeconds;
        report["stages"]["solve"] = figures_.solve.last();
        report["stages"]["render"] = figures_.draw.last();
        if (lit_) {
            reportMoment(run_, lit_->moment->report, sceneOfRig().worldPerBuilding);
            report["light"] = reportOf(*lit_, controls_.tone());
            if (lit_->scatter) report["scatter"] = scatterEntry(*lit_->scatter, rig_.surfaceReflectance);
        }
    }

private:
    static void warnOfUnused(Run& run, const LiveArguments& arguments) {
        if (arguments.windowed && !arguments.displays.empty())
            run.warn("--display is not used: --windowed opens ordinary windows");
        if (arguments.camera.starts_with("replay:")) return;
        if (arguments.loop) run.warn("--loop is not used: it is for --camera replay:FOLDER");
        if (arguments.interval != LiveArguments{}.interval)
            run.warn("--interval is not used: it is for --camera replay:FOLDER");
    }
    static geometry::Rig rigOf(Run& run, const LiveArguments& arguments) {
        warnOfUnused(run, arguments);
        geometry::Rig rig = loadRig(run, arguments.scene.rig);
        assignDisplays(rig, arguments.displays);
        return rig;
    }
    Scene sceneOfRig() const {
        Scene scene;
        scene.rig = rig_;
        return scene;
    }
    vision::CameraOptions cameraOptions() const {
        return {rig_.camera.width, rig_.camera.height, arguments_.interval, arguments_.loop};
    }
    std::vector<ScriptStep> scriptOf(const LiveArguments& arguments) {
        for (const std::string& state : arguments.scene.blinds) parseWindowState(state);
        source_.skyAt(source_.moment()); // a sky that is none is said now
        std::vector<ScriptStep> steps;
        if (!arguments.script.empty())
            steps = readScript(arguments.script, rig_.projectors.size() + 1, source_.weather() != nullptr);
        std::vector<std::string> names = LiveOutputs::snapshotFiles(rig_, kLastSnapshot);
        for (const ScriptStep& step : steps) {
            const auto* shot = std::get_if<SnapshotStep>(&step);
            if (!shot) continue;
            if (arguments.snapshots.empty())
                throw geometry::InputError("--snapshots", "",
                                           "the script takes some, expected a folder for them");
            for (std::string& name : LiveOutputs::snapshotFiles(rig_, shot->name))
                names.push_back(std::move(name));
        }
        if (!arguments.snapshots.empty()) {
            if (arguments.camera.starts_with("replay:") &&
                geometry::isSamePlace(arguments.camera.substr(7), arguments.snapshots))
                throw geometry::InputError("--snapshots", arguments.snapshots.string(),
                                           "is the folder that the camera's pictures are read from, expected "
                                           "another");
            run_.willWrite(arguments.snapshots, names);
            snapshots_.emplace(arguments.snapshots);
        }
        return steps;
    }

    void turn() {
        const bool hurried =
            operatorDue(kOperatorBusy) && (controls_.values.playing || outputs_->operatorBusy());
        // A step for each drawing, so that no core solves what nobody sees; where the light stays as it is,
        // as in the night, nothing is drawn, and steps are as far apart as looks for events.
        if (!sameLight_ || secondsSince(taken_) >= kIdleWait) controls_.play();
        const bool events = listen(dirty_ || hurried || scriptReady() ? 0 : kIdleWait);
        if (!outputs_->wanted()) {
            outputs_->refuseLoss();
            end(outputs_->whyNotWanted());
        }
        if (arguments_.duration > 0 && secondsSince(started_) > arguments_.duration)
            end("--duration is over");
        runScript();
        take();
        draw(events);
        say();
    }

    // The windows show the latest; who runs without them reads it here.
    void say() {
        if (rigFile_.changes())
            run_.warn(
                fmt::format("{}: has been changed; what is shown is still by what it was when live began, "
                            "which has to be started again",
                            arguments_.scene.rig.string()));
        for (const auto& [warning, text, each] : board_.takeUnsaid())
            if (!warning)
                run_.note(text);
            else if (each)
                run_.warnAgain(text);
            else
                run_.warn(text);
    }

    // What the user did, and the light that follows from it, asked for at once. True if there was anything.
    bool listen(double waitSeconds) {
        const auto events = outputs_->pollEvents(waitSeconds);
        for (const present::Event& event : events) handle(event);
        ask();
        return !events.empty();
    }

    void handle(const present::Event& event) {
        const LiveControls::Effect effect = controls_.handle(event);
        if (effect == LiveControls::Effect::quit) end("a key was pressed that quits");
        if (effect == LiveControls::Effect::fullScreen) outputs_->toggleFullScreen(event.window);
    }

    // Asks for light whenever what decides it is not what it was; the latest wins.
    void ask() {
        if (!controls_.lightChanged()) return;
        LightRequest request = controls_.request();
        request.asked = LiveClock::now();
        light_.ask(std::move(request));
    }

    void take() {
        std::optional<LitScene> ready = light_.take();
        if (!ready) return;
        const std::unique_ptr<passes::FrameScene> frame = std::move(ready->frame);
        const bool same = lit_ && ready->moment == lit_->moment && !ready->fromPicture;
        if (ready->fromPicture) noteRow(ready->scene->row);
        lit_ = std::move(*ready);
        if (frame) outputs_->replaceScene(std::move(*frame));
        taken_ = LiveClock::now();
        sameLight_ = same;
        if (same) return;
        dirty_ = fresh_ = true;
        figures_.solve.add(lit_->solveSeconds);
    }

    void noteRow(const std::string& row) {
        constexpr size_t kMostRows = 1000;
        if (rows_.size() == kMostRows) rows_.erase(rows_.begin());
        rows_.push_back(row);
    }

    // The windows' device has failed: another one, other windows, the same light. Goes on throwing where that
    // does not help. A driver that has just been reset may need a moment.
    void openOutputsAgain(const gpu::Error& error) {
        constexpr size_t kMostLosses = 5;
        constexpr double kWithin = 60; // seconds
        constexpr int kAttempts = 5;
        std::erase_if(outputLosses_, [](LiveClock::time_point t) { return secondsSince(t) > kWithin; });
        outputLosses_.push_back(LiveClock::now());
        if (outputLosses_.size() > kMostLosses) throw;
        board_.update([](LiveStatus& status) { ++status.deviceLosses; });
        run_.warn(fmt::format("{}: the windows are opened again", error.what()));
        const LiveOutputs::Arrangement arrangement = outputs_->arrangement();
        for (int attempt = 1;; ++attempt) {
            throwIfInterrupted();
            try {
                outputs_.reset();
                outputs_.emplace(run_, rig_, arguments_);
                outputs_->arrange(arrangement);
                if (lit_)
                    outputs_->replaceScene({lit_->scene->scene.mesh, lit_->scene->scene.occluders, &rig_});
                dirty_ = true;
                return;
            } catch (const gpu::Error&) {
                if (attempt == kAttempts) throw;
            }
            std::this_thread::sleep_for(std::chrono::seconds(1));
        }
    }

    // Called by the light's thread: its device has failed.
    void makeSceneAgain() {
        board_.begin();
        if (!tables_.again()) board_.end();
    }

    bool operatorDue(double after) const { return secondsSince(operatorDrawn_) > after; }

    void draw(bool events) {
        if (controls_.pictureChanged()) dirty_ = true;
        if (outputs_->leaveOutClosed()) {
            dirty_ = true;
            if (lit_ && lit_->scatter) light_.repaint(lit_->frameNumber, outputs_->painted());
        }
        const bool operatorNow =
            (operatorDue(kOperatorBusy) &&
             (events || dirty_ || controls_.values.playing || outputs_->operatorBusy())) ||
            operatorDue(kOperatorIdle);
        if (!dirty_ && !operatorNow && !outputs_->damaged()) return;
        const compute::Stopwatch watch;
        const bool projectors = dirty_;
        if (dirty_) {
            if (lit_) outputs_->drawLight(lit_->moment->lighting, controls_.tone());
            // A software device takes its time: the next moment is solved meanwhile.
            while (!outputs_->drawn()) {
                throwIfInterrupted();
                listen(0.002);
            }
            outputs_->choose(controls_.values.shown, lit_.has_value());
            if (lit_ && controls_.values.shown == present::Shown::light) table_.lightChanged();
            dirty_ = false;
        }
        if (operatorNow) {
            present::OperatorActions actions;
            outputs_->drawOperator(controls_.values, status(), actions);
            operatorDrawn_ = LiveClock::now();
            if (actions.quit) end("quit was chosen in the operator's window");
            for (size_t output : actions.toggleFullScreen) outputs_->toggleFullScreen(output);
        }
        outputs_->present(projectors, operatorNow);
        if (projectors) count(watch.seconds());
    }

    // A state is on all outputs.
    void count(double seconds) {
        figures_.draw.add(seconds);
        figures_.frameShown();
        if (!fresh_ || !lit_) return;
        fresh_ = false;
        if (lit_->fromPicture)
            figures_.photoToLight.add(secondsSince(lit_->scene->taken));
        else
            figures_.wheelToLight.add(secondsSince(lit_->asked));
        lit_->fromPicture = false;
    }

    present::OperatorStatus status() {
        const LiveStatus now = board_.read();
        present::OperatorStatus status;
        controls_.describe(status);
        status.camera = now.camera;
        status.cameraFails = now.cameraFails;
        status.working = now.tableMoves        ? "waiting until the table is still"
                         : now.working.empty() ? ""
                                               : now.working + " ...";
        status.refused = now.pictureRefused.empty() ? now.refused : now.pictureRefused;
        status.warnings = now.detectWarnings;
        if (!now.lightRefused.empty()) status.warnings.push_back(now.lightRefused);
        for (const auto& warning : now.scene.value("warnings", nlohmann::json::array()))
            status.warnings.push_back(warning.get<std::string>());
        status.facts = factsOf(now, lit_ ? &*lit_ : nullptr, figures_);
        status.outlines = outlinesOf(now.seen, rig_);
        status.cameraPicture = outputs_->cameraPicture(now.photo);
        if (lit_) {
            const passes::Tone tone = controls_.tone();
            status.whiteLux = tone.whiteLux.value_or(lit_->autoWhite);
            if (controls_.values.falseColour) status.scale = passes::falseScale(tone, lit_->shownLux);
        }
        return status;
    }

    // ---- Scripts ----

    bool settled() const {
        return board_.idle() && !light_.hasReady() && !dirty_ && !controls_.lightChanged();
    }

    bool scriptReady() const {
        if (step_ >= script_.size() || LiveClock::now() < sleepUntil_) return false;
        if (const auto* look = std::get_if<LookStep>(&script_[step_]))
            return board_.looks() >= look->times && settled();
        return !std::holds_alternative<WaitStep>(script_[step_]) || settled();
    }

    // What a script waits for must be able to come.
    void refuseLookAfterTheEnd() const {
        const auto* look = step_ < script_.size() ? std::get_if<LookStep>(&script_[step_]) : nullptr;
        if (!look || !board_.cameraEnded() || !settled()) return;
        const size_t looks = board_.looks();
        if (looks < look->times)
            throw geometry::InputError(arguments_.script.string(), fmt::format("look {}", look->times),
                                       fmt::format("the replay has ended with {} looks at the table, "
                                                   "expected more pictures or --loop",
                                                   looks));
    }

    void runScript() {
        refuseLookAfterTheEnd();
        if (!scriptReady()) return;
        const ScriptStep& step = script_[step_];
        if (const auto* sleep = std::get_if<SleepStep>(&step))
            sleepUntil_ = LiveClock::now() + std::chrono::duration_cast<LiveClock::duration>(
                                                 std::chrono::duration<double>(sleep->seconds));
        if (const auto* time = std::get_if<TimeStep>(&step)) controls_.setTime(time->time);
        if (const auto* sky = std::get_if<SkyStep>(&step)) controls_.values.sky = sky->sky;
        if (const auto* event = std::get_if<EventStep>(&step)) handle(event->event);
        if (const auto* resize = std::get_if<ResizeStep>(&step))
            outputs_->resize(resize->window, resize->width, resize->height);
        if (const auto* close = std::get_if<CloseStep>(&step)) outputs_->close(close->window);
        if (const auto* shot = std::get_if<SnapshotStep>(&step)) snapshot(shot->name);
        if (std::holds_alternative<QuitStep>(step)) end("its script quits");
        ++step_; // a picture that the device failed to take is taken again
    }

    void snapshot(const std::string& name) {
        present::OperatorActions ignored;
        outputs_->drawOperator(controls_.values, status(), ignored);
        outputs_->snapshot(arguments_.snapshots, name);
    }

    Run& run_;
    const LiveArguments& arguments_;
    FileWatch rigFile_; // first: nothing written after it was read is missed
    geometry::Rig rig_;
    SkySource source_;
    LiveControls controls_;
    std::optional<OutputFolder> snapshots_;
    std::vector<ScriptStep> script_;
    size_t step_ = 0;
    LiveClock::time_point started_ = LiveClock::now(), operatorDrawn_{}, sleepUntil_{}, taken_{};
    std::string ended_;      // why; empty: it goes on
    bool dirty_ = true;      // what the projectors show is not what it should be
    bool fresh_ = false;     // there is light that no output shows yet
    bool sameLight_ = false; // the last light taken is the one before
    std::optional<LitScene> lit_;
    LiveFigures figures_;
    std::vector<std::string> rows_; // what each of the latest sketches took
    LiveBoard board_;
    Latest<SeenTable> tables_;
    std::optional<LiveOutputs> outputs_; // none only while others take their place
    std::vector<LiveClock::time_point> outputLosses_;
    DeviceSlots slots_;
    LiveLight light_;      // its transport gives a slot back
    LiveSceneMaker maker_; // delivers to the light
    LiveTable table_;      // delivers to the maker
};

} // namespace

void execute(Run& run, const LiveArguments& arguments) {
    LiveArguments complete = arguments;
    if (complete.camera.empty()) complete.camera = "aravis:";
    vision::refuseNoCamera(complete.camera); // before any display is asked for
    LiveSession session(run, complete);
    try {
        session.show();
    } catch (const Interrupted&) { // the usual end of a program that has none of its own
        session.end("a signal told it to end");
    } catch (...) {
        session.report();
        throw;
    }
    session.report();
}

} // namespace heliodon::app
