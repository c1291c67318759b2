// What can be said of the rooms of a model that came without a plan.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/building.h"
#include "geometry/patch_mesh.h"

namespace heliodon::geometry {

struct RoomMeasures {
    double floorArea = 0;  // square metres; see findFloors()
    double upperFloor = 0; // of this, storeys and galleries over others
    double volume = 0;     // cubic metres
    double surface = 0;    // square metres, of all that bounds it
    double openings = 0;   // of these, glass and open holes
    double height = 0;     // metres, from the lowest floor to the highest point
    double overFloor = 0;  // cubic metres, straight over floor up to there, but for what is upper floor
    std::vector<size_t> mayBeFloor; // Floors::undecided
    int euler = 0; // V - E + F of the room's surfaces together: 2 for each, less 2 for each handle
};

// Upright and level pieces of glass; one between two rooms is one. A piece ends where glass turns by 37
// degrees, as round a room's corner, or is of another kind, and where it touches the next in a point alone.
struct PaneCount {
    int windows = 0, skylightPanes = 0;
};

// The building's own faces in triangles.
PatchMesh ownTriangles(const Building& building);

// One entry a room; `own`: ownTriangles(). The second leaves floors and what is said of them, and `euler`, at
// nought: floors take longest to find.
std::vector<RoomMeasures> measureRooms(const PatchMesh& own, double worldPerBuilding = 1);
std::vector<RoomMeasures> measureVolumes(const PatchMesh& own);

// Twice its volume over its surface, metres: as deep as a thin room is.
double meanDepth(const RoomMeasures& room);
// As thin as walls are (`worldPerBuilding` world metres a metre of building), and not between two panes.
bool isLikeInsideOfWalls(const RoomMeasures& room, double worldPerBuilding);
// Much less than what is over its lowest floor up to its highest point, as of a floor and walls with a
// thickness drawn as one body; more than under a roof that comes down to the floor.
bool isLikeFloorAndWalls(const RoomMeasures& room);

// By how much the volume of a room may differ from that in ownTriangles() in its mesh, whose triangles are
// chords of curved walls: of the room's volume, for the room where it is most. Negative where the mesh
// encloses less.
struct VolumeError {
    uint32_t room = 0;
    double share = 0;
};
VolumeError worstVolumeError(const PatchMesh& own, const PatchMesh& mesh);
PaneCount countPanes(const PatchMesh& mesh);

} // namespace heliodon::geometry
