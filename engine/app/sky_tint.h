// Colour of daylight for pictures: blue sky, warm low sun.
#pragma once

#include <span>

#include "compute/daylight_transport.h"

namespace heliodon::app {

// Replaces each moment's lighting (not its lux) by that under coloured light: sun, sky and ground each take
// their colour from daylight/sky_colour.h, the sky as one, that of what it sends on a horizontal plane. Every
// colour has Y = 1: on grey surfaces no lux changes. `moments` are transport.light(skies); sky and ground
// are solved apart, and what is left is the sun's: two more solutions for a moment with sun, one without, and
// one for all where the room emits light.
void tintLight(compute::DaylightTransport& transport, std::span<const daylight::Sky> skies,
               std::span<compute::Moment> moments);

} // namespace heliodon::app
