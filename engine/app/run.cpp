#include "engine/app/run.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "compute/gpu/error.h"
#include "engine/app/console.h"
#include "engine/app/interrupt.h"
#include "geometry/input_error.h"
#include "geometry/text_file.h"
#include "geometry/whole_file.h"

namespace heliodon::app {

using nlohmann::json;

namespace {

// Said once, however often a loop says it. False when it was there.
bool addOnce(json& list, const std::string& text) {
    if (std::find(list.begin(), list.end(), text) != list.end()) return false;
    list.push_back(text);
    return true;
}

} // namespace

Run::Run(const Arguments& arguments)
    : deviceName_(arguments.common.device), reportFile_(arguments.common.report),
      readFiles_(arguments.common.readFiles), quiet_(arguments.common.quiet),
      heartbeat_(!quiet_ && arguments.commandName != "live") { // which says in its windows what it does
    report_ = {{"program", "heliodon"},    {"version", HELIODON_VERSION}, {"command", arguments.commandName},
               {"stages", json::object()}, {"modelled", json::array()},   {"skipped", json::array()},
               {"warnings", json::array()}};
    const std::filesystem::path folder = reportFile_.parent_path();
    reportsAmongResults_ = std::ranges::any_of(arguments.common.outputFolders, [&](const auto& output) {
        return geometry::isSamePlace(folder, output);
    });
    if (!reportFile_.empty() && !reportsAmongResults_)
        geometry::refuseUnwritable(reportFile_); // now, not after the work
}

gpu::Device& Run::device() {
    if (!device_) {
        const StageTimer timer(*this, "device");
        device_ = anotherDevice();
        const gpu::DeviceInfo& info = device_->info();
        report_["device"] = {
            {"name", info.name}, {"type", info.type}, {"driver", info.driver}, {"index", info.index}};
    }
    return *device_;
}

std::unique_ptr<gpu::Device>
Run::anotherDevice(const std::function<gpu::DeviceOptions(gpu::DeviceOptions)>& adapt) const {
    gpu::DeviceOptions options;
    options.select = deviceName_;
    options.beforeSubmit = throwIfInterrupted;
    if (adapt) options = adapt(std::move(options));
    try {
        return std::make_unique<gpu::Device>(options);
    } catch (const gpu::NoDevice& error) {
        if (deviceName_.empty()) throw;
        std::string why = error.what(); // a name that fits no device: which there are, in one line
        for (size_t at; (at = why.find('\n')) != std::string::npos;) why.replace(at, 1, "");
        throw geometry::InputError("--device", deviceName_, why);
    }
}

void Run::willWrite(const std::filesystem::path& folder, const std::vector<std::string>& names) {
    willWrite([&](const std::filesystem::path& place) {
        return std::ranges::any_of(
            names, [&](const std::string& name) { return geometry::leadsTo(folder / name, place); });
    });
}

void Run::willWrite(const std::function<bool(const std::filesystem::path&)>& isWritten) {
    const auto isResult = [&](const std::filesystem::path& file) {
        const std::filesystem::path place = geometry::placeOf(file);
        return !place.empty() && isWritten(place);
    };
    if (isResult(reportFile_))
        throw geometry::InputError("--report", std::exchange(reportFile_, {}).string(),
                                   "is the name of a result, expected another, like report.json");
    for (const std::filesystem::path& file : readFiles_)
        if (isResult(file))
            throw geometry::InputError(file.string(), "",
                                       "is read, and a result has its name: expected another folder");
}

void Run::note(const std::string& text) {
    if (quiet_) return;
    heartbeat_.wipe();
    say(text + "\n");
}

void Run::assume(const std::string& what, bool aloud) {
    const std::string before = report_.value("assumed", "");
    if (before.find(what) != std::string::npos) return; // a finer mesh of the same input
    report_["assumed"] = before.empty() ? what : before + ", " + what;
    if (aloud) assumed_ += (assumed_.empty() ? "" : ", ") + what;
}

void Run::noteAssumed() {
    if (!assumed_.empty()) note("assumed: " + geometry::printable(assumed_));
    assumed_.clear();
}

void Run::warn(const std::string& text) {
    if (isNewWarning(text)) note("warning: " + geometry::printable(text));
}

void Run::warnAgain(const std::string& text) {
    isNewWarning(text);
    note("warning: " + geometry::printable(text));
}

bool Run::isNewWarning(const std::string& text) {
    json& warnings = report_["warnings"];
    if (!addOnce(warnings, text)) return false;
    if (warnings.size() > kMostWarnings) {
        warnings.erase(warnings.begin());
        report_["warnings_left_out"] = report_.value("warnings_left_out", size_t{0}) + 1;
    }
    return true;
}

void Run::warnOfEach(const std::vector<std::string>& texts) {
    constexpr size_t kShown = 12;
    size_t count = 0;
    for (const std::string& text : texts)
        if (isNewWarning(text) && ++count <= kShown) note("warning: " + geometry::printable(text));
    if (count > kShown)
        note(fmt::format("warning: {} more like these; {}", count - kShown,
                         reportFile_.empty() ? "--report lists them" : "the report lists them"));
}

void Run::modelled(const std::string& what) {
    addOnce(report_["modelled"], what);
}

void Run::skipped(const std::string& whatAndWhy) {
    addOnce(report_["skipped"], whatAndWhy);
}

void Run::addStageSeconds(const std::string& stage, double seconds) {
    json& entry = report_["stages"][stage];
    entry = (entry.is_number() ? entry.get<double>() : 0.0) + seconds;
}

void Run::beginStage(const std::string& stage) {
    throwIfInterrupted(); // stages on the processor ask nowhere else
    heartbeat_.begin(stage);
}

void Run::endStage(const std::string& stage, double seconds) {
    heartbeat_.end(stage);
    addStageSeconds(stage, seconds);
}

void Run::finish(const std::string& error) {
    if (error.empty()) noteAssumed(); // commands without light
    if (reportFile_.empty()) return;
    report_["seconds"] = watch_.seconds();
    if (!error.empty()) report_["error"] = error;
    if (device_) report_["device"]["peak_bytes"] = device_->memory().peakBytesInUse();
    if (std::error_code told; reportsAmongResults_) // as one that is not there
        std::filesystem::create_directories(reportFile_.parent_path(), told);
    geometry::writeWholeText(reportFile_, geometry::jsonText(report_));
}

} // namespace heliodon::app
