// Light of rooms that goes out by windows and comes back, in by these or others, from what stands before them
// (OutsideReflection). A patch that gets w of a cell's exitance through glass sends it w A_patch / A_cell of
// its own, so what patches see of cells tells both ways:
//   E_patch = W X A_cells^-1 W^T A_patches M_patch,  X = (1 - rho F)^-1 rho of the cells
// It keeps reciprocity as far as the cells' own form factors do. What is not seen straight through, as by way
// of fabrics, is left out, and so is the ground of an open field.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/outside_reflection.h"
#include "compute/point_scene.h"

namespace heliodon::compute {

// What of that may be off: cells are lit as their centres are, by windows right before them too.
constexpr double kReturnUnsure = 0.1;

class OutsideReturn {
public:
    // All outlive this. `patchWalls` (PatchSky::walls): empty where there are no cells, and all is nothing at
    // no cost.
    OutsideReturn(const geometry::PatchMesh& mesh, const OutsideReflection& reflection,
                  std::span<const std::vector<OutsideShare>> patchWalls);

    bool isEmpty() const { return seen_.empty(); }
    // out += what comes back to patches of their exitance `in`, in one channel. Some 0.3 ms.
    void add(uint32_t channel, std::span<const float> in, std::span<float> out) const;
    // The same for a place that sees these cells, from each patch.
    std::vector<TintedShare> rowOf(std::span<const OutsideShare> own) const;
    // Per patch and channel, what comes back of an exitance of 1 all round; empty where nothing does.
    std::vector<glm::vec3> rowSums() const;

private:
    const OutsideReflection* reflection_;
    std::span<const std::vector<OutsideShare>> seen_; // by patches
    std::vector<double> area_, cellArea_;
};

} // namespace heliodon::compute
