// Tiles of kernel `exact` as its callers get them: of patches, whatever pieces they were cut into.
#pragma once

#include <functional>

#include "compute/exact_form_factors.h"
#include "compute/exact_scene.h"

namespace heliodon::compute {

// Hands over one half of a pair of tiles: rows of `a`, columns of `b`. Where patches were cut into pieces,
// F_IJ = sum_i A_i / A_I sum_j F_ij.
void handOver(const ExactScene& scene, const ExactTileRange& a, const ExactTileRange& b,
              const gpu::Buffer& values, const std::function<void(const ExactTile&)>& take);

// Writes it to its place in `matrix`, of all patches; on the device where the host does not see its memory.
void placeTile(gpu::Device& device, const ExactScene& scene, const ExactTileRange& a, const ExactTileRange& b,
               const gpu::Buffer& values, gpu::Buffer& matrix);

} // namespace heliodon::compute
