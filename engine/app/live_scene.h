// The thread of `live` that makes rooms of sketches: closing, meshing, form factors, what projectors see.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <optional>
#include <thread>

#include "compute/daylight_transport.h"
#include "engine/app/live_table.h"
#include "engine/app/run.h"
#include "engine/app/scene_input.h"
#include "engine/passes/frame_scene.h"

namespace heliodon::app {

struct LiveScene {
    Scene scene;
    nlohmann::json report;       // of the work on it
    LiveClock::time_point taken; // the picture that it was seen in
    std::string row;             // what had to be done again: "geometry", "materials" or "north"
    bool again = false;          // nothing is new but the device
};

// Two devices take turns: one solves light for what is shown while the other works on what is to come.
class DeviceSlots {
public:
    explicit DeviceSlots(Run& run) : run_(run) {}
    // Waits for a free one. None once they are closed.
    std::optional<size_t> acquire();
    void release(size_t slot);
    // Its device has failed: whoever acquires the slot next gets another one.
    void spoil(size_t slot);
    size_t spoilt() const { return spoilt_; } // so far
    // The devices' work ends as Ctrl-C would end it.
    void close();
    gpu::Device& device(size_t slot);

private:
    Run& run_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::array<std::unique_ptr<gpu::Device>, 2> devices_;
    std::array<bool, 2> taken_{}, spoiltNow_{};
    std::atomic<size_t> spoilt_ = 0;
    std::atomic<bool> closed_ = false;
};

// A transport with the device that it is on; the slot is free when it is gone.
class SlottedTransport {
public:
    SlottedTransport(DeviceSlots& slots, size_t slot) : slots_(slots), slot_(slot) {}
    ~SlottedTransport() {
        transport.reset();
        slots_.release(slot_);
    }
    SlottedTransport(const SlottedTransport&) = delete;
    SlottedTransport& operator=(const SlottedTransport&) = delete;

    gpu::Device& device() { return slots_.device(slot_); }
    void spoil() { slots_.spoil(slot_); }
    std::unique_ptr<compute::DaylightTransport> transport;

private:
    DeviceSlots& slots_;
    size_t slot_;
};

struct SceneChange {
    std::shared_ptr<const LiveScene> scene;
    std::unique_ptr<passes::FrameScene> frame;   // null: drawn as before
    std::unique_ptr<SlottedTransport> transport; // null: that of before, with the scene's materials
};

class LiveSceneMaker {
public:
    // `deliver` is called from the thread; nothing is made while it lasts.
    LiveSceneMaker(const SceneArguments& arguments, const geometry::Rig& rig, DeviceSlots& slots,
                   LiveBoard& board, Latest<SeenTable>& in, std::function<void(SceneChange)> deliver);
    ~LiveSceneMaker();
    LiveSceneMaker(const LiveSceneMaker&) = delete;
    LiveSceneMaker& operator=(const LiveSceneMaker&) = delete;

private:
    void run();
    void makeOrTryAgain(const SeenTable& seen);
    void make(const SeenTable& seen);
    void sayDoing(const std::string& what);
    // Null once no device is to be had: the program ends.
    std::unique_ptr<SlottedTransport> transportOf(Run& run, const geometry::PatchMesh& mesh);

    const SceneArguments& arguments_;
    const geometry::Rig& rig_;
    DeviceSlots& slots_;
    LiveBoard& board_;
    Latest<SeenTable>& in_;
    std::function<void(SceneChange)> deliver_;
    std::shared_ptr<const LiveScene> before_;
    size_t spoiltBefore_ = 0; // devices, when `before_` was made
    uint32_t reaching_ = 0;   // projectors that reach anything of `before_`, as bits
    std::thread thread_;      // last: it uses all of the above
};

} // namespace heliodon::app
