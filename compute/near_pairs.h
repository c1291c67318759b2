// Pairs of patches of one room so near to one another that it matters where on a patch its light is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "compute/gpu/buffer.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

class NearPairs {
public:
    static constexpr float kFar = 1e-3F;      // form factor below which the place of light does not matter
    static constexpr float kNear = 0.02F;     // and from which its shape does
    static constexpr float kAcrossGap = 0.4F; // of a patch that faces another across a gap as wide as patches

    // `factors`: float32, patchCount^2, row-major. Keeps 8 bytes a pair, about a hundred pairs a patch.
    NearPairs(const geometry::PatchMesh& mesh, const gpu::Buffer& factors);

    struct Pair {
        uint32_t to;
        float factor; // from `to` to the patch that sends
    };
    // Those that get light of a patch: from kFar on, from kNear on.
    std::span<const Pair> of(size_t sender) const {
        return {pairs_.data() + first_[sender], first_[sender + 1] - first_[sender]};
    }
    std::span<const Pair> nearest(size_t sender) const { return of(sender).first(near_[sender]); }
    // The largest of their factors; 0 without any. Above kAcrossGap in slots that the mesh does not resolve.
    float largest(size_t sender) const { return largest_[sender]; }

private:
    std::vector<size_t> first_, near_;
    std::vector<Pair> pairs_;
    std::vector<float> largest_;
};

} // namespace heliodon::compute
