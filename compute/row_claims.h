// What a finished matrix shows of its errors that its kernel does not know of: each raises
// FormFactorReport::claimedRowError, and warns where users can do something about it.
#pragma once

#include <optional>
#include <span>

#include "compute/form_factors.h"

namespace heliodon::compute {

// A matrix that is brought to the host when it is first asked for: few have anything to be claimed.
class MatrixOnHost {
public:
    // `count` floats of `values`, which outlives it.
    MatrixOnHost(const gpu::Buffer& values, size_t count) : values_(&values), count_(count) {}
    const float* data() const {
        if (!view_) view_.emplace(*values_, count_);
        return view_->data();
    }
    float operator[](size_t k) const { return data()[k]; }

private:
    const gpu::Buffer* values_;
    size_t count_;
    mutable std::optional<gpu::HostView<float>> view_;
};

// Rows that sum to more than one, beyond what is claimed of sums; `rowSums` has one a patch.
void claimExcess(std::span<const double> rowSums, FormFactorReport& report);

// Faces in one place (patchesInOnePlace); `F` is n x n, row-major. n a face.
void claimDuplicates(const geometry::PatchMesh& mesh, const MatrixOnHost& F, FormFactorReport& report);

// Faces that share an edge and open by less than float32 tells from a plane. n log n.
void claimWedges(const geometry::PatchMesh& mesh, const MatrixOnHost& F, FormFactorReport& report);

// What F has not of the light between sheets that cross (crossedGaps), which float32 takes for one plane:
// they get the room's light instead.
void claimCrossings(const geometry::PatchMesh& mesh, const MatrixOnHost& F, FormFactorReport& report);

// Of `montecarlo`: narrow gaps, and strips along the feet of walls.
void claimWhatRaysMiss(const geometry::PatchMesh& mesh, FormFactorReport& report);

} // namespace heliodon::compute
