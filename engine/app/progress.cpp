#include "engine/app/progress.h"

#include <algorithm>
#include <atomic>
#include <unistd.h>

#include <fmt/format.h>

#include "engine/app/console.h"
#include "engine/app/interrupt.h"

namespace heliodon::app {

namespace {

std::atomic<int> barsDrawn = 0; // they keep the line

std::string clockText(double seconds) {
    const auto s = static_cast<long>(seconds + 0.5);
    return s >= 3600 ? fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
                     : fmt::format("{}:{:02}", s / 60, s % 60);
}

void eraseLine() {
    say("\r\x1b[K");
}

} // namespace

Progress::Progress(std::string what, size_t total, bool shown)
    : what_(std::move(what)), total_(total), shown_(shown), terminal_(::isatty(STDERR_FILENO) == 1),
      start_(Clock::now()), last_(start_) {}

Progress::~Progress() {
    if (drawn_ && terminal_) say("\n");
    if (drawn_) --barsDrawn;
}

void Progress::advance(size_t done, double share) {
    throwIfInterrupted();
    if (!shown_ || total_ == 0) return;
    const Clock::time_point now = Clock::now();
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    const double since = std::chrono::duration<double>(now - last_).count();
    const double pause = terminal_ ? 0.1 : 10;
    const bool end = done >= total_ && drawn_; // said at once, and once
    if (elapsed < 2 || finished_ || (since < pause && !end)) return;
    last_ = now;
    finished_ = done >= total_;
    if (!drawn_) ++barsDrawn;
    drawn_ = true;
    const std::string left = share > 0 ? clockText(elapsed / share - elapsed) : "?";
    if (terminal_) {
        constexpr int kWidth = 30;
        const int filled = std::clamp(static_cast<int>(share * kWidth), 0, kWidth);
        say(fmt::format("\r{} [{}{}] {}/{}, {} left \x1b[K", what_,
                        std::string(static_cast<size_t>(filled), '#'),
                        std::string(static_cast<size_t>(kWidth - filled), '.'), done, total_, left));
    } else {
        say(fmt::format("{}: {} of {}, {} left\n", what_, done, total_, left));
    }
}

Heartbeat::Heartbeat(bool shown) : shown_(shown && ::isatty(STDERR_FILENO) == 1) {}

Heartbeat::~Heartbeat() {
    {
        const std::lock_guard lock(mutex_);
        finished_ = true;
    }
    finish_.notify_all();
    if (thread_.joinable()) thread_.join();
}

void Heartbeat::begin(const std::string& stage) {
    if (!shown_) return;
    const std::lock_guard lock(mutex_);
    stages_.push_back({stage, Clock::now()});
    if (!thread_.joinable()) thread_ = std::thread([this] { beat(); });
}

void Heartbeat::end(const std::string& stage) {
    if (!shown_) return;
    const std::lock_guard lock(mutex_);
    const auto named =
        std::find_if(stages_.rbegin(), stages_.rend(), [&](const Stage& s) { return s.name == stage; });
    if (named != stages_.rend()) stages_.erase(std::next(named).base());
    wipeLocked();
}

void Heartbeat::wipe() {
    if (!shown_) return;
    const std::lock_guard lock(mutex_);
    if (barsDrawn > 0) eraseLine(); // the bar comes back with its next step
    wipeLocked();
}

void Heartbeat::wipeLocked() {
    if (drawn_ && barsDrawn == 0) eraseLine();
    drawn_ = false;
}

void Heartbeat::beat() {
    std::unique_lock lock(mutex_);
    while (!finish_.wait_for(lock, std::chrono::milliseconds(500), [&] { return finished_; })) {
        if (stages_.empty() || barsDrawn > 0) continue;
        const auto& [name, start] = stages_.back();
        const double elapsed = std::chrono::duration<double>(Clock::now() - start).count();
        if (elapsed < 2) continue;
        say(fmt::format("\r{}: {} \x1b[K", name, clockText(elapsed)));
        drawn_ = true;
    }
    wipeLocked();
}

} // namespace heliodon::app
