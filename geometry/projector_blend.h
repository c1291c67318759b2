// How projectors share a surface that several of them see. Each fades out towards where it is not seen any
// more and another goes on, by the distance in space to the edges between, so that shares run smoothly
// whatever the triangles are. They are functions of the place: sum one wherever a projector is seen.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/projector_visibility.h"

namespace heliodon::geometry {

// Metres from where a projector ends: up to there it has no part, as calibration errs, and from there its
// full part.
constexpr double kBlendGuard = 0.003, kBlendFalloff = 0.05;
// Of the fade, where all are within the guard: a slope, by which one hands over to another, and what keeps a
// share where every projector is at its border.
constexpr double kBlendLeastSlope = 1e-3, kBlendLeastFade = 1e-6;
// Of the fade towards where a surface ends before what lies behind it. Less of it hands more over to others,
// whose pixels err at the surface's other ends: sums over the table get no better.
constexpr double kBlendEndFade = 0.15;
constexpr double kBlendLeastCosine = 0.05; // a guard: what is painted has more (ProjectorOptions)

// An edge of the mesh between two sets of projectors (bits), neither of them empty; or, with `right` empty,
// an end of the surface past which those of `left` see to what lies behind: there a pixel meant for the
// surface, most of all a grazing one, draws a bright line on that.
struct BlendBorder {
    glm::dvec3 from{}, to{};
    uint32_t left = 0, right = 0;
};

struct ProjectorBlend {
    std::vector<double> candela;   // of each projector's white
    std::vector<uint32_t> visible; // per triangle: those that see it, as bits
    std::vector<uint32_t> first;   // per triangle, and one more: into `borders`
    // Those of the triangle's surface that come within the falloff of it, on foot over triangles that they
    // come within the falloff of.
    std::vector<BlendBorder> borders;

    bool sees(size_t projector, size_t triangle) const { return (visible[triangle] >> projector & 1u) != 0; }
    std::span<const BlendBorder> near(size_t triangle) const {
        return {borders.data() + first[triangle], borders.data() + first[triangle + 1]};
    }
};

// Of projectors that are equally bright; `candela` may be set afterwards. `patches`: what `mesh` was split
// from; `centres`: of the projectors. Cost: a millisecond for a room of six walls at 2000 patches.
ProjectorBlend blendProjectors(const ProjectorMesh& mesh, const PatchMesh& patches,
                               std::span<const glm::dvec3> centres);

// As if there were only these projectors (bits).
void keepOnly(ProjectorBlend& blend, uint32_t projectors);

// cos / r^2, lux at a point per candela of a projector; the cosine is at least kBlendLeastCosine.
double steepnessAt(glm::dvec3 point, glm::dvec3 normal, glm::dvec3 centre);

// The share of each projector at a point of a triangle, in proportion to its fade and to the light that its
// white gives there: within all fades, all are driven alike, so that what they reach together is most.
// `normal`: of the surface, smooth over its facets; `centres`: of the projectors. All zero where none sees
// the triangle. shaders/gain.frag has both, with the constants above.
std::vector<double> blendShares(const ProjectorBlend& blend, size_t triangle, glm::dvec3 point,
                                glm::dvec3 normal, std::span<const glm::dvec3> centres);

} // namespace heliodon::geometry
