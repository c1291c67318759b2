// The device that every GPU test uses: validation and synchronization validation on, any message fails the
// test at hand.
#pragma once

#include "compute/gpu/device.h"

namespace heliodon::test {

gpu::Device& device();

} // namespace heliodon::test
