// The sky cut into patches of nearly equal solid angle, after Tregenza (145 patches, subdivision 1) and
// Reinhart's subdivision of it (577 and 2305 patches for 2 and 4), in Radiance's convention: rows are alpha =
// 90 / (7 MF + 0.5) degrees high from the horizon up, row r has {30, 30, 24, 24, 18, 12, 6}[r / MF] * MF
// patches, the first centred on azimuth 0 and the rest clockwise, and a cap of half-angle alpha / 2 closes
// the zenith. The ground is one more element, the last. Everything is fixed in world axes with azimuth 0 at
// world -z, whatever north is: turning north, time and weather change the elements' luminances only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/daylight/sky.h"

namespace heliodon::daylight {

struct SkyRow {
    uint32_t firstPatch = 0, patchCount = 0;
    double lowSine = 0, highSine = 0; // sine of the altitude, which is y of a direction
};

class SkyPatches {
public:
    // subdivision 1..64; 144 MF^2 + 1 patches.
    explicit SkyPatches(int subdivision = 2);

    int subdivision() const { return subdivision_; }
    size_t patchCount() const { return patchCount_; }
    size_t elementCount() const { return patchCount_ + 1; }
    size_t groundElement() const { return patchCount_; }
    // From the horizon up, the cap last (a row of one patch). Row r < 7 MF spans altitudes r alpha to (r + 1)
    // alpha.
    std::span<const SkyRow> rows() const { return rows_; }

    // The element that a unit direction points to: the ground's for y <= 0.
    size_t elementOf(glm::dvec3 direction) const;
    glm::dvec3 centre(size_t patch) const;
    double solidAngle(size_t patch) const;          // sr; all patches sum to 2 pi
    double projectedSolidAngle(size_t patch) const; // on the horizontal; all patches sum to pi

    // Mean luminance over the solid angle of each patch, then the ground's: elementCount() values in cd/m2.
    // Sampled by Gauss rules that are refined where two of them differ by over 0.03 % of the patch's mean
    // (round the sun, at the horizon): within 5e-4 of the true mean. The sun's disc is not in it. About 0.1
    // ms for 577 patches. What cutting itself costs on a horizontal plane falls with the square of the
    // subdivision: for 2, at most 1.1 % (steep skies, sun at 5 degrees), 0.1 % overcast.
    std::vector<double> luminances(const Sky& sky) const;

private:
    const SkyRow& rowOf(size_t patch) const;

    int subdivision_;
    size_t patchCount_ = 0;
    double alpha_ = 0; // radians
    std::vector<SkyRow> rows_;
    std::vector<uint32_t> rowOfPatch_;
    std::vector<glm::dvec3> samples_; // first-level nodes of each patch, in luminances()'s order
};

} // namespace heliodon::daylight
