// Form factors for light that runs on across patches. A patch that is brighter at one end sends more to what
// lies before that end than its mean would, most of all in corners and in shafts, which were too bright
// below. How light runs across a patch follows from the patches around it (PatchSlopes), so that this, too,
// is linear in the light of patches and goes into the matrix:
//   F' b = F b + F (r s) + N s,   s = the slopes of b
// N_ij: the first moment of F_ij over patch j, of pairs that are near to one another; r_j: what all others
// get less (or more) of j for that, in proportion, since each patch sends out as much as before.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/gpu/buffer.h"
#include "compute/near_pairs.h"
#include "compute/patch_slopes.h"
#include "compute/point_scene.h"

namespace heliodon::compute {

class SlopedFactors {
public:
    // `factors`: float32, patchCount^2, row-major, F between patches that see one another, of these
    // `rowSums`; becomes F', with the same sums of rows. `slopes` and `pairs` outlive this. Openings are
    // taken for even. What stands between near patches is taken to hide all of one alike. About 0.06 s of one
    // core at 2000 patches.
    SlopedFactors(const PointScene& scene, const PatchSlopes& slopes, const NearPairs& pairs,
                  std::span<const float> rowSums, gpu::Buffer& factors);

    // Per patch: sum of what is below nought in its row of F'.
    std::span<const float> negative() const { return negative_; }

    // What F' makes in error of light that does not run on, as that of sunlit spots, is taken back: of what
    // patches nearby get, from `lux`; the rest is `sent` less, exitance that F' is still to be applied to,
    // without links through windows (which errs by what slopes make of slopes).
    void takeBack(std::span<const glm::vec3> exitance, std::span<glm::vec3> lux,
                  std::span<glm::vec3> sent) const;

    // The same of importance, per area, of which A^-1 F'^T A makes `within`: from `gathered`. Columns x patches
    // each; eight columns at a time, about 0.2 ms of one core a column at 2000 patches.
    void takeBackImportance(std::span<const float> importance, std::span<const float> within,
                            std::span<float> gathered) const;

private:
    void takeBackTogether(std::span<const float> importance, std::span<const float> within,
                          std::span<float> gathered) const;
    void findMoments(const PointScene& scene, uint32_t sender, float rowSum);
    void putInto(std::span<float> factors);

    const PatchSlopes* slopes_;
    const NearPairs* pairs_;
    std::vector<float> area_;
    std::vector<size_t> first_;   // of near_, by sender
    std::vector<glm::vec3> near_; // N, less what r has of F_ij: in the order of NearPairs
    std::vector<glm::vec3> rest_; // r
    std::vector<float> negative_;
};

} // namespace heliodon::compute
