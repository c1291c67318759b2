#include "engine/app/interrupt.h"

#include <atomic>
#include <csignal>

namespace heliodon::app {

namespace {

// Written in a signal handler, read by all threads.
std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free);

} // namespace

InterruptGuard::InterruptGuard()
    : before_(std::signal(SIGINT, [](int) {
          interrupted = true;
          std::signal(SIGINT, SIG_DFL);
      })) {
    if (before_ == SIG_IGN) std::signal(SIGINT, SIG_IGN);
}

InterruptGuard::~InterruptGuard() {
    std::signal(SIGINT, before_);
    interrupted = false;
}

void throwIfInterrupted() {
    if (interrupted) throw Interrupted();
}

} // namespace heliodon::app
