// What a model from a file leaves open, and what it looks like: its unit, and which axis is up.
#pragma once

#include <optional>

#include "engine/app/run.h"
#include "geometry/building.h"
#include "geometry/model_file.h"
#include "geometry/patch_mesh.h"

namespace heliodon::app {

// World metres a metre of building: 1 / `given`, else geometry::assumedWorldPerBuilding(), and said; of a
// model whose rooms are all higher than 6.5 m the unit is named that it seems to be in.
double modelScale(Run& run, const std::optional<double>& given, const geometry::Building& building);

// Warns where floors and ceilings, by name, stand upright, windows lie in a floor, or the model has the size
// of a storey on its side and no floors and ceilings, by name, that say otherwise: the file may have another
// axis up than `up`.
void warnOfLying(Run& run, const geometry::PatchMesh& mesh, double worldPerBuilding, geometry::UpAxis up);

} // namespace heliodon::app
