// Form factors by hemicube: what a point sees, pixel by pixel. Host half of shaders/hemicube*.comp. For each
// row the fraction F of what arrives at (leaves from) the row's viewpoints that comes from each patch. Cost:
// about 0.4 ms of one core a viewpoint at 64^2 with 2000 patches on a CPU device.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/gpu/buffer.h"
#include "compute/gpu/commands.h"
#include "compute/gpu/counters.h"
#include "compute/patch_points.h"
#include "geometry/patch_mesh.h"
#include "shaders/io/hemicube.io.h"

namespace heliodon::compute {

struct HemicubeOptions {
    uint32_t resolution = 64; // of the top face, pixels along one side; odd ones are rounded up
};

class Hemicube {
public:
    Hemicube(gpu::Device& device, const geometry::PatchMesh& mesh, const HemicubeOptions& options = {});

    struct Result {
        gpu::Buffer factors; // float32, rows x patches
        uint32_t rows = 0;
    };
    // Row r sums over viewpoints [r points, (r + 1) points) with equal weights. Waits for the device; submits
    // in windows that respect its limits.
    Result run(const std::vector<Viewpoint>& viewpoints, uint32_t points = 1);

    uint32_t resolution() const { return options_.resolution; } // as used: even

private:
    // One dispatch: `count` viewpoints, at most batch_. `factors` holds a window of rows in fixed point
    // (io::kHemicubeOneBits), which are added to; its first row is that of viewpoint `firstOfWindow`. The
    // item buffers are filled and waited for here; barriers on factors are the caller's, and so is to look at
    // cuts_ and begin the window again after shareMore().
    struct Inputs {
        const gpu::Buffer& viewpoints;
        uint32_t firstOfWindow = 0, first = 0, count = 0,
                 pointsPerRow = 1; // `first` counts from the window's
    };
    void record(gpu::Commands& commands, const Inputs& in, const gpu::Binding& factors);
    void uploadMesh(const geometry::PatchMesh& mesh);
    gpu::Buffer uploadViewpoints(const std::vector<Viewpoint>& viewpoints);
    void makeDeltas(uint32_t points);
    void shareMore(); // among invocations: the device ended loops early

    gpu::Device* device_;
    HemicubeOptions options_;
    glm::dvec3 centre_{0}; // subtracted from all positions before they become float32
    io::HemicubeParams params_{};
    uint32_t deltaPoints_ = 0;
    uint32_t batch_ = 1;
    uint32_t rasterParts_ = 1, sumParts_ = 1; // workgroups that share a viewpoint
    gpu::Counters cuts_;
    gpu::Buffer triangles_, deltas_, items_, lists_, counts_;
};

// Exact form factors of the pixels of a hemicube from a point to its top and one side, R x R and R/2 x R in
// lines, double precision; 4 sides + top sum to 1.
std::vector<double> hemicubeDeltas(uint32_t resolution);

} // namespace heliodon::compute
