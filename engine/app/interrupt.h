// Ctrl-C as an error, and a system or a terminal that ends the program likewise (SIGINT, SIGTERM, SIGHUP):
// work ends at the next place that asks, with nothing half-written; a second Ctrl-C ends the program at once.
// A run whose work is done by then, but for its report, ends as it would have, with 0.
#pragma once

#include <array>
#include <stdexcept>

namespace heliodon::app {

class Interrupted : public std::runtime_error {
public:
    Interrupted() : std::runtime_error("interrupted") {}
};

// While it lives, these signals are noted and throwIfInterrupted() throws. One that the program was started
// with ignored (in the background of a script, under nohup) goes on being ignored. One at a time.
class InterruptGuard {
public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;

private:
    std::array<void (*)(int), 3> before_{};
};

// Asked at every step of a progress bar, before every stage and every submission to a device; from any
// thread.
void throwIfInterrupted();

} // namespace heliodon::app
