#include <csignal>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <variant>

#include <fmt/format.h>

#include "compute/gpu/candidates.h"
#include "engine/app/arguments.h"
#include "engine/app/commands.h"
#include "engine/app/console.h"
#include "engine/app/interrupt.h"
#include "engine/app/run.h"
#include "geometry/input_error.h"
#include "geometry/whole_file.h"

namespace {

constexpr int kFailed = 1, kBadInput = 2;

int complain(const std::string& text, int code) {
    heliodon::app::say(fmt::format("heliodon: {}\n", text));
    return code;
}

// A path that cannot be is bad input, whoever came upon it; a disk that fails is not.
int codeOf(const std::filesystem::filesystem_error& error) {
    for (const std::errc why :
         {std::errc::permission_denied, std::errc::filename_too_long, std::errc::not_a_directory,
          std::errc::too_many_symbolic_link_levels, std::errc::read_only_file_system})
        if (error.code() == why) return kBadInput;
    return kFailed;
}

// The exit code; `error` becomes what was complained of, if anything.
template<class Work> int guarded(std::string& error, const Work& work) {
    try {
        work();
        return 0;
    } catch (const heliodon::geometry::InputError& e) {
        return complain(error = e.what(), kBadInput);
    } catch (const std::filesystem::filesystem_error& e) {
        return complain(error = fmt::format("{}: {}", e.path1().string(), e.code().message()), codeOf(e));
    } catch (const std::bad_alloc&) {
        return complain(error = "out of memory", kFailed);
    } catch (const std::exception& e) {
        return complain(error = e.what(), kFailed);
    }
}

using heliodon::app::Command;

// Those that would never find out that --device names none.
bool opensNoDevice(const Command& command) {
    using namespace heliodon::app;
    return std::holds_alternative<DetectArguments>(command) ||
           std::holds_alternative<ModelArguments>(command) ||
           std::holds_alternative<CalibrateTargetArguments>(command) ||
           std::holds_alternative<CalibrateCameraArguments>(command) ||
           std::holds_alternative<CalibratePatternsArguments>(command) ||
           std::holds_alternative<CalibrateProjectorArguments>(command) ||
           std::holds_alternative<DevicesArguments>(command);
}

void refuseUnknownDevice(const std::string& select) {
    std::string there;
    for (const heliodon::gpu::DeviceInfo& info : heliodon::gpu::listDevices()) {
        if (heliodon::gpu::isNamed(info, select)) return;
        there += fmt::format("{}{} {}", there.empty() ? "" : ", ", info.index, info.name);
    }
    throw heliodon::geometry::InputError("--device", select,
                                         "names no Vulkan device, expected one of: " + there);
}

} // namespace

int main(int argc, char** argv) {
    // A file that outgrows the limit on its size (ulimit -f) is an error of writing, as on a full disk.
    std::signal(SIGXFSZ, SIG_IGN);
    heliodon::app::keepStandardStreams();
    int code = 0;
    std::string unreported;
    const int outside = guarded(unreported, [&] {
        const auto arguments = heliodon::app::parseArguments(argc, argv);
        if (!arguments) return heliodon::app::refuseLostOutput(); // help
        const heliodon::app::InterruptGuard guard; // also of the report, and while the device is given back
        heliodon::app::Run run(*arguments);
        std::string error;
        code = guarded(error, [&] {
            // Before the work, not after it.
            for (const auto& file : arguments->common.resultFiles) heliodon::geometry::refuseUnwritable(file);
            const std::string& device = arguments->common.device;
            if (!device.empty() && opensNoDevice(arguments->command)) refuseUnknownDevice(device);
            std::visit([&](const auto& those) { heliodon::app::execute(run, those); }, arguments->command);
            heliodon::app::refuseLostOutput();
        });
        run.finish(error);
    });
    return outside != 0 ? outside : code;
}
