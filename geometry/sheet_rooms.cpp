#include "geometry/sheet_rooms.h"

#include <algorithm>

#include "geometry/face_crossing.h"
#include "geometry/open_sheets.h"
#include "geometry/space_parts.h"

namespace heliodon::geometry {

namespace {

std::vector<FlatFace> opaqueAmong(std::vector<SoupFace> faces, const std::function<bool(uint32_t)>& isGlass,
                                  double tolerance) {
    std::erase_if(faces, [&](const SoupFace& face) { return isGlass(face.material); });
    return flatFacesOf(weldedByNumber(std::move(faces), tolerance));
}

std::vector<Bounds> boxesOf(const std::vector<FlatFace>& faces) {
    std::vector<Bounds> out;
    for (const FlatFace& face : faces) out.push_back(face.box);
    return out;
}

} // namespace

SheetRooms::SheetRooms(const std::vector<SoupFace>& sheets, const std::function<bool(uint32_t)>& isGlass,
                       double tolerance)
    : tree_({}) {
    auto space = partsOfSpace(sheets, isGlass, tolerance);
    const auto any = [](uint32_t) { return false; }; // panes in holes of solids hang open, too
    const auto closed = space ? std::nullopt : openSheets(sheets, any, tolerance);
    if (closed) space = partsOfSpace(closed->closed, isGlass, tolerance);
    if (!space) return;
    for (const auto& [id, part] : space->parts)
        if (part.volume > 0) rooms_.emplace_back(part.triangles, tolerance);
    walls_ = opaqueAmong(closed ? closed->closed : sheets, isGlass, tolerance);
    boxes_ = boxesOf(walls_);
    tree_ = BoxTree(boxes_);
}

bool SheetRooms::enclose(glm::dvec3 p) const {
    return std::ranges::any_of(rooms_, [&](const TriangleRays& room) { return room.enclose(p); });
}

bool SheetRooms::areCrossedBy(const FlatFace& face, double tolerance) const {
    return tree_.anyHolding(face.box.high, face.box.low,
                            [&](uint32_t i) { return facesCross(face, walls_[i], tolerance); });
}

} // namespace heliodon::geometry
