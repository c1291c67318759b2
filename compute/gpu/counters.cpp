#include "compute/gpu/counters.h"

#include <utility>

#include "compute/gpu/commands.h"
#include "compute/gpu/device.h"

namespace heliodon::gpu {

Counters::Counters(Device& device, uint32_t count, const std::string& name)
    : device_(&device), onDevice_(device, count * sizeof(uint32_t), name),
      read_(device, count * sizeof(uint32_t), name + " read", Place::host) {}

void Counters::clear(Commands& commands) const {
    commands.fill(onDevice_, 0);
    commands.barrier(Stage::transfer, Stage::compute);
}

void Counters::submitAndRead(Commands&& commands) {
    commands.barrier(Stage::compute, Stage::any);
    commands.copy(onDevice_, 0, read_, 0, onDevice_.bytes());
    device_->submitAndWait(std::move(commands));
}

} // namespace heliodon::gpu
