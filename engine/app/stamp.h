// Which moment a picture shows, in words at its lower left: on frames of a time-lapse and on the cells of a
// contact sheet. Never on projectors' pictures or linear ones.
#pragma once

#include <string>
#include <vector>

#include "compute/daylight/sun_position.h"
#include "engine/passes/picture.h"

namespace heliodon::app {

// Pale words on a darkened ground, whatever lies under them. The first line is the largest; lines shrink
// where the picture is narrow, and nothing is drawn where it is too small to read (below 120 pixels high).
// Words are UTF-8. Changes pixels of the lower left corner alone, the same on every run.
void drawStamp(passes::Image8& picture, const std::vector<std::string>& lines);

// "sun 34.2° high", "sun 6.0° below the horizon".
std::string sunInWords(const daylight::SunPosition& sun);

} // namespace heliodon::app
