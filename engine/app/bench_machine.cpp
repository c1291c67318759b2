#include "engine/app/bench_machine.h"

#include <algorithm>
#include <fstream>

#include <unistd.h>

namespace heliodon::app {

namespace {

// Seconds that all cores have been busy, where the system counts them; else 0.
double busySeconds() {
    std::ifstream file("/proc/stat");
    std::string name;
    double user = 0, nice = 0, system = 0, idle = 0, waiting = 0, interrupts = 0, soft = 0, stolen = 0;
    file >> name >> user >> nice >> system >> idle >> waiting >> interrupts >> soft >> stolen;
    return (user + nice + system + interrupts + soft + stolen) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

} // namespace

std::string processorName() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (const size_t colon = line.find(": ");
            line.starts_with("model name") && colon != std::string::npos)
            return line.substr(colon + 2);
    return "";
}

void resetPeakMemory() {
    std::ofstream("/proc/self/clear_refs") << "5";
}
double peakMemory() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) return 1024 * std::stod(line.substr(6));
    return 0;
}

OtherWork::OtherWork() : before_(busySeconds()) {}

double OtherWork::cores() const {
    double wall = 0, own = 0;
    clock_.stop(wall, own);
    return std::max(0.0, (busySeconds() - before_ - own) / wall);
}

} // namespace heliodon::app
