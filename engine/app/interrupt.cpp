#include "engine/app/interrupt.h"

#include <csignal>

namespace heliodon::app {

namespace {

volatile std::sig_atomic_t interrupted = 0;

} // namespace

InterruptGuard::InterruptGuard()
    : before_(std::signal(SIGINT, [](int) {
          interrupted = 1;
          std::signal(SIGINT, SIG_DFL);
      })) {
    if (before_ == SIG_IGN) std::signal(SIGINT, SIG_IGN);
}

InterruptGuard::~InterruptGuard() {
    std::signal(SIGINT, before_);
    interrupted = 0;
}

void throwIfInterrupted() {
    if (interrupted) throw Interrupted();
}

} // namespace heliodon::app
