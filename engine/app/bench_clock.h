// Wall and processor seconds of this process and the programs that it has waited for, all threads.
#pragma once

#include <sys/resource.h>

#include "compute/stopwatch.h"

namespace heliodon::app {

class BenchClock {
public:
    BenchClock() : cpu_(cpuNow()) {}
    // Since construction. A program's processor seconds count once it has been waited for; they are as fine
    // as the kernel counts them.
    void stop(double& wallSeconds, double& cpuSeconds) const {
        wallSeconds = wall_.seconds();
        cpuSeconds = cpuNow() - cpu_;
    }

private:
    static double cpuNow() {
        double sum = 0;
        for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
            rusage usage{};
            getrusage(who, &usage);
            for (const timeval& t : {usage.ru_utime, usage.ru_stime})
                sum += static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
        }
        return sum;
    }

    compute::Stopwatch wall_;
    double cpu_;
};

} // namespace heliodon::app
