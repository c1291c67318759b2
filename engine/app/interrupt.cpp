#include "engine/app/interrupt.h"

#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <ctime>

namespace heliodon::app {

namespace {

// Written in a signal handler, read by all threads.
std::atomic<bool> interrupted = false;
std::atomic<int64_t> firstMs = 0; // when the first signal came
static_assert(std::atomic<int64_t>::is_always_lock_free);
static_assert(std::atomic<bool>::is_always_lock_free);

constexpr std::array<int, 3> kSignals{SIGINT, SIGTERM, SIGHUP};

extern "C" void noteSignal(int number) {
    // Whoever is impatient ends the program at once. But `timeout` sends a signal to the program and then to
    // its group, and a terminal that is closed sends several: those are one.
    constexpr int64_t kSame = 200; // ms
    timespec time{};
    ::clock_gettime(CLOCK_MONOTONIC, &time);
    const int64_t now = 1000 * static_cast<int64_t>(time.tv_sec) + time.tv_nsec / 1000000;
    if (!interrupted) {
        firstMs = now;
        interrupted = true;
    } else if (number != SIGHUP && now - firstMs > kSame) {
        std::signal(number, SIG_DFL);
        std::raise(number);
    }
}

} // namespace

InterruptGuard::InterruptGuard() {
    for (size_t k = 0; k < kSignals.size(); ++k) {
        before_[k] = std::signal(kSignals[k], noteSignal);
        if (before_[k] == SIG_IGN) std::signal(kSignals[k], SIG_IGN);
    }
}

InterruptGuard::~InterruptGuard() {
    for (size_t k = 0; k < kSignals.size(); ++k) std::signal(kSignals[k], before_[k]);
    interrupted = false;
}

void throwIfInterrupted() {
    if (interrupted) throw Interrupted();
}

} // namespace heliodon::app
