// A model that was refused, seen from above: all its faces, and where the refusal is about.
#pragma once

#include <string>

#include "engine/app/chart.h"
#include "geometry/refused_model.h"

namespace heliodon::app {

// `why` stands below the title, `northDeg` is as Scene has it.
Chart refusedPlan(const geometry::RefusedModel& model, double northDeg, const std::string& title,
                  const std::string& why);

} // namespace heliodon::app
