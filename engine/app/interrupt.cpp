#include "engine/app/interrupt.h"

#include <array>
#include <atomic>
#include <csignal>

namespace heliodon::app {

namespace {

// Written in a signal handler, read by all threads.
std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free);

constexpr std::array<int, 3> kSignals{SIGINT, SIGTERM, SIGHUP};

extern "C" void noteSignal(int number) {
    interrupted = true;
    // A terminal that is closed sends several.
    if (number != SIGHUP) std::signal(number, SIG_DFL);
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
