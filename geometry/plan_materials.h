// Material tokens -> the reflectance of every floor, wall and partition.
#pragma once

#include <vector>

#include "geometry/building.h"
#include "geometry/plan_rooms.h"
#include "geometry/plan_windows.h"
#include "geometry/room_faces.h"

namespace heliodon::geometry {

struct PlanMaterials {
    std::vector<Material> materials;
    std::vector<RoomMaterials> rooms;
    std::vector<uint32_t> runs, partitions;
    std::vector<PlanNote> notes; // of tokens that colour nothing
};

// A room takes the floor token that lies in it, else the nearest one, and so the token for all walls. A token
// for a single wall paints the nearest wall, both its faces and its free ends, as far as it runs straight.
PlanMaterials planMaterials(const Sketch& sketch, const PlanWalls& plan, const std::vector<RoomPlan>& rooms,
                            const std::vector<WallRun>& runs, const ClosureOptions& options);

} // namespace heliodon::geometry
