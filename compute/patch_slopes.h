// How light runs across each patch, from the values of the patches around it: the constant per patch that
// radiosity solves for, made linear within the patch without changing its mean.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/patch_mesh.h"

namespace heliodon::compute {

class PatchSlopes {
public:
    struct Term {
        uint32_t patch;
        glm::vec3 weight; // 1/m, in the patch's plane
    };

    // A least-squares fit over the patches of the same surface and material that share a corner; along their
    // row where they do not span the plane, none where there are none.
    explicit PatchSlopes(const geometry::PatchMesh& mesh);

    // The slope of a field across patch i is the sum of weight * value over these.
    std::span<const Term> terms(size_t i) const {
        return {terms_.data() + first_[i], first_[i + 1] - first_[i]};
    }

private:
    std::vector<size_t> first_{0};
    std::vector<Term> terms_;
};

} // namespace heliodon::compute
