// What one product F B costs beside the same product on the processor.
#pragma once

#include <vector>

#include "compute/gpu/device.h"
#include "compute/roofline.h"
#include "engine/app/bench_results.h"
#include "geometry/patch_mesh.h"

namespace heliodon::app {

// For 1 and 3 columns, the median of 21 runs after one that is not counted; the scene's name is left empty.
std::vector<GatherResult> benchGather(gpu::Device& device, const geometry::PatchMesh& mesh,
                                      const compute::Roofline& roofline);

} // namespace heliodon::app
