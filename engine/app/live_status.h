// What `live` has to say, in the words of the operator's window and as numbers of the report.
#pragma once

#include <vector>

#include "engine/app/live_light.h"
#include "engine/present/operator_window.h"

namespace heliodon::app {

// Outlines of what was detected, with names.
std::vector<present::OperatorOutline> outlinesOf(const geometry::Sketch& sketch, const geometry::Rig& rig);

// How long something took, again and again, seconds; what is kept does not grow with the hours.
class Durations {
public:
    void add(double seconds);
    bool empty() const { return count_ == 0; }
    double last() const { return last_; }
    nlohmann::json summary() const; // count and largest of all; median and p90 of the latest few thousand

private:
    std::vector<float> latest_; // a ring
    size_t count_ = 0;
    double last_ = 0, largest_ = 0;
};

struct LiveFigures {
    Durations wheelToLight; // from what the user did to all outputs showing it
    Durations photoToLight; // from a picture that shows a new table to all outputs showing it
    Durations solve;        // skies, light and what is read off it
    Durations draw;         // recording, drawing and presenting
    size_t frames = 0;

    void frameShown(); // now
    double framesPerSecond() const;

private:
    std::vector<LiveClock::time_point> latestFrames_; // of two seconds
};

nlohmann::json reportOf(const LiveStatus& status, const LiveFigures& figures);
// Time, sky and figures of the light that is shown.
nlohmann::json reportOf(const LitScene& lit, const passes::Tone& tone);

// A line each: name, value.
std::vector<std::pair<std::string, std::string>> factsOf(const LiveStatus& status, const LitScene* lit,
                                                         const LiveFigures& figures);

} // namespace heliodon::app
