// Sketch -> Building: infers the closed rooms that were meant and proves them closed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/patch_mesh.h"
#include "geometry/sketch.h"

namespace heliodon::geometry {

// One flat piece of a room's boundary: a simple polygon with holes, or one facet of a curved wall.
struct Face {
    std::vector<std::vector<uint32_t>>
        loops; // first the outline, counter-clockwise seen from the air, then holes, clockwise
    uint32_t material = 0;
    Role role = Role::projection;
    uint32_t surface = 0;
    uint32_t room = 0;
    int32_t twin = kNoTwin; // the face of the same glass in the neighbour room
};

struct RoomReport {
    double floorAreaFt2 = 0, volumeFt3 = 0, ceilingFt = 0;
    int euler = 2;
    bool closed = false, selfIntersecting = false;
};

struct WallRole {
    std::string id;
    std::string role;   // exterior | interior | partition | outside_extra | ignored
    std::string reason; // why it takes no part, or which wall it repeats ("repeats w1"); else empty
};

// A Building is only made by closeSketch and importModel, which prove it: every directed edge exactly once
// with its opposite, one fan per vertex, outward orientation, no self-intersection. Metres, y up.
struct Building {
    std::vector<glm::dvec3> vertices;
    std::vector<Face> faces;
    std::vector<Material> materials;
    uint32_t roomCount = 0;
    Occluders occluders;
    // Of a model: surfaces in no room that may shade windows from outside, as reveals before the glass, and
    // that reflect light into them; counter-clockwise seen from the air, not closed.
    Occluders outside;
    std::vector<std::string> repairs;  // what importModel mended, one sentence each
    std::vector<std::string> warnings; // the same, where it was guessed what was meant: not among the repairs
    double northDeg = 90; // direction of north in the plan, degrees counter-clockwise from +x seen from above
                          // (x right, -z up)
    bool northIsSaid = true; // by the sketch or model that it was made of
};

enum class Outcome { ok, warn, refuse };

struct ClosureReport {
    Outcome outcome = Outcome::ok;
    std::string code;    // "OK", "NO_WALLS", ...
    std::string message; // one sentence that names the primitives concerned
    std::vector<RoomReport> rooms;
    int windowCount = 0, skylightPaneCount = 0;
    std::vector<WallRole> walls;
};

struct ClosureOptions {
    // Inches: an interior hole narrower than this is filled. Doors are 2 wide and more, cracks less than 1.
    double crackWidth = 1.5;
    double chordError = 0.02; // inches: how far a facet of a curved wall may lie from the arc
    // Facets of curved walls about so long (inches), or some times it where the chord error allows; where it
    // asks for shorter ones it may rise to the coarse one. 0: as few facets as the chord error allows.
    double facetLength = 0, coarseChord = 0;
    glm::vec3 wallReflectance{0.7f}, floorReflectance{0.3f},
        ceilingReflectance{0.8f}; // where no token says otherwise
    float glazingTransmittance = 0.88f;
};

struct Closure {
    ClosureReport report;
    std::optional<Building> building; // none when refused
};

// A sketch that makes no room is refused in the report, with its reason.
Closure closeSketch(const Sketch& sketch, const ClosureOptions& options = {});

// Of the rooms that closeSketch() would make, in square metres, to within 2 %: partitions count with their
// long sides, ends and crossings are not looked for. 0 where it finds none. Takes a third of the time.
double surfaceOfRooms(const Sketch& sketch, const ClosureOptions& options = {});

// How many facets closeSketch() makes of each curved wall. Options that leave these as they are, of those
// about facets, change nothing. Takes a tenth of the time.
std::vector<int> facetsOfArcs(const Sketch& sketch, const ClosureOptions& options = {});

} // namespace heliodon::geometry
