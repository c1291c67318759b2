// What the threads of `live` tell about themselves, for the operator's window and the report.
#pragma once

#include <chrono>
#include <exception>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "geometry/sketch.h"
#include "vision/photograph.h"

namespace heliodon::app {

using LiveClock = std::chrono::steady_clock;

inline double secondsSince(LiveClock::time_point start) {
    return std::chrono::duration<double>(LiveClock::now() - start).count();
}

// Texts are whole sentences or names, empty where there is nothing to say; counts are since the start.
struct LiveStatus {
    std::string camera = "no camera yet";                         // what it is, or why there is none
    bool cameraFails = false, unnamed = true, tableMoves = false; // unnamed: nothing was said of a camera
    bool cameraEnded = false; // and its last picture has been looked at: no look follows
    std::shared_ptr<const vision::Photograph> photo; // the latest
    geometry::Sketch seen;                           // what was detected last
    double detectSeconds = 0;
    std::vector<std::string> detectWarnings;
    std::string working;                             // on a new sketch: what is being done
    std::string pictureRefused;                      // why the latest picture says nothing
    std::string refused;                             // why the latest sketch is not shown
    std::string lightRefused;                        // why its light is not that of the moment asked for
    nlohmann::json scene = nlohmann::json::object(); // report of the sketch that is shown
    size_t pictures = 0, looks = 0;                  // looks: at changed tables, or in vain
    size_t detections = 0, sketches = 0, refusals = 0, cameraLosses = 0, deviceLosses = 0;
    struct Message {
        bool warning;
        std::string text;
        bool each = false; // a warning that is said each time that it comes, not once
    };
    std::vector<Message> unsaid; // to the console; the thread that shows has not taken them yet

    // `field`: pictureRefused or refused.
    void refuse(std::string LiveStatus::*field, const std::string& why) {
        this->*field = why;
        ++refusals;
        unsaid.push_back({true, "not shown: " + why});
    }
    // Of a sketch that is shown from now on: of its picture and its rooms.
    void warnOfScene() {
        for (const std::string& warning : detectWarnings) unsaid.push_back({true, warning});
        for (const nlohmann::json& warning : scene["warnings"]) unsaid.push_back({true, warning});
    }
    // What the camera is, or, where it `fails`, why there is none.
    void describeCamera(const std::string& what, bool fails) {
        const bool changes = fails != cameraFails || unnamed;
        camera = what;
        cameraFails = fails;
        unnamed = false;
        if (changes) unsaid.push_back({fails, fails ? what : "camera: " + what, true});
    }
};

// All members may be called from any thread; each holds a lock for as long as a copy of the status takes, and
// `change` must be as short and must not call the board.
class LiveBoard {
public:
    template<class F> void update(F change) {
        const std::lock_guard lock(mutex_);
        change(status_);
    }
    LiveStatus read() const {
        const std::lock_guard lock(mutex_);
        return status_;
    }

    std::vector<LiveStatus::Message> takeUnsaid() {
        const std::lock_guard lock(mutex_);
        return std::exchange(status_.unsaid, {});
    }

    size_t looks() const {
        const std::lock_guard lock(mutex_);
        return status_.looks;
    }
    bool cameraEnded() const {
        const std::lock_guard lock(mutex_);
        return status_.cameraEnded;
    }

    // Every piece of work is announced by whoever hands it over, before, and ended by whoever does it, after
    // it has handed on what comes of it: so where nothing is pending nothing is on its way.
    void begin() {
        const std::lock_guard lock(mutex_);
        ++pending_;
    }
    void end(int pieces = 1) {
        const std::lock_guard lock(mutex_);
        pending_ -= pieces;
    }
    bool idle() const {
        const std::lock_guard lock(mutex_);
        return pending_ == 0;
    }

    // What a thread cannot go on from; the first is kept, for the thread that shows.
    void fail(std::exception_ptr why) {
        const std::lock_guard lock(mutex_);
        if (!failure_) failure_ = why;
    }
    void rethrow() const {
        const std::lock_guard lock(mutex_);
        if (failure_) std::rethrow_exception(failure_);
    }

private:
    mutable std::mutex mutex_;
    LiveStatus status_;
    int pending_ = 0;
    std::exception_ptr failure_;
};

} // namespace heliodon::app
