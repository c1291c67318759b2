// What a script of `live` asks for, one thing a line; empty lines and what follows # are passed over.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "compute/daylight/time.h"
#include "engine/present/presenter.h"

namespace heliodon::app {

// wait: until all that was asked for is shown on all outputs
struct WaitStep {};
// look TIMES: the same, once the table has been looked at so often since the start
struct LookStep {
    size_t times;
};
// sleep SECONDS
struct SleepStep {
    double seconds;
};
// time 2026-06-21T09:00solar
struct TimeStep {
    daylight::Moment time;
};
// sky overcast
struct SkyStep {
    std::string sky;
};
// wheel NOTCHES [shift] [ctrl]; key K (space, escape, letters)
struct EventStep {
    present::Event event;
};
// resize WINDOW WIDTH HEIGHT
struct ResizeStep {
    size_t window;
    int width, height;
};
// close WINDOW
struct CloseStep {
    size_t window;
};
// snapshot NAME
struct SnapshotStep {
    std::string name;
};
// quit
struct QuitStep {};

using ScriptStep = std::variant<WaitStep, LookStep, SleepStep, TimeStep, SkyStep, EventStep, ResizeStep,
                                CloseStep, SnapshotStep, QuitStep>;

// Windows are counted from 0, projectors in the rig's order, then the operator's. `weather`: there is a
// weather file, which "sky weather" shows. Throws InputError naming file and line.
std::vector<ScriptStep> readScript(const std::filesystem::path& file, size_t windows, bool weather);

} // namespace heliodon::app
