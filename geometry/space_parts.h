// What faces divide space into: its parts, bounded ones and what lies outside of them, and what was drawn of
// the boundary of each.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "geometry/bounds.h"
#include "geometry/face_soup.h"
#include "geometry/shell_nesting.h"
#include "geometry/space_sheets.h"

namespace heliodon::geometry {

// Metres.
struct SpacePart {
    uint32_t shell = 0;                   // sheets that hang together by edges, a number for each
    std::vector<ShellTriangle> triangles; // of its boundary; they look into the part
    double volume = 0;                    // negative: what lies outside of the shell
    double area = 0;                      // of all that bounds it
    // What has glass to one part alone, which has other glass, is air: else light would come from nowhere.
    bool alcove = false;
    bool between = false;          // it has glass to two others or more
    bool inGlass = false;          // behind faces of one pane (SoupFace::twinKey): the glass itself
    double glass = 0;              // area: of glass
    double window = 0, open = 0;   // of glass that looks outside, of what else parts it from the outside
    std::set<uint32_t> neighbours; // parts beyond its boundary
    double drawnInwards = 0; // area of its own faces that look into it, less that of those that look out
    double drawn = 0;        // area of both

    Bounds box() const;
    // Nearly all of its own faces look in, or out.
    bool looksIn() const { return drawnInwards > 0.5 * drawn; }
    bool looksOut() const { return drawnInwards < -0.5 * drawn; }
};

// A given face, by the sheets that it lies on.
struct DrawnFace {
    std::optional<std::set<uint32_t>>
        borders;                      // the parts that all of it borders on; none where it has no sheet
    std::array<uint32_t, 2> owners{}; // the parts that most of it bounds, in front of it and behind it
    uint32_t sheets = 0;
    double area = 0, backed = 0; // of these, and where others lie on it that are turned over
};

struct SpaceParts {
    std::vector<Sheet> sheets;
    Building welded;          // the sheets; surface: into `sheets`
    std::vector<double> area; // per face of `welded`
    // By side: 2 f is the one that the normal of face f points to, 2 f + 1 the other.
    std::vector<uint32_t> partOfSide;
    std::map<uint32_t, SpacePart> parts;
    std::vector<DrawnFace> drawn; // per given face

    uint32_t partAt(uint32_t face, uint32_t side) const { return partOfSide[2 * face + side]; }
    const Sheet& sheetOf(uint32_t face) const { return sheets[welded.faces[face].surface]; }
    glm::dvec3 normalOf(uint32_t face) const;
};

// Faces as for divideSpace() (geometry/shared_walls.h). None where an edge has one sheet alone. Cost: that of
// cutIntoSheets().
std::optional<SpaceParts> partsOfSpace(const std::vector<SoupFace>& faces,
                                       const std::function<bool(uint32_t)>& isGlass, double tolerance);

} // namespace heliodon::geometry
