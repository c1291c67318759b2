// What a script of `live` asks for, one thing a line; empty lines and what follows # are passed over.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "compute/daylight/time.h"
#include "engine/present/presenter.h"

namespace heliodon::app {

struct WaitStep {}; // wait: until all that was asked for is shown on all outputs
struct LookStep {
    size_t times;
}; // look TIMES: the same, once the table has been looked at so often since the start
struct SleepStep {
    double seconds;
}; // sleep SECONDS
struct TimeStep {
    daylight::Moment time;
}; // time 2026-06-21T09:00solar
struct SkyStep {
    std::string sky;
}; // sky overcast
struct EventStep {
    present::Event event;
}; // wheel NOTCHES [shift] [ctrl]; key K (space, escape, letters)
struct ResizeStep {
    size_t window;
    int width, height;
}; // resize WINDOW WIDTH HEIGHT
struct CloseStep {
    size_t window;
}; // close WINDOW
struct SnapshotStep {
    std::string name;
};                  // snapshot NAME
struct QuitStep {}; // quit

using ScriptStep = std::variant<WaitStep, LookStep, SleepStep, TimeStep, SkyStep, EventStep, ResizeStep,
                                CloseStep, SnapshotStep, QuitStep>;

// Windows are counted from 0, projectors in the rig's order, then the operator's. `weather`: there is a
// weather file, which "sky weather" shows. Throws InputError naming file and line.
std::vector<ScriptStep> readScript(const std::filesystem::path& file, size_t windows, bool weather);

} // namespace heliodon::app
