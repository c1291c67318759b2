// What the machine is, and what it does beside a bench.
#pragma once

#include <string>

#include "engine/app/bench_clock.h"

namespace heliodon::app {

// As Linux names it; empty elsewhere.
std::string processorName();

// peakMemory: bytes of this process since resetPeakMemory, where the system keeps them; else 0.
void resetPeakMemory();
double peakMemory();

// How much of the machine other work has had since construction.
class OtherWork {
public:
    OtherWork();
    double cores() const; // kept busy, on the mean; 0 where the system does not count

private:
    double before_;
    BenchClock clock_;
};

} // namespace heliodon::app
