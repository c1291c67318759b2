// Sketch -> the solid pieces of wall that stand on the table, cleaned: copies and pieces of one straight side
// lie on one line, cracks are filled. Plan coordinates, inches. The order of the primitives in the sketch
// does not matter.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "geometry/sketch.h"

namespace heliodon::geometry {

// A straight or curved wall after copies and overlapping pieces were merged.
struct WallPiece {
    std::vector<std::string> ids; // the primitives that it came from
    bool curved = false;
    glm::dvec2 a{}, b{};               // ends of the centre line
    glm::dvec2 center{};               // of an arc, which runs counter-clockwise from a to b
    double radius = 0, a0 = 0, a1 = 0; // radians
    int facets = 0;                    // of an arc
    double widestFacet = 0;            // radians: what the chord error allows
    // Of an arc's outer and inner face from a0 to a1, where they are not those of even facets; may be empty.
    std::array<std::vector<glm::dvec2>, 2> corners;
    double thickness = 0.375, height = 10;
    int line = -1; // straight side that it belongs to, -1 for arcs
};

double lengthOf(const WallPiece& piece);                // along the centre line
glm::dvec2 wayOf(const WallPiece& piece, glm::dvec2 p); // from a to b, where it passes p; of any length

// A straight side: every piece on it has its ends on origin + s * direction.
struct WallLine {
    glm::dvec2 origin{}, direction{};
    double along(glm::dvec2 p) const {
        return (p.x - origin.x) * direction.x + (p.y - origin.y) * direction.y;
    }
    glm::dvec2 at(double s) const { return origin + s * direction; }
};

// What an edge of a solid is: which long face, or an end.
enum class SolidSide : uint8_t { right, left, end };

// A polygon of the plan in which there is no air. Counter-clockwise; edge k runs from corner k to corner k
// + 1.
struct PlanSolid {
    std::vector<glm::dvec2> outline;
    std::vector<SolidSide> sides; // per edge
    int piece = -1;               // the wall piece that it is, -1 for the filling of a crack
};

// A corner left open as wide as a door, and filled.
struct WideCorner {
    size_t firstSolid = 0, endSolid = 0; // its fillings
    std::array<glm::dvec2, 2> beside{};  // points on its two sides
};

struct PlanNote {
    std::string code, sentence;
};

struct IgnoredWall {
    std::string id, reason; // "has no length"
};

struct PlanWalls {
    std::vector<WallPiece> pieces;     // full height: red and blue
    std::vector<WallPiece> partitions; // green
    std::vector<WallLine> lines;
    std::vector<PlanSolid> solids; // one a piece, in their order, then the crack fillings
    std::vector<WideCorner> wideCorners;
    std::vector<PlanNote> notes;
    double crackWidth = 0;            // inches: narrower holes were filled
    std::vector<IgnoredWall> ignored; // what came to nothing
};

struct PlanWallsOptions {
    double crackWidth = 1.5;                 // inches: narrower holes are filled
    double chordError = 0.02;                // inches
    double facetLength = 0, coarseChord = 0; // as in ClosureOptions
};

PlanWalls planWalls(const Sketch& sketch, const PlanWallsOptions& options);

// How much farther than the arc corners between its facets lie from its centre, so that the facets enclose
// the arc's own area. Its ends, but for a full circle, are where they are.
double cornerReach(double sweep, int count, bool full);

// Corners of one long face of an arc, from a0 to a1.
std::vector<glm::dvec2> faceCorners(const WallPiece& piece, bool outer);

// The footprint of a piece, counter-clockwise.
PlanSolid footprint(const WallPiece& piece);
bool contains(const std::vector<glm::dvec2>& polygon, glm::dvec2 p);

// An end of a piece: middle and corners of its end face, and the direction out of the wall.
struct WallEnd {
    int piece = 0;
    bool atB = false;
    glm::dvec2 middle{}, out{};
    glm::dvec2 right{}, left{}; // corners, as seen looking along `out`
};
WallEnd wallEnd(const WallPiece& piece, int index, bool atB);

// True when the end stands in or against another solid.
bool touches(const std::vector<PlanSolid>& solids, const WallEnd& end);

// Distance along the ray to the first solid other than `except`, or infinity; `hit` names the solid.
double firstHit(std::span<const PlanSolid> solids, glm::dvec2 origin, glm::dvec2 direction, int except,
                int* hit = nullptr);

} // namespace heliodon::geometry
