// What a bench found, drawn.
#pragma once

#include <string>
#include <vector>

#include "engine/app/bench_results.h"
#include "engine/app/chart.h"

namespace heliodon::app {

// Error against time, both logarithmic; a panel for each scene and size. Settings of a kernel are joined by a
// line; filled marks are on the front, which a band joins. `clock` names the time that is compared.
Chart plotOf(const std::vector<BenchResult>& results, const std::string& device, const std::string& clock);

} // namespace heliodon::app
