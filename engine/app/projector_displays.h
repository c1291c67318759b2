// Which displays projectors' pictures are shown on.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/present/presenter.h"
#include "geometry/rig.h"

namespace heliodon::app {

// Puts "P1=HDMI-2" in the place of what the rig says of that projector. Throws InputError where no projector
// has that name, or it is none.
void assignDisplays(geometry::Rig& rig, const std::vector<std::string>& choices);

// What is not right with that of one projector; empty: nothing. `covered` has what Presenter::covers says of
// each projector's window and, last, of the operator's.
std::string displayNotice(const geometry::Rig& rig, size_t projector,
                          const std::vector<std::optional<present::Display>>& covered);

} // namespace heliodon::app
