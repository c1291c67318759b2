// Which faces of an imported model are one surface, within which light runs on smoothly.
#pragma once

#include <cstdint>
#include <span>

#include "geometry/building.h"
#include "geometry/raw_model.h"

namespace heliodon::geometry {

// Sets Face::surface: neighbours of one material are one surface where they lie in one plane or are parts of
// one face of the file and, but for panes, where they turn by at most 50 degrees and the file has one normal
// on both sides of the edge or, without normals, one smoothing group. Without either, curved shapes stay in
// facets. `source`: per face of the building, that of the model; the vertices of both are metres, y up.
void findSurfaces(Building& building, const RawModel& model, std::span<const uint32_t> source);

} // namespace heliodon::geometry
