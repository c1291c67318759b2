// Slots that light comes in by: walls that face one another across less than a triangle's edge beside an
// opening, or where a room is so narrow (necks.h). Light falls off along them within about their width, which
// triangles as deep as the slot do not tell.
#pragma once

#include <vector>

#include "geometry/building.h"
#include "geometry/mesh_domains.h"
#include "geometry/size_field.h"

namespace heliodon::geometry {

struct SlotSizes {
    std::vector<double> longest;                // per domain, metres: of its triangles' edges; infinity
    std::vector<std::vector<SizeSource>> parts; // per domain: where it is a slot's wall in part alone
};

// About 0.7 of the width of a slot, or as much more as keeps such triangles, with the smaller ones round the
// slot's mouth, at a third of `triangles`; nothing where that is no less than three quarters of `edge`, the
// length elsewhere. A wall over three times as large as the one that it faces is one before that alone.
// Cost: next to nothing.
SlotSizes slotSizes(const Building& building, const std::vector<MeshDomain>& domains, double edge,
                    double triangles);

} // namespace heliodon::geometry
