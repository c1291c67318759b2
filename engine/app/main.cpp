#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <string>

#include <fmt/format.h>

#include "engine/app/arguments.h"
#include "engine/app/commands.h"
#include "engine/app/interrupt.h"
#include "engine/app/run.h"
#include "geometry/input_error.h"

namespace {

constexpr int kFailed = 1, kBadInput = 2;

int complain(const std::string& text, int code) {
    fmt::print(stderr, "heliodon: {}\n", text);
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

std::string textOf(const std::filesystem::filesystem_error& error) {
    return fmt::format("{}: {}", error.path1().string(), error.code().message());
}

int perform(heliodon::app::Run& run, const heliodon::app::Command& command) {
    std::string error;
    int code = 0;
    try {
        const heliodon::app::InterruptGuard guard;
        std::visit([&](const auto& arguments) { heliodon::app::execute(run, arguments); }, command);
    } catch (const heliodon::geometry::InputError& e) {
        code = complain(error = e.what(), kBadInput);
    } catch (const std::filesystem::filesystem_error& e) {
        code = complain(error = textOf(e), codeOf(e));
    } catch (const std::bad_alloc&) {
        code = complain(error = "out of memory", kFailed);
    } catch (const std::exception& e) {
        code = complain(error = e.what(), kFailed);
    }
    run.finish(error);
    return code;
}

} // namespace

int main(int argc, char** argv) {
    try {
        const auto arguments = heliodon::app::parseArguments(argc, argv);
        if (!arguments) return 0;
        heliodon::app::Run run(*arguments);
        return perform(run, arguments->command);
    } catch (const heliodon::geometry::InputError& e) {
        return complain(e.what(), kBadInput);
    } catch (const std::filesystem::filesystem_error& e) {
        return complain(textOf(e), codeOf(e));
    } catch (const std::exception& e) {
        return complain(e.what(), kFailed);
    }
}
