// Wall and processor seconds of this process and the programs that it has waited for, all threads.
#pragma once

#include <chrono>

#include <sys/resource.h>

namespace heliodon::app {

class BenchClock {
public:
    BenchClock() : wall_(Clock::now()), cpu_(cpuNow()) {}
    void stop(double& wallSeconds, double& cpuSeconds) const {
        wallSeconds = std::chrono::duration<double>(Clock::now() - wall_).count();
        cpuSeconds = cpuNow() - cpu_;
    }

private:
    using Clock = std::chrono::steady_clock;
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

    Clock::time_point wall_;
    double cpu_;
};

} // namespace heliodon::app
