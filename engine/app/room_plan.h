// A plan of what was understood: walls as they were drawn, rooms as they were closed and meshed.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "engine/app/chart.h"
#include "engine/app/scene_input.h"

namespace heliodon::app {

// Of a sketch the walls in the colours of their tops, by name, in grey those that bound no room; where a gap
// was filled the outline is orange. Storeys of a model lie side by side. `report`: of the run, after the
// rooms were closed or refused (`outcome`, `code`, `message`, `rooms`, `walls`). A scene without a mesh shows
// the sketch alone. Cost: that of the floors' triangles, which are drawn.
Chart roomPlan(const Scene& scene, const nlohmann::json& report, const std::string& title);

} // namespace heliodon::app
