#include "compute/kernel_choice.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "compute/convex_regions.h"
#include "compute/gpu/device.h"

namespace heliodon::compute {

namespace {

constexpr double kDefaultError = 1e-3;
constexpr double kLeastOfLinks = 5e-4; // below, links do not reach it where pairs may be hidden
// Sums of rows, by which light that goes round grows or dies, may be off by ten times the row error with
// links and by little with visible polygons: for light only errors this coarse are left to links.
constexpr double kLeastForLight = 2e-3;
constexpr double kFlatPatches = 4;     // a plane; with fewer, surfaces count as curved,
constexpr uint32_t kLeastCurved = 100; // unless there are few planes
// Patches up to which a discrete device is through with visible polygons before links are made: their making
// asks the host after each batch (2000 patches on an H100: 14 ms against 73; 10,752: as long as links at
// 5e-3).
constexpr size_t kDenseOnDiscrete = 12'000;

// Of what leaves a patch, a share rho is handed on at most, again and again.
double amplificationIn(const geometry::PatchMesh& mesh, const FormFactorOptions& options) {
    double rho = options.reflectance;
    if (rho <= 0)
        for (uint32_t m : mesh.material)
            for (int c = 0; c < 3; ++c) rho = std::max(rho, double{mesh.materials[m].reflectance[c]});
    rho = std::clamp(rho, 0.01, 0.999);
    return rho / (1 - rho);
}

struct Obstacles {
    size_t blockers = 0;
    double perPair = 0; // of its room, over pairs of patches of one room
    bool curved = false;
};

Obstacles obstaclesIn(const geometry::PatchMesh& mesh) {
    struct Room {
        double patches = 0, blockers = 0;
    };
    std::map<uint32_t, Room> rooms;
    for (uint32_t room : mesh.room) ++rooms[room].patches;
    const std::vector<ConvexRegion> regions = blockingRegions(mesh, 8);
    for (const ConvexRegion& region : regions) ++rooms[region.room].blockers;
    Obstacles found{.blockers = regions.size()};
    double pairs = 0;
    for (const auto& [number, room] : rooms) {
        pairs += room.patches * room.patches;
        found.perPair += room.patches * room.patches * room.blockers;
    }
    found.perPair /= std::max(pairs, 1.0);
    const std::vector<uint32_t> planes = planeNumbers(mesh);
    const uint32_t count = planes.empty() ? 0 : *std::max_element(planes.begin(), planes.end());
    found.curved = count >= kLeastCurved && static_cast<double>(mesh.patchCount()) < kFlatPatches * count;
    return found;
}

} // namespace

double errorFromWhichLinksPay(double blockers, bool curved) {
    const double flat = blockers > 0 ? std::min(0.019 / std::sqrt(blockers), 6e-3) : 2e-3;
    return std::max(curved ? flat / 3 : flat, kLeastOfLinks);
}

KernelChoice chooseKernel(const gpu::Device& device, const geometry::PatchMesh& mesh,
                          const FormFactorOptions& options) {
    KernelChoice choice{options.kernel, "", options.maxError};
    if (options.maxRadiosityError > 0) {
        choice.amplification = amplificationIn(mesh, options);
        choice.maxError = std::clamp(options.maxRadiosityError / choice.amplification, 1e-7, 1.0);
        choice.why = fmt::format("radiosity within {:.2g} asks for rows within {:.2g}",
                                 options.maxRadiosityError, choice.maxError);
    }
    if (options.kernel != "auto") return choice;
    if (!(choice.maxError > 0)) choice.maxError = kDefaultError;
    const Obstacles obstacles = obstaclesIn(mesh);
    const double measured = errorFromWhichLinksPay(obstacles.perPair, obstacles.curved),
                 pays = options.forLight ? std::max(measured, kLeastForLight) : measured;
    const bool denseSooner = device.info().type == "discrete" && mesh.patchCount() <= kDenseOnDiscrete;
    const bool links = choice.maxError >= pays && !denseSooner;
    choice.kernel = links ? "hierarchical" : "exact";
    if (!choice.why.empty()) choice.why += "; ";
    choice.why += fmt::format("auto: row error {:.2g} ", choice.maxError);
    if (choice.maxError < measured)
        choice.why += fmt::format("is below {:.2g}, from which links between clusters cost less than "
                                  "visible polygons here",
                                  measured);
    else if (choice.maxError < pays)
        choice.why += "is left to visible polygons, since light needs sums of rows that links do not keep";
    else if (denseSooner)
        choice.why += "is reached soonest by visible polygons on this device";
    else
        choice.why += fmt::format("is reached soonest by links between clusters, which cost less from {:.2g} "
                                  "on here",
                                  measured);
    choice.why += obstacles.blockers == 0
                      ? ": nothing can stand between two patches"
                      : fmt::format(": {:.0f} blockers a room", std::max(1.0, obstacles.perPair));
    if (obstacles.curved) choice.why += ", curved surfaces";
    return choice;
}

} // namespace heliodon::compute
