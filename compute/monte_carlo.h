// Kernel `montecarlo`: rays from random points on each patch, cosine-distributed, to what they meet first.
// Host half of shaders/monte_carlo.comp. Unbiased and blind to nothing that a ray can hit, so an independent
// check of the others and a fallback for scenes that suit none. Points are Owen-scrambled Sobol in four
// dimensions (A. B. Owen, 1995; direction numbers of S. Joe and F. Kuo, 2008) under a random digital shift
// for each patch; two independent halves give an error for each row.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "compute/bvh.h"
#include "compute/form_factors.h"
#include "compute/gpu/counters.h"
#include "compute/gpu/kernel.h"
#include "shaders/io/monte_carlo.io.h"

namespace heliodon::compute {

struct MonteCarloOptions {
    uint32_t rays = 4096; // a patch; taken to the next power of two in [64, 65536]
};

// How far hits scatter, of a row or of several together; squared, in form factors. Entries of a row are few
// where patches are few, and both halves of the rays may then agree by luck: what independent rays do, which
// low discrepancy does not exceed, bounds what they say.
struct MonteCarloSpread {
    double halves = 0;  // the halves' difference: of the error, by its expectation
    double rays = 0;    // the error of independent rays, by its expectation
    double squares = 0; // of what single entries are of `rays`

    void add(const MonteCarloSpread& other);

    double estimate() const; // of the root of the error's square
    double claim() const;    // below which it is in 99 of 100 cases
};

struct MonteCarloFormFactors {
    FormFactors factors;                // report.claimedRowError is a claim
    std::vector<MonteCarloSpread> rows; // per patch, of ||F_i - true||
};

class MonteCarlo {
public:
    MonteCarlo(gpu::Device& device, const geometry::PatchMesh& mesh, const MonteCarloOptions& options = {});

    uint32_t rays() const { return 2 * params_.halfRays; }

    // The whole matrix, both measurements of each pair combined: A_i F_ij = A_j F_ji. Rays cost about 0.1 us
    // of one core each on a CPU device.
    MonteCarloFormFactors run();

    // Standard error of an entry of run()'s matrix, from the hits that it stands for: that of independent
    // rays, which low discrepancy does not exceed; where none hit, of one. 95 of 100 entries are within two
    // of it, 99 within three.
    static double entryError(double factor, double areaFrom, double areaTo, uint32_t rays);

    // Rows [first, first + count) alone, from their own rays; values: count x patchCount, spreads: count.
    void rows(uint32_t first, uint32_t count, std::span<float> values, std::span<MonteCarloSpread> spreads);

private:
    void uploadEmitters(const geometry::PatchMesh& mesh);
    void trace(const gpu::Buffer& counts, uint32_t firstInBuffer, uint32_t first, uint32_t count);
    // False where the device ended loops early: the counts are worth nothing then.
    bool traceInParts(const gpu::Buffer& counts, uint32_t firstInBuffer, uint32_t first, uint32_t count);
    void sendFewerEach();
    void combine(const gpu::Buffer& counts, const gpu::Buffer& spreads);
    uint32_t windowRows() const;
    MonteCarloSpread spreadOf(const glm::dvec3& hits) const;

    gpu::Device* device_;
    Bvh bvh_;
    gpu::Kernel trace_, combine_;
    gpu::Buffer emitters_, points_, areas_;
    gpu::Counters cuts_;
    io::MonteCarloParams params_{}; // but for rows and the first ray
};

// Of the scene's diagonal: planes that rays do not tell from the one that they leave. Heights over its own
// plane of what lies in it are rounded by 1.2e-7 at most, of millions of places in planes turned at random.
constexpr double kMonteCarloInPlane = 2e-7;

// Half the points of a patch: two coordinates of direction and two of place as fractions of 2^32. Any
// 2^keptBits x 2^keptBits cells of directions hold equally many.
std::vector<glm::uvec4> monteCarloPoints(uint32_t halfRays);
uint32_t monteCarloKeptBits(uint32_t halfRays);

} // namespace heliodon::compute
