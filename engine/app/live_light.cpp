#include "engine/app/live_light.h"

#include <algorithm>

#include "compute/gpu/error.h"
#include "engine/app/interrupt.h"
#include "engine/app/sky_tint.h"
#include "engine/passes/frame_light.h"
#include "geometry/input_error.h"

namespace heliodon::app {

LiveLight::LiveLight(LiveBoard& board, std::function<void()> ready, std::function<void()> lost)
    : board_(board), onReady_(std::move(ready)), onLost_(std::move(lost)), thread_([this] { run(); }) {}

LiveLight::~LiveLight() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
        changed_.notify_all();
    }
    thread_.join();
}

void LiveLight::ask(LightRequest request) {
    const std::lock_guard lock(mutex_);
    if (!asked_) board_.begin();
    asked_ = std::move(request);
    changed_.notify_all();
}

void LiveLight::change(SceneChange change) {
    const std::lock_guard lock(mutex_);
    board_.begin();
    changes_.push_back(std::move(change));
    changed_.notify_all();
}

void LiveLight::repaint(size_t frameNumber, passes::PaintedPatches painted) {
    const std::lock_guard lock(mutex_);
    if (!repaint_) board_.begin();
    repaint_ = {frameNumber, std::move(painted)};
    changed_.notify_all();
}

std::optional<LitScene> LiveLight::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(ready_, std::nullopt);
}

bool LiveLight::hasReady() const {
    const std::lock_guard lock(mutex_);
    return ready_.has_value();
}

void LiveLight::run() {
    try {
        for (;;) {
            std::vector<SceneChange> changes;
            std::optional<LightRequest> asked;
            std::optional<std::pair<size_t, passes::PaintedPatches>> repainted;
            {
                std::unique_lock lock(mutex_);
                changed_.wait(lock, [this] { return stop_ || asked_ || repaint_ || !changes_.empty(); });
                if (stop_) return;
                changes.swap(changes_);
                asked.swap(asked_);
                repainted.swap(repaint_);
            }
            const int pieces = static_cast<int>(changes.size()) + (asked ? 1 : 0) + (repainted ? 1 : 0);
            if (asked) request_ = std::move(*asked), hasRequest_ = true;
            if (repainted && repainted->first == frameNumber_) {
                painted_ = std::move(repainted->second);
                sky_.reset(); // solve anew
                request_.asked = LiveClock::now();
            }
            trySolve(changes);
            board_.end(pieces);
            onReady_();
        }
    } catch (const Interrupted&) {
    } catch (...) {
        board_.fail(std::current_exception());
    }
}

void LiveLight::change(std::vector<SceneChange>& changes) {
    for (SceneChange& change : changes) {
        if (change.transport)
            transport_ = std::move(change.transport);
        else if (change.frame && transport_)
            transport_->transport->setMaterials(change.scene->scene.mesh.materials);
        if (change.frame) {
            painted_ = change.frame->painted;
            frame_ = std::move(change.frame);
            ++frameNumber_;
        }
        scene_ = change.scene;
        sky_.reset(); // solve anew
        if (scene_->again) request_.asked = LiveClock::now();
    }
}

void LiveLight::trySolve(std::vector<SceneChange>& changes) {
    constexpr int kAttempts = 3; // without anybody asking for another moment
    std::string why;
    try {
        change(changes);
        if (!scene_ || !hasRequest_) return;
        if (!transport_) {
            onLost_();
            return;
        }
        const auto seen = [](const SceneChange& change) { return !change.scene->again; };
        solve(std::ranges::any_of(changes, seen));
        failures_ = 0;
    } catch (const geometry::InputError& error) { // a sky file may be there again at the next moment
        why = error.what();
    } catch (const gpu::Error& error) { // whatever the transport holds is not to be relied on
        why = error.what();
        transport_->spoil();
        transport_.reset();
        sky_.reset();
        board_.update([](LiveStatus& status) { ++status.deviceLosses; });
        if (++failures_ < kAttempts) onLost_();
    }
    board_.update([&](LiveStatus& status) {
        status.lightRefused = why;
        status.refusals += !why.empty();
    });
}

void LiveLight::solve(bool fromPicture) {
    const compute::Stopwatch watch;
    const Scene& scene = scene_->scene;
    const SkySource source = request_.weather ? SkySource(request_.weather, scene.northDeg)
                                              : SkySource(request_.site, request_.sky, scene.northDeg);
    const daylight::Sky sky = source.skyAt(request_.time);
    LitScene lit;
    if (sky_ && sameLight(*sky_, sky) && coloured_ == request_.coloured && whiteLux_ == request_.whiteLux) {
        ++repeated_;
    } else {
        compute::DaylightTransport& transport = *transport_->transport;
        compute::Moment moment = transport.light(sky);
        if (request_.coloured) tintLight(transport, std::span(&sky, 1), std::span(&moment, 1));
        if (request_.leavesOutScatter)
            scatter_ = passes::leaveOutScatter(
                scene.mesh, painted_,
                request_.whiteLux.value_or(passes::autoWhite(scene.mesh, moment.lighting)),
                transport.parts().gather, false, moment.lighting);
        moment_ = std::make_shared<const compute::Moment>(std::move(moment));
        ++solved_;
    }
    sky_ = sky;
    coloured_ = request_.coloured;
    whiteLux_ = request_.whiteLux;
    lit.figures = lightFigures(scene.mesh, *moment_);
    lit.autoWhite = passes::autoWhite(scene.mesh, moment_->lighting);
    lit.shownLux = passes::shownLux(scene.mesh, moment_->lighting);
    lit.scatter = scatter_;
    lit.scene = scene_;
    lit.frame = std::move(frame_);
    lit.frameNumber = frameNumber_;
    lit.moment = moment_;
    if (source.followsTime()) lit.time = daylight::timeInWords(request_.time);
    lit.sky = source.skyInWords();
    lit.solveSeconds = watch.seconds();
    lit.asked = request_.asked;
    lit.fromPicture = fromPicture;
    const std::lock_guard lock(mutex_);
    if (ready_) { // not taken yet: what it brought still counts
        if (!lit.frame) lit.frame = std::move(ready_->frame);
        lit.fromPicture = lit.fromPicture || ready_->fromPicture;
    }
    ready_ = std::move(lit);
}

} // namespace heliodon::app
