#include "compute/hidden_sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "compute/float_dot.h"
#include "compute/lighting.h"
#include "compute/parallel.h"
#include "geometry/bounds.h"

namespace heliodon::compute {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr uint32_t kChannels = 3;
constexpr double kLeast = 1e-6; // of an element, hidden

// Whether any of the mesh lies outside of the patch's plane.
bool hasAnythingBefore(const geometry::PatchMesh& mesh, size_t patch, double tolerance) {
    const glm::dvec3 centre = geometry::patchCentroid(mesh, patch),
                     normal = geometry::patchNormal(mesh, patch);
    const auto isBefore = [&](const glm::dvec3& v) { return glm::dot(centre - v, normal) > tolerance; };
    return std::ranges::any_of(mesh.vertices, isBefore) ||
           std::ranges::any_of(mesh.outside.triangles,
                               [&](uint32_t v) { return isBefore(mesh.outside.vertices[v]); });
}

// Towards the middle of every sky element, then below the horizon.
std::vector<glm::dvec3> directionsOf(const daylight::SkyPatches& sky, const daylight::SkyPatches& below) {
    std::vector<glm::dvec3> directions;
    for (size_t e = 0; e < sky.patchCount(); ++e) directions.push_back(sky.centre(e));
    for (size_t e = 0; e < below.patchCount(); ++e)
        directions.push_back(glm::dvec3(1, -1, 1) * below.centre(e));
    return directions;
}

// Shares of what a group scatters of an even ground, by where it comes from.
std::vector<double> scatteredOf(const GlowingBlinds::Group& group, const daylight::SkyPatches& below,
                                std::span<const glm::dvec3> directions) {
    std::vector<double> shares;
    double all = 0;
    for (size_t d = 0; d < directions.size(); ++d) {
        const double facing = std::max(0.0, -glm::dot(group.normal, directions[d]));
        shares.push_back(below.solidAngle(d) * facing *
                         photometric(glm::vec3(group.window.scattered(directions[d], group.normal))));
        all += shares.back();
    }
    for (double& share : shares) share = all > 0 ? share / all : 0;
    return shares;
}

} // namespace

HiddenSky::HiddenSky(const geometry::PatchMesh& mesh, const SunScene& scene, const GlowingBlinds& blinds,
                     const daylight::SkyPatches& sky)
    : groups_(blinds.groups().size()) {
    const double tolerance = kSamePlane * geometry::boundsOf(mesh.vertices).diagonal();
    size_t row = 0, slats = 0;
    for (size_t g = 0; g < groups_.size(); ++g) {
        const GlowingBlinds::Group& group = blinds.groups()[g];
        for (const uint32_t patch : group.patches) {
            if (hasAnythingBefore(mesh, patch, tolerance)) patches_.push_back({patch, g, row, slats, {}});
            ++row;
            if (group.window.hasSlats()) ++slats;
        }
    }
    if (patches_.empty()) return;
    const daylight::SkyPatches below(1);
    const std::vector<glm::dvec3> directions = directionsOf(sky, below);
    std::vector<std::vector<float>> hidden(directions.size()); // per patch
    inParallel(directions.size(), [&](size_t d) {
        const SunPatches from(scene, directions[d], true);
        for (const Patch& p : patches_) {
            const double facing = -glm::dot(blinds.groups()[p.group].normal, directions[d]);
            const double seen = facing > 0 ? photometric(glm::vec3(from.onOutside(p.patch))) / facing : 1;
            hidden[d].push_back(static_cast<float>(std::clamp(1 - seen, 0.0, 1.0)));
        }
    });
    std::vector<double> fromGround; // of a group: how much it scatters of what arrives from there
    for (size_t k = 0; k < patches_.size(); ++k) {
        Patch& p = patches_[k];
        if (k == 0 || p.group != patches_[k - 1].group)
            fromGround = scatteredOf(blinds.groups()[p.group], below,
                                     {&directions[sky.patchCount()], below.patchCount()});
        for (size_t e = 0; e < sky.patchCount(); ++e) p.hidden.push_back(hidden[e][k]);
        double lost = 0;
        for (size_t d = 0; d < fromGround.size(); ++d)
            lost += fromGround[d] * double{hidden[sky.patchCount() + d][k]};
        p.hidden.push_back(static_cast<float>(lost));
    }
    std::erase_if(patches_, [](const Patch& p) { return std::ranges::max(p.hidden) < kLeast; });
    for (const Patch& p : patches_) {
        Group& group = groups_[p.group];
        if (!group.even.empty()) continue;
        group.even = blinds.coefficients(p.group, sky, kChannels);
        if (blinds.groups()[p.group].window.hasSlats())
            group.lobes = blinds.lobeCoefficients(p.group, sky, kChannels);
    }
}

std::vector<float> HiddenSky::lost(const Patch& patch, std::span<const double> luminances) {
    std::vector<float> lost(luminances.size());
    for (size_t e = 0; e < lost.size(); ++e)
        lost[e] = static_cast<float>(kPi * luminances[e]) * patch.hidden[e];
    return lost;
}

glm::vec3 HiddenSky::glow(const Patch& patch, std::span<const double> luminances) const {
    const std::vector<float> from = lost(patch, luminances);
    glm::vec3 sum;
    for (size_t c = 0; c < kChannels; ++c)
        sum[static_cast<int>(c)] =
            static_cast<float>(dot({&groups_[patch.group].even[c * from.size()], from.size()}, from));
    return sum;
}

daylight::Window::Lobes HiddenSky::lobes(const Patch& patch, std::span<const double> luminances) const {
    const std::vector<float> from = lost(patch, luminances);
    daylight::Window::Lobes result;
    const float* row = groups_[patch.group].lobes.data();
    for (glm::dvec3& node : result)
        for (int c = 0; c < 3; ++c, row += from.size()) node[c] = dot({row, from.size()}, from);
    return result;
}

} // namespace heliodon::compute
