// Rooms of the plan -> the faces of their air in space: floor, partitions, walls with windows, ceiling with
// skylights.
#pragma once

#include <vector>

#include "geometry/face_soup.h"
#include "geometry/plan_rooms.h"
#include "geometry/plan_windows.h"

namespace heliodon::geometry {

constexpr double kSmallestPane = 0.05; // square inches: what of skylights is smaller in a room is ceiling

// Indices into Building::materials.
struct RoomMaterials {
    uint32_t floor = 0, ceiling = 0, glazing = 0;
};

struct RoomFaceInput {
    const PlanWalls& plan;
    const std::vector<RoomPlan>& rooms;
    const std::vector<WallRun>& runs;
    const std::vector<Skylight>& skylights;  // in canonical order
    std::vector<double> ceilings;            // inches, per room
    std::vector<RoomMaterials> materials;    // per room
    std::vector<uint32_t> runMaterial;       // per run
    std::vector<uint32_t> partitionMaterial; // per partition
    std::vector<WindowHole> holes;
    std::vector<uint32_t> holeMaterial;     // per hole
    std::vector<uint32_t> skylightMaterial; // per skylight
};

struct RoomFaces {
    std::vector<SoupFace> faces;     // metres
    std::vector<double> floorArea;   // square inches, per room: net of partitions
    std::vector<double> lowArea;     // square inches, per room: under partitions
    std::vector<bool> partitionUsed; // per partition: some of it stands in a room
    std::vector<bool> skylightUsed;  // per skylight
    int skylightPanes = 0;
};

RoomFaces roomFaces(const RoomFaceInput& input);

} // namespace heliodon::geometry
