// What is not right with the displays that projectors' pictures are shown on.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/present/presenter.h"
#include "geometry/rig.h"

namespace heliodon::app {

// Of one projector; empty: nothing. `covered` has what Presenter::covers says of each projector's window and,
// last, of the operator's.
std::string displayNotice(const geometry::Rig& rig, size_t projector,
                          const std::vector<std::optional<present::Display>>& covered);

} // namespace heliodon::app
