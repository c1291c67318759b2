// Sensors a hair from walls: light changes fast towards a corner, faster than patches of a mesh tell, and
// what such a sensor sees is mostly the patch or two beside it. Here those patches are taken apart into
// triangles that shrink towards the sensor, whose light is gathered at their own places and exchanged among
// them until it settles (Nystroem's method on the corner alone, the rest of the room as the mesh has it).
#pragma once

#include "compute/daylight/sky.h"
#include "compute/daylight_transport.h"
#include "compute/patch_slopes.h"
#include "compute/point_scene.h"
#include "compute/sensor_gather.h"

namespace heliodon::compute {

// Of each sensor, whether a patch that fills a fifth or more of what it sees is so near that it is taken
// apart.
std::vector<uint8_t> nearWalls(const PointScene& scene, const SensorGather& sensors);

// Corrects moment.sensors' interreflected light where they have a near wall. The moment is solved. About
// 50 ms a sensor in a corner, of 2000 patches.
// Direct sun is left as it is: sunEdges has its first bounce exactly.
void lightNearWalls(const PointScene& scene, const PatchSlopes& slopes, const SensorGather& sensors,
                    const daylight::Sky& sky, Moment& moment);

} // namespace heliodon::compute
