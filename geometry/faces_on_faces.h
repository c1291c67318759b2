// Faces that lie on others which were not divided there: opposite ones of a body and of the wall that it
// stands against hide each other, whatever faces the wall is drawn in.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/bounds.h"
#include "geometry/box_tree.h"
#include "geometry/building.h"

namespace heliodon::geometry {

class FacesOnFaces {
public:
    // `offPlane` metres from a face's plane lie in it. The building outlives this. Cost: n log n.
    FacesOnFaces(const Building& building, double offPlane);
    FacesOnFaces(const FacesOnFaces&) = delete;

    bool hasOpenEdges() const { return hasOpenEdges_; } // edges of one face alone
    // Whether it lies within one other face, not on its border.
    bool isWithinOne(uint32_t face) const;
    // Whether it is of a body that stands in the box of another one, which has faces, any number, where this
    // lies.
    bool isOfBodyOn(uint32_t face) const;

private:
    bool liesInPlane(const Face& face, const std::vector<glm::dvec3>& points) const;

    const Building& building_;
    double offPlane_;
    bool hasOpenEdges_ = false;
    std::vector<Bounds> box_;       // per face
    std::vector<uint32_t> body_;    // per face, one that hangs together with it by edges
    std::vector<Bounds> boxOfBody_; // by that number
    BoxTree tree_;
};

} // namespace heliodon::geometry
