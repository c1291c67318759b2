// Which moment a picture shows, in words: at the lower left of previews and of the cells of a contact sheet,
// never on projectors' pictures; among the attributes of linear ones.
#pragma once

#include <string>
#include <vector>

#include "compute/daylight/sun_position.h"
#include "engine/app/moment.h"
#include "engine/passes/image_file.h"
#include "engine/passes/picture.h"

namespace heliodon::app {

// Pale words on a darkened ground, whatever lies under them. The first line is the largest; lines shrink
// where the picture is narrow, and nothing is drawn where it is too small to read (below 120 pixels high).
// Words are UTF-8. Changes pixels of the lower left corner alone, the same on every run.
void drawStamp(passes::Image8& picture, const std::vector<std::string>& lines);

// For a cell of a contact sheet without any light: darkened, ground and all, with "no sun" in its middle, so
// that a room in black is not taken for one that failed.
void drawNight(passes::Image8& picture);

// "sun 34.2° high", "sun 6.0° below the horizon".
std::string sunInWords(const daylight::SunPosition& sun);

// "21 June 2026, 13:00 solar time", "sun 70.6° high, clear sky, 42.73 N 73.68 W; white is 1200 lux". A sky
// file has neither time nor sun; a picture of lux as colours (`whiteLux` 0), or of no light, has no white.
std::vector<std::string> stampOf(const SkySource& source, const daylight::Moment& moment, double whiteLux);

// For EXR: what the numbers are (`unit`), white, when, where, under which sky.
passes::ExrAttributes previewAttributes(const SkySource& source, const daylight::Moment& moment,
                                        double whiteLux);
passes::ExrAttributes projectorAttributes(const SkySource& source, const daylight::Moment& moment,
                                          double whiteLux);

} // namespace heliodon::app
