// The faces of a model -> closed rooms, proven. What is repaired is what has one answer: corners that were
// meant to be one, edges that another face's corner divides, boxes that stand on a face without it being cut,
// faces turned over. Everything else is refused with the faces named.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <vector>

#include "geometry/building.h"
#include "geometry/face_soup.h"
#include "geometry/model_faces.h"
#include "geometry/raw_model.h"

namespace heliodon::geometry {

struct ModelRooms {
    Building building;
    std::vector<uint32_t> source; // per face of it, its number in the file
    std::vector<SoupFace> sheets; // outside of all rooms: as SharedWalls has them
};

// `extent`: of the model, metres. `made`: faces of the file in whose place `faces` has panes that may look
// either way. `beforePart` is called before each of the parts of the work and may throw. Throws InputError
// where there are no rooms. Cost: O(n log n) for n faces; where some end on or lie in others, that of
// divideSpace().
ModelRooms roomsOfModel(const RawModel& model, const ModelFaces& faces, double extent,
                        const std::set<uint32_t>& made, const std::function<void()>& beforePart);

} // namespace heliodon::geometry
