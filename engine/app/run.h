// One run of one command: its device, its clock, its report and what it says on the way.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "compute/gpu/device.h"
#include "compute/stopwatch.h"
#include "engine/app/arguments.h"
#include "engine/app/progress.h"

namespace heliodon::app {

class Run {
public:
    Run(const Arguments& arguments);

    // The Vulkan device, made at the first call: commands that need none start without one.
    gpu::Device& device();

    // One more on the same hardware, for work in another thread, or with what `adapt` adds to its options.
    std::unique_ptr<gpu::Device>
    anotherDevice(const std::function<gpu::DeviceOptions(gpu::DeviceOptions)>& adapt = {}) const;

    nlohmann::json& report() { return report_; } // fields of the command's own
    void note(const std::string& text);          // to stderr unless --quiet
    // To stderr unless --quiet, and to the report: the latest of them, which a display that runs for days
    // goes on collecting, and in `warnings_left_out` how many were before.
    static constexpr size_t kMostWarnings = 1000;
    void warn(const std::string& text);
    void warnAgain(const std::string& text); // the same, said however often it happens
    // Of many of one kind, as of a picture of something else, the first few are shown.
    void warnOfEach(const std::vector<std::string>& texts);
    // What stands in for options not given, said once: to the report and, if `aloud`, to noteAssumed, which
    // is called when all input has been read: errors of input stand alone.
    void assume(const std::string& what, bool aloud = true);
    void noteAssumed();
    void modelled(const std::string& what);
    void skipped(const std::string& whatAndWhy);
    bool showsProgress() const { return !quiet_; }
    // Of what will be written into `folder`, before the work: throws InputError where a name is the report's,
    // and writes none, or of a file that is read.
    void willWrite(const std::filesystem::path& folder, const std::vector<std::string>& names);
    // The same of whatever lies at a place, a geometry::placeOf(), of which this is true.
    void willWrite(const std::function<bool(const std::filesystem::path&)>& isWritten);
    // Nothing else may stand there.
    bool reportsToOutput() const { return reportFile_ == "-" || reportFile_ == "/dev/stdout"; }
    // What is at work is shown while it takes long; see StageTimer. Throws Interrupted.
    void beginStage(const std::string& stage);
    void endStage(const std::string& stage, double seconds);
    void addStageSeconds(const std::string& stage, double seconds); // adds up over several calls

    // The report with total seconds, and `error` when the run failed; written whole, only with --report.
    void finish(const std::string& error = "");

private:
    bool isNewWarning(const std::string& text); // and if so, adds it

    std::string deviceName_;
    std::filesystem::path reportFile_;
    bool reportsAmongResults_ = false; // in a folder that this run may make
    std::vector<std::filesystem::path> readFiles_;
    bool quiet_;
    nlohmann::json report_;
    std::string assumed_; // not yet noted
    std::unique_ptr<gpu::Device> device_;
    compute::Stopwatch watch_;
    Heartbeat heartbeat_;
};

// Measures from construction to destruction, adds to `stages` in the report, and shows that it goes on. An
// interrupted run begins none: the constructor throws Interrupted.
class StageTimer {
public:
    StageTimer(Run& run, std::string stage) : run_(run), stage_(std::move(stage)) { run_.beginStage(stage_); }
    ~StageTimer() { run_.endStage(stage_, watch_.seconds()); }
    StageTimer(const StageTimer&) = delete;
    StageTimer& operator=(const StageTimer&) = delete;

private:
    Run& run_;
    std::string stage_;
    compute::Stopwatch watch_;
};

} // namespace heliodon::app
