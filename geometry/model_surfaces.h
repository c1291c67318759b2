// Which faces of an imported model are one surface, within which light runs on smoothly.
#pragma once

#include <cstdint>
#include <span>

#include "geometry/building.h"
#include "geometry/raw_model.h"

namespace heliodon::geometry {

// Sets Face::surface: neighbours of one material are one surface where they lie in one plane, and at an
// upright edge of upright walls, too, that turn there by at most 50 degrees with one normal of the file on
// both sides of the edge. Other curved shapes stay in facets. `source`: per face of the building, that of the
// model; the vertices of both are metres, y up.
void findSurfaces(Building& building, const RawModel& model, std::span<const uint32_t> source);

} // namespace heliodon::geometry
