// How long something took.
#pragma once

#include <chrono>

namespace heliodon::compute {

// Seconds since it was made.
class Stopwatch {
public:
    double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Adds the seconds of its life to a sum.
class SecondsAdded {
public:
    explicit SecondsAdded(double& sum) : sum_(sum) {}
    ~SecondsAdded() { sum_ += watch_.seconds(); }
    SecondsAdded(const SecondsAdded&) = delete;
    SecondsAdded& operator=(const SecondsAdded&) = delete;

private:
    double& sum_;
    Stopwatch watch_;
};

} // namespace heliodon::compute
