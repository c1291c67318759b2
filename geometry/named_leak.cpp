#include "geometry/named_leak.h"

#include <fmt/format.h>

#include "geometry/air_leak.h"
#include "geometry/bounds.h"
#include "geometry/model_faces.h"
#include "geometry/segment_distance.h"

namespace heliodon::geometry {

InputError withLeak(const InputError& error, const RawModel& model, double extent, double worldPerBuilding) {
    if (!error.where().isOpen) return error;
    const auto leak = airLeak(flatFaces(model, extent, worldPerBuilding).soup, kWeldOfExtent * extent);
    if (!leak) return error;
    // What is named as the place of a border is its middle, which is in a hole that it goes round alone.
    const auto& border = error.where().border;
    const auto isBy = [&](glm::dvec3 p) {
        for (size_t k = 0; k + 1 < border.size(); k += 2)
            if (distanceToSegment(p, border[k], border[k + 1]) <= leak->width) return true;
        return false;
    };
    if (isBy(leak->place) && isBy(boundsOf(border).centre())) return error;
    const glm::dvec3 p = model.inFile(leak->place);
    return {error,
            {leak->place, leak->place},
            fmt::format(
                " (the largest room leaks through a gap that is {:.2g} wide, round {:.4g} {:.4g} {:.4g}, in "
                "the file's unit)",
                leak->width, p.x, p.y, p.z)};
}

} // namespace heliodon::geometry
