// Form factors from points with a normal (sensors) to patches: the share of what arrives at the point that
// comes from each patch, F(x, j) = int_j V cos cos / (pi r^2). Kernel `exact` at one point: what is visible
// is found as exact polygons and integrated in closed form (Lambert), so there is neither noise nor a
// resolution.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/patch_mesh.h"

namespace heliodon::gpu {
class Device;
}

namespace heliodon::compute {

struct SurfacePoint {
    glm::dvec3 position{0}, normal{0, 1, 0}; // in the air or on a surface of the room; unit
    uint32_t room = 0;                       // whose patches it sees
};

// Holds the scene on the device, so repeated calls only pay for their points.
class ExactPointFactors {
public:
    ExactPointFactors(gpu::Device& device, const geometry::PatchMesh& mesh);
    ~ExactPointFactors();
    ExactPointFactors(ExactPointFactors&&) noexcept;

    // points x patches, row-major; error about 1e-6, exact zeros exactly zero. In a closed room a row sums to
    // 1, to 1e-5. Patches in whose plane a point lies are not seen from it and do not block. Cost: points x
    // patches x the blockers that rise above the point's horizon (planes with the whole room on one side are
    // none): about 1 us a pair behind ten.
    std::vector<float> run(std::span<const SurfacePoint> points);

    // Of the last run: how often a patch fell apart into more pieces than can wait, so that its factor may be
    // too small.
    uint64_t overflows() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace heliodon::compute
