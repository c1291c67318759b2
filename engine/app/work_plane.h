// Sensors where a desk would stand: a square grid over the floors of all rooms, looking up.
#pragma once

#include <string>

#include "engine/app/table_file.h"
#include "geometry/patch_mesh.h"

namespace heliodon::app {

struct WorkPlane {
    double height = 0.762,
           spacing = 0.6096;     // building metres: 2 ft 6 in above the floor, every 2 ft (IES LM-83)
    double worldPerBuilding = 1; // world metres a building metre
    size_t most = 2000;          // sensors; more floor than that widens the spacing

    std::string inWords() const; // how high it is
};

// Rows `x,y,z,nx,ny,nz` in the model's axes. Points under which a floor lies (geometry/floors.h, or an upward
// surface at most half a metre above its room's lowest floor) with nothing between it and the work plane,
// centred in each room's extent; a floor narrower than the grid gets its middle. Empty when no floor is
// found.
SensorTable workPlaneSensors(const geometry::PatchMesh& mesh, geometry::UpAxis up, WorkPlane plane = {});

// World axes back to the model's.
glm::dvec3 modelFromWorld(glm::dvec3 p, geometry::UpAxis up);

} // namespace heliodon::app
