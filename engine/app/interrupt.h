// Ctrl-C as an error: work ends at the next place that asks, with nothing half-written; a second one ends the
// program at once.
#pragma once

#include <stdexcept>

namespace heliodon::app {

class Interrupted : public std::runtime_error {
public:
    Interrupted() : std::runtime_error("interrupted") {}
};

// While it lives, Ctrl-C is noted and throwIfInterrupted() throws. A program started with it ignored (in the
// background of a script) goes on ignoring it. One at a time.
class InterruptGuard {
public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;

private:
    void (*before_)(int);
};

// Asked at every step of a progress bar and before every submission to a device; from any thread.
void throwIfInterrupted();

} // namespace heliodon::app
