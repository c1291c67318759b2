// The faces that sheets stand on and lie before, by where they are.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/box_tree.h"
#include "geometry/face_soup.h"
#include "geometry/flat_faces.h"

namespace heliodon::geometry {

class SheetWalls {
public:
    // Corners are one within `tolerance` (metres).
    SheetWalls(const std::vector<SoupFace>& faces, double tolerance);
    SheetWalls(const SheetWalls&) = delete;
    SheetWalls& operator=(const SheetWalls&) = delete;

    // Infinite where none within `reach` is met; of those whose normals have this cosine to `way`, or more.
    double nearest(glm::dvec3 from, glm::dvec3 way, double reach, double cosine = 0) const;
    // The material of what is met so far away; of several, of one that looks along `way`.
    uint32_t materialAt(glm::dvec3 from, glm::dvec3 way, double far) const;
    // Any that is met within `reach` and nearly across `way`, by its place among those given.
    std::optional<uint32_t> faceAt(glm::dvec3 from, glm::dvec3 way, double reach) const;
    // Of the faces in whose planes both ends lie, and that have one of three points between them.
    std::vector<glm::dvec3> normalsAlong(glm::dvec3 from, glm::dvec3 to) const;

private:
    std::vector<FlatFace> faces_;
    std::vector<uint32_t> material_; // of these
    std::vector<Bounds> boxes_;
    BoxTree tree_; // of these
    double tolerance_;
};

} // namespace heliodon::geometry
