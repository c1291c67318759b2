#include <cstdio>

#include <fmt/format.h>

#include "engine/app/commands.h"

namespace heliodon::app {

void execute(Run& run, const DevicesArguments&) {
    nlohmann::json& list = run.report()["devices"] = nlohmann::json::array();
    const std::vector<gpu::DeviceInfo> devices = gpu::listDevices();
    std::FILE* const out = run.reportsToOutput() ? stderr : stdout;
    for (const gpu::DeviceInfo& d : devices) {
        fmt::print(out, "{}  {:<10}  {}  ({})\n   {}\n", d.index, d.type, d.name, d.driver,
                   d.refused.empty() ? "usable" : "refused: " + d.refused);
        list.push_back({{"index", d.index},
                        {"name", d.name},
                        {"type", d.type},
                        {"driver", d.driver},
                        {"refused", d.refused}});
    }
}

} // namespace heliodon::app
