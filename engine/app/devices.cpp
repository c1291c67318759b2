#include <fmt/format.h>

#include "engine/app/commands.h"
#include "engine/app/console.h"

namespace heliodon::app {

void execute(Run& run, const DevicesArguments&) {
    nlohmann::json& list = run.report()["devices"] = nlohmann::json::array();
    const std::vector<gpu::DeviceInfo> devices = gpu::listDevices();
    for (const gpu::DeviceInfo& d : devices) {
        const std::string text =
            fmt::format("{}  {:<10}  {}  ({})\n   {}\n", d.index, d.type, d.name, d.driver,
                        d.refused.empty() ? "usable" : "refused: " + d.refused);
        run.reportsToOutput() ? say(text) : fmt::print("{}", text);
        list.push_back({{"index", d.index},
                        {"name", d.name},
                        {"type", d.type},
                        {"driver", d.driver},
                        {"refused", d.refused}});
    }
}

} // namespace heliodon::app
