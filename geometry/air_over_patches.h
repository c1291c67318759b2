// How much of what looks up has air over it to stand in, and what lies beneath.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/bounds.h"
#include "geometry/box_tree.h"
#include "geometry/patch_mesh.h"

namespace heliodon::geometry {

// Square metres of the building.
struct Air {
    double free = 0; // with headroom
    // Of this, right over a ceiling with headroom beneath, and such of its room.
    double walkedUnder = 0, walkedUnderInRoom = 0;
    double over = 0; // of all, over what looks up in its room
};

// The mesh outlives this; `scale` world metres in it are one of the building.
class AirOverPatches {
public:
    AirOverPatches(const PatchMesh& mesh, double scale) : mesh_(mesh), scale_(scale) {}

    // Of patches of one room that look up, whose area is this in all. Cost: some 200 lines upwards and down.
    Air of(const std::vector<size_t>& patches, double area);

private:
    std::vector<glm::dvec3> pointsOn(const std::vector<size_t>& patches, double area) const;
    void arrange();
    double nearest(glm::dvec3 p, bool above, bool isFloor, uint32_t room = kNoRoom) const;

    const PatchMesh& mesh_;
    double scale_;
    std::vector<std::pair<size_t, bool>> sloping_; // patches, and whether they look up
    std::vector<Bounds> boxes_;                    // of these
    std::optional<BoxTree> columns_;
};

} // namespace heliodon::geometry
