// What `live` has to say, in the words of the operator's window and as numbers of the report.
#pragma once

#include <vector>

#include "engine/app/live_light.h"
#include "engine/present/operator_window.h"

namespace heliodon::app {

// Outlines of what was detected, with names.
std::vector<present::OperatorOutline> outlinesOf(const geometry::Sketch& sketch, const geometry::Rig& rig);

// The last few durations of something, seconds.
class Durations {
public:
    void add(double seconds) { all_.push_back(static_cast<float>(seconds)); }
    bool empty() const { return all_.empty(); }
    double last() const { return all_.empty() ? 0 : all_.back(); }
    nlohmann::json summary() const; // count, median, p90 and largest, seconds

private:
    std::vector<float> all_;
};

struct LiveFigures {
    Durations wheelToLight; // from what the user did to all outputs showing it
    Durations photoToLight; // from a picture that shows a new table to all outputs showing it
    Durations solve;        // skies, light and what is read off it
    Durations draw;         // recording, drawing and presenting
    double framesPerSecond = 0;
    size_t frames = 0;
};

// A line each: name, value.
std::vector<std::pair<std::string, std::string>> factsOf(const LiveStatus& status, const LitScene* lit,
                                                         const LiveFigures& figures);

} // namespace heliodon::app
