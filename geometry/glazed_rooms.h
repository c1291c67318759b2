// Rooms of a model with the glass that it draws: as drawn, or in panes that fit their holes.
#pragma once

#include <optional>

#include "geometry/building.h"
#include "geometry/input_error.h"
#include "geometry/model_faces.h"
#include "geometry/model_reading.h"

namespace heliodon::geometry {

// The first that makes rooms of which glass is part: slabs in holes as one pane each, all as drawn, flat
// panes that are larger or smaller than their hole as wide as that (geometry/glass_panes). Glass that bounds
// no room is warned of; so is a body of glass that was taken as a space of its own. `whyNoPane`: set where
// panes that fit made none. `faces` are the same afterwards. Throws InputError where there are no rooms or
// none has glass though the model does. Cost: up to three times that of roomsOfReading(), and once more for
// each time that glass turns out to stand free.
Building glazedRooms(ModelReading& reading, ModelFaces& faces, std::optional<InputError>& whyNoPane);

} // namespace heliodon::geometry
