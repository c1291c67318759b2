// The two rates that bound every kernel on a device, measured on it: host half of shaders/roofline.comp.
// Williams, Waterman and Patterson, Roofline: an insightful visual performance model, CACM 52(4), 2009.
#pragma once

#include "compute/gpu/device.h"

namespace heliodon::compute {

struct Roofline {
    double flopsPerSecond = 0; // float32 multiply-adds out of registers, two operations each
    double bytesPerSecond = 0; // reading a texel buffer of 256 MiB (or the most that the device takes) once

    // The least time for so much work, whichever rate bounds it.
    double seconds(double flops, double bytes) const;
};

// Best of five runs of each; about 0.3 s on two cores.
Roofline measureRoofline(gpu::Device& device);

} // namespace heliodon::compute
