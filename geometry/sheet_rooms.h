// The air that sheets enclose, as rooms drawn without thickness, whatever stands in it or runs through them.
#pragma once

#include <functional>
#include <list>
#include <vector>

#include "geometry/box_tree.h"
#include "geometry/face_soup.h"
#include "geometry/flat_faces.h"
#include "geometry/triangle_rays.h"

namespace heliodon::geometry {

class SheetRooms {
public:
    // Of faces that look either way and lie or end on one another as they like, less what hangs open
    // (geometry/open_sheets). Corners are one within `tolerance` (metres). Cost: that of partsOfSpace().
    SheetRooms(const std::vector<SoupFace>& sheets, const std::function<bool(uint32_t)>& isGlass,
               double tolerance);
    SheetRooms(const SheetRooms&) = delete;
    SheetRooms& operator=(const SheetRooms&) = delete;

    bool enclose(glm::dvec3 p) const;
    // Whether the face crosses an opaque one of theirs by more than `tolerance` (metres).
    bool areCrossedBy(const FlatFace& face, double tolerance) const;

private:
    std::vector<FlatFace> walls_; // opaque
    std::vector<Bounds> boxes_;
    BoxTree tree_;
    std::list<TriangleRays> rooms_;
};

} // namespace heliodon::geometry
