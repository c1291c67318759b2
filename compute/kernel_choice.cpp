#include "compute/kernel_choice.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "compute/convex_regions.h"
#include "compute/gpu/device.h"
#include "compute/hierarchical.h"
#include "geometry/outline_area.h"

namespace heliodon::compute {

namespace {

constexpr double kDefaultError = 1e-3;
// Where links begin to pay, fitted to what was measured (docs/form-factors.md): kOfOneBlocker over the root
// of blockers or, where these are fewer than 28, kOfFewBlockers over their number, at most kMostWithBlockers.
// With any blocker links send rays between clusters that it comes near; without any they send none, and pay
// sooner: hence the jump from 0 to 1.
constexpr double kOfOneBlocker = 0.019, kOfFewBlockers = 0.1, kMostWithBlockers = 4.5e-3,
                 kWithoutBlockers = 2e-3;
constexpr double kFewAPlaneGain = 1.0 / 3; // of these, with few patches a plane
// With fewer patches a blocker than this, links do not pay below.
constexpr double kFewABlocker = 2.3, kLeastWithFewABlocker = 3e-3;
// And are off by up to their claim, which lies by up to 1.8 above what they are asked for: so they are asked
// for less (60, 300 and 900 loose triangles).
constexpr double kOfLinksWithFewABlocker = 0.8;
// Nor with more than this: between small patches few of a room's blockers matter, however many there are.
constexpr double kManyABlocker = 8, kLeastWithManyABlocker = 3e-3;
// Blockers of so much of their room's area on the mean, partitions and tall boards, hide most pairs behind
// them wholly, which is proven at once, while nearly all clusters in the open have one near and send rays:
// links pay from this times that share on.
constexpr double kLarge = 0.05, kOfLargeBlockers = 0.3;
// Sums of rows, by which light that goes round grows or dies, may be off by ten times the row error with
// links and by little with visible polygons: for light only errors this coarse are left to links.
constexpr double kLeastForLight = 2e-3;
// Fewer patches a plane are few, but not in scenes of few planes, which cost little with either.
constexpr double kFewAPlane = 4;
constexpr uint32_t kFewPlanes = 100;
// Where few patches share a plane, as inside a sphere, each pair that is not hidden is a link of 32 bytes:
// beyond 2 GB of them they are left to visible polygons, which keep none and need no longer there
// (5120 patches: 2.3 CPU s against 1.7).
constexpr double kMostPairsAsLinks = 64e6;
// A discrete device is through with visible polygons before links are made: their making asks the host after
// each batch (1e-2 asked, on an H200: 1966 patches 13 ms against 68, 9824 patches 65 against 1130). Up to as
// many patches as one binding holds the matrix of, and this share of the memory.
constexpr size_t kDenseOnDiscrete = 32'000;
constexpr double kDenseShare = 0.25;
// Behind a crowd, where each blocker is a few patches, visible polygons cost about so many CPU seconds a pair
// of patches and blocker, and rays so many a patch, whatever stands there; what light was not asked to keep
// then need not be better than kOfRays (160, 312 and 624 boards before a window).
constexpr double kSecondsOfCrowd = 2e-9, kSecondsOfRays = 4.3e-3, kOfRays = 5e-3, kCrowdOfFew = 4,
                 kPatience = 100; // CPU seconds

// Of what leaves a patch, a share rho is handed on at most, again and again.
double amplificationIn(const geometry::PatchMesh& mesh, const FormFactorOptions& options) {
    double rho = options.reflectance;
    if (rho <= 0)
        for (uint32_t m : mesh.material)
            for (int c = 0; c < 3; ++c) rho = std::max(rho, double{mesh.materials[m].reflectance[c]});
    rho = std::clamp(rho, 0.01, 0.999);
    return rho / (1 - rho);
}

Obstacles obstaclesIn(const geometry::PatchMesh& mesh) {
    struct Room {
        double patches = 0, area = 0, blockers = 0, blocking = 0, squares = 0; // areas; of blockers, squared
    };
    std::map<uint32_t, Room> rooms;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        Room& room = rooms[mesh.room[i]];
        ++room.patches;
        room.area += geometry::patchArea(mesh, i);
    }
    const BlockingPlanes found = blockingPlanes(mesh, 8);
    for (const ConvexRegion& region : found.regions) {
        Room& room = rooms[region.room];
        const double area = glm::length(geometry::areaVector(region.corners));
        ++room.blockers;
        room.blocking += area;
        room.squares += area * area;
    }
    double pairs = 0, patches = 0, blockers = 0, large = 0; // the latter three over all pairs
    for (const auto& [number, room] : rooms) {
        const double squared = room.patches * room.patches;
        pairs += squared;
        patches += squared * room.patches;
        blockers += squared * room.blockers;
        if (room.blocking > 0) large += squared * room.squares / (room.blocking * room.area);
    }
    return {.blockers = blockers / std::max(pairs, 1.0),
            .patchesABlocker = blockers > 0 ? patches / blockers : INFINITY,
            .fewPatchesAPlane = found.planes >= kFewPlanes &&
                                static_cast<double>(mesh.patchCount()) < kFewAPlane * found.planes,
            .blockerShare = large / std::max(pairs, 1.0)};
}

// Where nothing was asked of light, and visible polygons would take minutes.
bool leaveToRays(const Obstacles& obstacles, size_t patches, const FormFactorOptions& options,
                 KernelChoice& choice) {
    const double n = static_cast<double>(patches), polygons = kSecondsOfCrowd * n * n * obstacles.blockers,
                 rays = kSecondsOfRays * n;
    if (!options.forLight || options.maxError > 0 || options.maxRadiosityError > 0 ||
        obstacles.patchesABlocker >= kCrowdOfFew || polygons < std::max(kPatience, 2 * rays))
        return false;
    choice.kernel = "montecarlo";
    choice.maxError = kOfRays;
    choice.why =
        fmt::format("auto: behind {:.2g} blockers and {:.2g} patches a blocker visible polygons would take "
                    "about {:.2g} CPU seconds, rays from patches {:.2g} to a row error of {:g}, since "
                    "none was asked for",
                    obstacles.blockers, obstacles.patchesABlocker, polygons, rays, kOfRays);
    return true;
}

bool isDenseSooner(gpu::Device& device, size_t patches) {
    const double bytes = 4.0 * static_cast<double>(patches) * static_cast<double>(patches);
    return device.info().type == "discrete" && patches <= kDenseOnDiscrete &&
           bytes <= kDenseShare * static_cast<double>(device.memory().largestHeap());
}

} // namespace

double errorFromWhichLinksPay(const Obstacles& obstacles) {
    const bool any = obstacles.blockers > 0;
    double pays = any ? std::min(std::max(kOfOneBlocker / std::sqrt(obstacles.blockers),
                                          kOfFewBlockers / obstacles.blockers),
                                 kMostWithBlockers)
                      : kWithoutBlockers;
    if (any && obstacles.patchesABlocker < kFewABlocker) return std::max(pays, kLeastWithFewABlocker);
    if (obstacles.fewPatchesAPlane)
        pays *= kFewAPlaneGain;
    else if (obstacles.blockerShare >= kLarge)
        pays = std::max(pays, kOfLargeBlockers * obstacles.blockerShare);
    else if (any && obstacles.patchesABlocker >= kManyABlocker)
        pays = std::max(pays, kLeastWithManyABlocker);
    return std::max(pays, kLeastErrorOfLinks);
}

KernelChoice chooseKernel(gpu::Device& device, const geometry::PatchMesh& mesh,
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
    const double measured = errorFromWhichLinksPay(obstacles),
                 pays = options.forLight ? std::max(measured, kLeastForLight) : measured;
    const bool denseSooner = isDenseSooner(device, mesh.patchCount());
    const double pairs = 0.5 * std::pow(static_cast<double>(mesh.patchCount()), 2);
    const bool eachPairALink = obstacles.fewPatchesAPlane && pairs > kMostPairsAsLinks;
    if (device.info().type != "discrete" && leaveToRays(obstacles, mesh.patchCount(), options, choice))
        return choice;
    const bool links = choice.maxError >= pays && !denseSooner && !eachPairALink;
    choice.kernel = links ? "hierarchical" : "exact";
    if (links && obstacles.patchesABlocker < kFewABlocker) choice.ofLinks = kOfLinksWithFewABlocker;
    if (!choice.why.empty()) choice.why += "; ";
    choice.why += fmt::format("auto: row error {:.2g} ", choice.maxError);
    if (choice.maxError < measured)
        choice.why += fmt::format("is below {:.2g}, from which links between clusters cost less than "
                                  "visible polygons here",
                                  measured);
    else if (choice.maxError < pays)
        choice.why += "is left to visible polygons, since light needs sums of rows that links do not keep";
    else if (eachPairALink)
        choice.why += "is left to visible polygons, since each pair of patches would be a link to be kept";
    else if (denseSooner)
        choice.why += "is reached soonest by visible polygons on this device";
    else
        choice.why += fmt::format("is reached soonest by links between clusters, which cost less from {:.2g} "
                                  "on here",
                                  measured);
    if (obstacles.blockers == 0)
        choice.why += ": nothing can stand between two patches";
    else
        choice.why += fmt::format(": {:.2g} blockers and {:.2g} patches a blocker, on the mean over pairs",
                                  obstacles.blockers, obstacles.patchesABlocker);
    if (obstacles.fewPatchesAPlane) choice.why += ", few patches a plane";
    if (obstacles.blockerShare >= kLarge)
        choice.why += fmt::format(", of {:.2g} % of the room's area", 100 * obstacles.blockerShare);
    return choice;
}

} // namespace heliodon::compute
