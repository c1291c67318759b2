#include "engine/app/live_outputs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "engine/app/projector_displays.h"
#include "engine/app/test_pictures.h"
#include "engine/passes/image_file.h"
#include "geometry/input_error.h"

namespace heliodon::app {

namespace {

constexpr const char* kOperatorTitle = "heliodon";
constexpr int kOperatorWidth = 1320, kOperatorHeight = 840;
constexpr double kCameraSeconds = 0.2; // from one camera picture in the operator's window to the next

present::WindowOptions projectorWindow(const geometry::Projector& projector, size_t i,
                                       const LiveArguments& arguments) {
    present::WindowOptions options;
    options.title = fmt::format("projector {}: {}", i, projector.id);
    const double scale = arguments.windowScale;
    options.width = std::max(1, static_cast<int>(std::lround(scale * projector.width)));
    options.height = std::max(1, static_cast<int>(std::lround(scale * projector.height)));
    if (!arguments.windowed) options.display = projector.display;
    const int column = static_cast<int>(i % 2), row = static_cast<int>(i / 2);
    options.position = {column * options.width, row * options.height};
    return options;
}

// On a display that is no projector's, where there is one.
present::WindowOptions operatorWindow(const geometry::Rig& rig, bool windowed) {
    present::WindowOptions options{kOperatorTitle, kOperatorWidth, kOperatorHeight};
    const std::vector<present::Display> displays = present::displays();
    const auto isProjectors = [&](const present::Display& display) {
        return !windowed && std::any_of(rig.projectors.begin(), rig.projectors.end(),
                                        [&](const auto& p) { return p.display == display.name; });
    };
    auto at = std::find_if_not(displays.begin(), displays.end(), isProjectors);
    if (at == displays.end()) at = displays.begin();
    if (at == displays.end()) return options;
    options.width = std::min(options.width, std::max(640, at->width - 40));
    options.height = std::min(options.height, std::max(480, at->height - 60));
    // To the right, beside windows of projectors where these are small.
    options.position = {at->x + std::max(0, at->width - options.width), at->y};
    return options;
}

// Of projectors that the rig gives no display, or one that has another's picture over it.
void warnOfDisplays(Run& run, const geometry::Rig& rig, const std::string& file) {
    const auto& all = rig.projectors;
    std::vector<std::string> names;
    for (const present::Display& display : present::displays()) names.push_back(display.name);
    for (size_t i = 0; i < all.size(); ++i) {
        const std::string& name = all[i].display;
        const auto first =
            std::find_if(all.begin(), all.end(), [&](const auto& p) { return p.display == name; });
        std::string wrong;
        if (name.empty())
            wrong =
                fmt::format("names no display (connected: {}; or say --display {}=OUTPUT): it is shown in "
                            "a window",
                            fmt::join(names, ", "), all[i].id);
        else if (first != all.begin() + static_cast<ptrdiff_t>(i))
            wrong = fmt::format("'{}' is also of '{}': only one of the two is seen", name, first->id);
        if (!wrong.empty()) run.warn(fmt::format("{}: projectors[{}].display: {}", file, i, wrong));
    }
}

} // namespace

LiveOutputs::LiveOutputs(Run& run, const geometry::Rig& rig, const LiveArguments& arguments)
    : run_(run), rig_(rig) {
    if (rig.projectors.empty())
        throw geometry::InputError(arguments.scene.rig.string(), "projectors",
                                   "there is none to show anything on");
    device_ = run.anotherDevice(present::withWindows);
    std::vector<present::WindowOptions> windows;
    for (size_t i = 0; i < rig.projectors.size(); ++i)
        windows.push_back(projectorWindow(rig.projectors[i], i, arguments));
    if (!arguments.windowed) warnOfDisplays(run, rig, arguments.scene.rig.string());
    windows.push_back(operatorWindow(rig, arguments.windowed));
    presenter_.emplace(*device_, windows);
    operator_ = std::make_unique<present::OperatorWindow>(*device_, *presenter_, operatorIndex());
    notices_.resize(windows.size());
    missing_.resize(windows.size());
    saidLost_.resize(windows.size());
    displayLosses_.resize(windows.size());
    chosen_.resize(rig.projectors.size());
    choose(present::Shown::light, false);
}

LiveOutputs::~LiveOutputs() {
    operator_.reset(); // it listens to a window
}

std::vector<present::Event> LiveOutputs::pollEvents(double waitSeconds) {
    std::vector<present::Event> events = presenter_->pollEvents(waitSeconds);
    followDisplays();
    for (size_t i = 0; i < notices_.size(); ++i) {
        if (presenter_->reason(i) == present::kDisplayLost && !std::exchange(saidLost_[i], char{1})) {
            run_.warn(fmt::format("{} is closed: {}", windowName(i), present::kDisplayLost));
            endedByLoss_ = !wanted();
        }
    }
    std::erase_if(events, [this](const present::Event& event) {
        return event.window == operatorIndex() &&
               (event.kind == present::Event::Kind::key ? operator_->takesKeys() : operator_->takesWheel());
    });
    return events;
}

void LiveOutputs::followDisplays() {
    std::vector<std::optional<present::Display>> covered;
    for (size_t i = 0; i < presenter_->size(); ++i) covered.push_back(presenter_->covers(i));
    for (size_t i = 0; i < presenter_->size(); ++i) {
        const bool missing = presenter_->displayMissing(i);
        if (std::exchange(missing_[i], char{missing}) != char{missing}) {
            displayLosses_[i] += missing;
            if (!missing && presenter_->state(i) != present::WindowState::closed)
                run_.note(fmt::format("{}: its display is connected", windowName(i)));
        }
        std::string notice = presenter_->notice(i);
        if (notice.empty() && i != operatorIndex()) notice = displayNotice(rig_, i, covered);
        if (std::exchange(notices_[i], notice) != notice && !notice.empty())
            run_.warnAgain(fmt::format("{}: {}", windowName(i), notice));
    }
}

bool LiveOutputs::wanted() const {
    const std::vector<bool> closed = closedProjectors();
    return std::ranges::count(closed, false) > 0 &&
           presenter_->state(operatorIndex()) != present::WindowState::closed;
}

std::string LiveOutputs::whyNotWanted() const {
    if (presenter_->state(operatorIndex()) == present::WindowState::closed)
        return fmt::format("{} is {}", windowName(operatorIndex()), presenter_->reason(operatorIndex()));
    std::vector<std::string> each;
    for (size_t i = 0; i < operatorIndex(); ++i)
        each.push_back(fmt::format("{} is {}", windowName(i), presenter_->reason(i)));
    return fmt::format("{}", fmt::join(each, ", "));
}

void LiveOutputs::refuseLoss() const {
    if (endedByLoss_)
        throw std::runtime_error("windows that are needed were closed: their displays went away");
}

std::string LiveOutputs::windowName(size_t window) const {
    return window == operatorIndex() ? "the operator's window" : rig_.projectors[window].id + "'s window";
}

bool LiveOutputs::damaged() const {
    for (size_t i = 0; i < presenter_->size(); ++i)
        if (presenter_->damaged(i) && presenter_->state(i) == present::WindowState::open) return true;
    return false;
}

void LiveOutputs::toggleFullScreen(size_t window) {
    if (presenter_->state(window) != present::WindowState::closed)
        presenter_->setFullScreen(window, !presenter_->fullScreen(window));
}

void LiveOutputs::resize(size_t window, int width, int height) {
    presenter_->resize(window, width, height);
}

void LiveOutputs::close(size_t window) {
    presenter_->close(window);
}

LiveOutputs::Arrangement LiveOutputs::arrangement() const {
    Arrangement now;
    for (size_t i = 0; i < presenter_->size(); ++i) {
        now.closed.push_back(presenter_->reason(i));
        now.fullScreen.push_back(presenter_->fullScreen(i));
    }
    return now;
}

void LiveOutputs::arrange(const Arrangement& like) {
    for (size_t i = 0; i < presenter_->size(); ++i) {
        if (!like.closed[i].empty())
            presenter_->close(i, like.closed[i]);
        else if (presenter_->fullScreen(i) != like.fullScreen[i])
            toggleFullScreen(i);
    }
}

std::vector<bool> LiveOutputs::closedProjectors() const {
    std::vector<bool> closed;
    for (size_t i = 0; i < operatorIndex(); ++i)
        closed.push_back(presenter_->state(i) == present::WindowState::closed);
    return closed;
}

bool LiveOutputs::leaveOutClosed() {
    if (!renderer_ || !wanted() || closedProjectors() == leftOut_) return false;
    leftOut_ = closedProjectors();
    renderer_->leaveOut(leftOut_);
    light_.clear();
    return true;
}

void LiveOutputs::replaceScene(passes::FrameScene scene) {
    leftOut_.assign(operatorIndex(), false); // leaveOutClosed follows
    if (renderer_)
        renderer_->replace(std::move(scene));
    else
        renderer_.emplace(*device_, std::move(scene));
    light_.clear();
}

void LiveOutputs::drawLight(const compute::Lighting& light, const passes::Tone& tone) {
    passes::ProjectorOptions options;
    options.tone = tone;
    light_ = renderer_->drawProjectors(light, options);
}

bool LiveOutputs::drawn() const {
    return device_->finished(device_->lastTicket());
}

const gpu::Image* LiveOutputs::testPicture(size_t projector, present::Shown shown) {
    if (tested_ != shown) {
        tests_.clear();
        for (size_t i = 0; i < rig_.projectors.size(); ++i) {
            const geometry::Projector& p = rig_.projectors[i];
            const passes::Image8 picture = shown == present::Shown::grid ? gridPicture(p)
                                           : shown == present::Shown::identify
                                               ? namePicture(p, i)
                                               : plainPicture(p, shown == present::Shown::white ? 255 : 0);
            tests_.push_back(present::uploaded(*device_, picture, "test picture"));
        }
        tested_ = shown;
    }
    return &tests_[projector];
}

void LiveOutputs::choose(present::Shown shown, bool haveLight) {
    const bool light = shown == present::Shown::light && haveLight;
    for (size_t i = 0; i < chosen_.size(); ++i)
        chosen_[i] = light ? light_[i]
                           : testPicture(i, shown == present::Shown::light ? present::Shown::black : shown);
}

const gpu::Image* LiveOutputs::cameraPicture(const std::shared_ptr<const vision::Photograph>& photo) {
    const auto now = std::chrono::steady_clock::now();
    if (photo && photo != cameraShown_ &&
        std::chrono::duration<double>(now - cameraSent_).count() > kCameraSeconds) {
        camera_ = present::uploaded(*device_, {photo->width, photo->height, photo->rgb}, "camera picture");
        cameraShown_ = photo;
        cameraSent_ = now;
    }
    return camera_.valid() ? &camera_ : nullptr;
}

void LiveOutputs::drawOperator(present::OperatorControls& controls, present::OperatorStatus status,
                               present::OperatorActions& actions) {
    for (size_t i = 0; i < operatorIndex(); ++i) {
        const geometry::Projector& projector = rig_.projectors[i];
        present::OperatorOutput output;
        output.title = fmt::format("{}  {}", i, projector.id);
        output.open = presenter_->state(i) != present::WindowState::closed;
        output.fullScreen = presenter_->fullScreen(i);
        output.picture = chosen_[i];
        output.state = !output.open        ? presenter_->reason(i)
                       : output.fullScreen ? "display " + projector.display
                       : missing_[i]       ? "no " + projector.display
                                           : "window";
        status.outputs.push_back(std::move(output));
        if (!notices_[i].empty())
            status.warnings.push_back(fmt::format("{}: {}", windowName(i), notices_[i]));
    }
    operatorPicture_ = operator_->draw(controls, status, actions);
}

void LiveOutputs::present(bool projectors, bool operatorToo) {
    std::vector<const gpu::Image*> pictures(presenter_->size(), nullptr);
    for (size_t i = 0; i < operatorIndex(); ++i)
        if (projectors || presenter_->damaged(i)) pictures[i] = chosen_[i];
    if (operatorToo || presenter_->damaged(operatorIndex())) pictures[operatorIndex()] = operatorPicture_;
    presenter_->present(pictures);
}

std::vector<std::string> LiveOutputs::snapshotFiles(const geometry::Rig& rig, const std::string& name) {
    std::vector<std::string> files;
    for (size_t i = 0; i < rig.projectors.size(); ++i)
        files.push_back(fmt::format("{}-projector-{}.png", name, i));
    files.push_back(fmt::format("{}-operator.png", name));
    return files;
}

void LiveOutputs::snapshot(const std::filesystem::path& folder, const std::string& name) {
    presenter_->keepCopies(true);
    present(true, true);
    presenter_->keepCopies(false);
    const std::vector<std::string> files = snapshotFiles(rig_, name);
    for (size_t i = 0; i < presenter_->size(); ++i) {
        const auto shown = presenter_->lastShown(i);
        if (!shown || presenter_->state(i) != present::WindowState::open) continue;
        passes::writePng(*shown, folder / files[i]);
    }
}

std::string LiveOutputs::inWords() const {
    std::vector<std::string> list;
    for (size_t i = 0; i < operatorIndex(); ++i) {
        const geometry::Projector& projector = rig_.projectors[i];
        list.push_back(presenter_->fullScreen(i)
                           ? fmt::format("{} on display {}", projector.id, projector.display)
                       : presenter_->state(i) == present::WindowState::open ? projector.id + " in a window"
                                                                            : projector.id + " nowhere");
    }
    return fmt::format("{}; operator's window '{}'", fmt::join(list, ", "), kOperatorTitle);
}

nlohmann::json LiveOutputs::report() const {
    nlohmann::json list = nlohmann::json::array();
    for (size_t i = 0; i < operatorIndex(); ++i)
        list.push_back({{"projector", rig_.projectors[i].id},
                        {"display", rig_.projectors[i].display},
                        {"full_screen", presenter_->fullScreen(i)},
                        {"notice", notices_[i]},
                        {"display_losses", displayLosses_[i]},
                        {"closed", presenter_->reason(i)}});
    return list;
}

} // namespace heliodon::app
