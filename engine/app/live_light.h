// The thread of `live` that solves the light of a moment, always the latest that was asked for.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "compute/daylight/sky.h"
#include "engine/app/light_report.h"
#include "engine/app/live_scene.h"
#include "engine/app/moment.h"
#include "engine/passes/own_scatter.h"

namespace heliodon::app {

struct LightRequest {
    daylight::Moment time;
    daylight::Site site;
    std::string sky;                                  // as --sky has it
    std::shared_ptr<const daylight::Weather> weather; // in place of site and sky, unless null
    bool coloured = false;
    bool leavesOutScatter = false; // of pictures of this white, lux; none: autoWhite
    std::optional<double> whiteLux;
    LiveClock::time_point asked;
};

// A whole state: what all outputs are to show from one moment on.
struct LitScene {
    std::shared_ptr<const LiveScene> scene;
    std::unique_ptr<passes::FrameScene> frame;     // null: drawn as before
    std::shared_ptr<const compute::Moment> moment; // the same object as before: the same light
    std::string time, sky;                         // of it, in words; no time where the sky is a file's
    LightFigures figures;
    double autoWhite = 0, solveSeconds = 0;
    std::vector<float> shownLux;
    std::optional<passes::ScatterReport> scatter;
    size_t frameNumber = 0;      // of the frame that it is drawn with; see LiveLight::repaint
    LiveClock::time_point asked; // for this moment
    bool fromPicture = false;    // the scene is new: its picture was taken at scene->taken
};

class LiveLight {
public:
    // Both are called from the thread: `ready` when there is something to take, `lost` when the scene has to
    // be handed over once more, with a transport, as the device failed.
    LiveLight(LiveBoard& board, std::function<void()> ready, std::function<void()> lost);
    ~LiveLight();
    LiveLight(const LiveLight&) = delete;
    LiveLight& operator=(const LiveLight&) = delete;

    // From any thread; only the latest request is worked on. Changes of the scene are all taken, in order.
    void ask(LightRequest request);
    void change(SceneChange change);
    // What projectors can do with the frame of that number has changed. Of a frame that another has followed
    // it is left aside.
    void repaint(size_t frameNumber, passes::PaintedPatches painted);
    // The latest state that is ready, once. A frame that goes with an earlier one is handed on with it.
    std::optional<LitScene> take();
    bool hasReady() const;

    // Moments that were solved, and those that had the same light as the one before.
    size_t solved() const { return solved_; }
    size_t repeated() const { return repeated_; }

private:
    void run();
    void change(std::vector<SceneChange>& changes);
    void trySolve(std::vector<SceneChange>& changes);
    void solve(bool fromPicture);

    LiveBoard& board_;
    std::function<void()> onReady_, onLost_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<SceneChange> changes_;
    std::optional<LightRequest> asked_;
    std::optional<std::pair<size_t, passes::PaintedPatches>> repaint_;
    std::optional<LitScene> ready_;
    bool stop_ = false;
    std::atomic<size_t> solved_ = 0, repeated_ = 0;
    // Of the thread alone.
    LightRequest request_;
    bool hasRequest_ = false;
    std::shared_ptr<const LiveScene> scene_;
    std::unique_ptr<passes::FrameScene> frame_; // not handed on yet
    std::unique_ptr<SlottedTransport> transport_;
    std::shared_ptr<const compute::Moment> moment_;
    std::optional<daylight::Sky> sky_;
    bool coloured_ = false;
    std::optional<double> whiteLux_;
    passes::PaintedPatches painted_; // of the frame
    size_t frameNumber_ = 0;
    std::optional<passes::ScatterReport> scatter_;
    int failures_ = 0;   // of the device, one after the other
    std::thread thread_; // last: it uses all of the above
};

} // namespace heliodon::app
