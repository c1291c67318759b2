// What a bench found, drawn.
#pragma once

#include <string>
#include <vector>

#include "engine/app/bench_results.h"
#include "engine/app/chart.h"

namespace heliodon::app {

// Error against time, both logarithmic; a panel for each scene and size. Settings of a kernel are joined by a
// line; filled marks are on the front, which a band joins. A bar goes from the fastest to the slowest of a
// setting's runs, the mark is their median. `clock` names the time that is compared.
Chart plotOf(const std::vector<BenchResult>& results, const std::string& device, const std::string& clock);

} // namespace heliodon::app
