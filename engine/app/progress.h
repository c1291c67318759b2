// How far a long job is, or that it goes on: a bar with the time left on a terminal, a plain line now and
// then elsewhere, nothing when quiet.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace heliodon::app {

class Progress {
public:
    // Nothing appears in the first two seconds: short work needs no bar.
    Progress(std::string what, size_t total, bool shown);
    ~Progress(); // ends the line
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    // Throws Interrupted after Ctrl-C. `share`: of all the work, where steps differ.
    void advance(size_t done) { advance(done, static_cast<double>(done) / static_cast<double>(total_)); }
    void advance(size_t done, double share);

private:
    using Clock = std::chrono::steady_clock;

    std::string what_;
    size_t total_;
    bool shown_, terminal_, drawn_ = false, finished_ = false;
    Clock::time_point start_, last_;
};

// The stage at work and how long it has taken, on a terminal, for stages that cannot tell how much is left.
// Nothing in a stage's first two seconds, nor under a bar of Progress. From any thread.
class Heartbeat {
public:
    explicit Heartbeat(bool shown); // never drawn where stderr is no terminal
    ~Heartbeat();
    Heartbeat(const Heartbeat&) = delete;
    Heartbeat& operator=(const Heartbeat&) = delete;

    void begin(const std::string& stage); // within the one begun before
    void end(const std::string& stage);
    void wipe(); // its line, or a bar's, before another is written

private:
    using Clock = std::chrono::steady_clock;
    struct Stage {
        std::string name;
        Clock::time_point start;
    };

    void beat();
    void wipeLocked();

    bool shown_, drawn_ = false, finished_ = false;
    std::mutex mutex_;
    std::condition_variable finish_;
    std::vector<Stage> stages_;
    std::thread thread_; // from the first stage on
};

} // namespace heliodon::app
