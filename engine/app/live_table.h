// The thread of `live` that looks at the table: camera, change, detection.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "engine/app/latest.h"
#include "engine/app/live_board.h"
#include "geometry/rig.h"
#include "vision/camera.h"

namespace heliodon::app {

// A sketch that differs from the one before.
struct SeenTable {
    geometry::Sketch sketch;
    std::string picture; // its name, for messages
    LiveClock::time_point taken{};
};

class LiveTable {
public:
    // The camera is opened here, so that a source that can never work is refused at once; one that is not
    // there yet is waited for. `out` is given to as long as the object lives.
    LiveTable(const geometry::Rig& rig, const std::string& source, const vision::CameraOptions& options,
              LiveBoard& board, Latest<SeenTable>& out);
    ~LiveTable();
    LiveTable(const LiveTable&) = delete;
    LiveTable& operator=(const LiveTable&) = delete;

    // The projectors show something else from now on. From any thread.
    void lightChanged() { lightChanged_ = LiveClock::now().time_since_epoch().count(); }

private:
    class Eye;
    void run();
    void openAgain();

    const geometry::Rig& rig_;
    std::string source_;
    vision::CameraOptions options_;
    LiveBoard& board_;
    Latest<SeenTable>& out_;
    std::unique_ptr<vision::Camera> camera_;
    std::atomic<bool> stop_ = false;
    std::atomic<LiveClock::rep> lightChanged_ = 0;
    std::thread thread_; // last: it uses all of the above
};

} // namespace heliodon::app
