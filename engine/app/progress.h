// How far a long job is: a bar with the time left on a terminal, a plain line now and then elsewhere, nothing
// when quiet.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace heliodon::app {

class Progress {
public:
    // Nothing appears in the first two seconds: short work needs no bar.
    Progress(std::string what, size_t total, bool shown);
    ~Progress(); // ends the line
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    // Throws Interrupted after Ctrl-C.
    void advance(size_t done);

private:
    using Clock = std::chrono::steady_clock;

    std::string what_;
    size_t total_;
    bool shown_, terminal_, drawn_ = false;
    Clock::time_point start_, last_;
};

} // namespace heliodon::app
