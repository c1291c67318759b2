// Runs the program with a Vulkan layer that makes a chosen call fail: tests/gpu/fault/fault_layer.cpp.
#pragma once

#include <cstdlib>
#include <map>

#include "tests/app/program.h"

namespace heliodon::test {

struct FaultOutcome : Outcome {
    bool fired = false;               // the call that was to fail came
    std::string leftOver;             // objects that were never given back
    std::map<std::string, long> made; // objects by type
};

inline FaultOutcome heliodonWithFault(const std::string& fault, const std::string& arguments,
                                      const std::filesystem::path& folder) {
    const std::filesystem::path log = folder / "fault.log";
    std::filesystem::remove(log);
    setenv("VK_LAYER_PATH", HELIODON_FAULT_LAYER, 1);
    setenv("VK_INSTANCE_LAYERS", "VK_LAYER_HELIODON_fault", 1);
    setenv("HELIODON_FAULT_LOG", log.c_str(), 1);
    setenv("HELIODON_FAULT", fault.c_str(), 1);
    FaultOutcome outcome{heliodon(arguments)};
    for (const char* name : {"VK_LAYER_PATH", "VK_INSTANCE_LAYERS", "HELIODON_FAULT_LOG", "HELIODON_FAULT"})
        unsetenv(name);
    std::ifstream lines(log);
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("failed ")) outcome.fired = true;
        if (line.starts_with("left over: ")) outcome.leftOver += line + "\n";
        if (line.starts_with("made: ")) {
            const size_t type = line.rfind(' ') + 1;
            outcome.made[line.substr(type)] = std::stol(line.substr(6));
        }
    }
    return outcome;
}

} // namespace heliodon::test
