// The last step of a moment: from solved exitance to light on patches and at sensors, with the estimate of
// its error and the balance of its energy.
#pragma once

#include <span>
#include <vector>

#include "compute/daylight_transport.h"
#include "compute/near_pairs.h"
#include "compute/patch_slopes.h"
#include "compute/point_scene.h"
#include "compute/radiosity.h"
#include "compute/sensor_gather.h"

namespace heliodon::compute {

// What stays the same from moment to moment; all of it outlives its use.
struct MomentScene {
    const geometry::PatchMesh& mesh;
    std::span<const double> areas;
    std::span<const float> rowSums;    // of form factors, without what runs through panes
    std::span<const glm::vec3> linked; // per patch: sum of its links through panes, and of what comes back
                                       // from outside; empty without any
    const RadiosityMatter& matter;
    const std::vector<std::vector<float>>&
        clear; // per channel: diffuse transmittance of clear interior glass
    const PatchSlopes& slopes;
    const NearPairs& pairs;
    const PointScene& points;
    const SensorGather& sensors;
    const SlatLobes& slats;
    FormFactorOperator& factors;
    double rowError;                           // of form factors
    bool grey;                                 // one column stands for three
    std::span<const float> skyError, skyRange; // per patch, PatchSky; empty without openings
    bool returns;                              // light of rooms comes back from outside, as `linked` has it
};

// Columns of the solution from `first` on, one a channel: patches each.
struct SolvedColumns {
    std::span<const float> exitance, gathered;
    size_t first;
    // What the solver leaves on what each patch gathers, photometric, where it was found place by place; else
    // it is Moment::solverError.
    std::span<const float> gatheredError;
};

// Fills lighting.exitance, each patch's interreflected light and error, and the report's lumens. Direct
// light, with that of slats' lobes for interreflected, the solver's errors and report.radiosity are there
// already. Behind slats two passes over F more, for that error.
void lightPatches(const MomentScene& scene, const SolvedColumns& solved, Moment& moment);

// Adds interreflected light of sensors, and sets their error; after lightPatches.
void lightSensors(const MomentScene& scene, Moment& moment);

} // namespace heliodon::compute
