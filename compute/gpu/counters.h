// Counters that kernels raise by atomic operations and the host reads after each submission. They lie with
// the device, whose atomic operations on the host's memory are slow, and are copied.
#pragma once

#include <cstdint>
#include <string>

#include "compute/gpu/buffer.h"

namespace heliodon::gpu {

class Commands;

class Counters {
public:
    Counters() = default;
    Counters(Device& device, uint32_t count, const std::string& name);

    const Buffer& buffer() const { return onDevice_; } // of `count` words, to bind

    // All to zero, before the kernels recorded after it; what was filled before it is ready for them, too.
    void clear(Commands& commands) const;
    // Submits, waits, and reads the counters. All that the commands wrote is there for the host.
    void submitAndRead(Commands&& commands);

    // As read last.
    uint32_t operator[](uint32_t index) const { return read_.mapped<uint32_t>()[index]; }

private:
    Device* device_ = nullptr;
    Buffer onDevice_, read_;
};

} // namespace heliodon::gpu
