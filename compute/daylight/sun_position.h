// The sun's place in the sky. I. Reda, A. Andreas: Solar Position Algorithm for Solar Radiation Applications,
// NREL/TP-560-34302 (2004, revised 2008), in full; uncertainty 0.0003 degrees for the years -2000 to 6000.
// About 10 us per call.
#pragma once

#include <optional>

#include "compute/daylight/time.h"
#include "geometry/rig.h"

namespace heliodon::daylight {

using geometry::Site;

struct SunOptions {
    double elevationM = 0;                // of the site above sea level, metres
    double pressureMbar = 1013.25;        // yearly mean at the site, for refraction
    double temperatureC = 12;             // yearly mean at the site, for refraction
    double horizonRefractionDeg = 0.5667; // below -(0.26667 + this) no refraction is applied
    std::optional<double> deltaTSeconds;  // TT - UT1; by default deltaTSeconds(year)
};

struct SunPosition {
    double azimuthDeg = 0; // topocentric, [0, 360), from north clockwise
    // Apparent (refracted) altitude of the disc's centre: where its light comes from. As SPA ends refraction
    // below the sunrise's true altitude, -0.83 degrees, it jumps there by 0.6 degrees, down to the true one.
    double altitudeDeg = -90;
    double trueAltitudeDeg = -90;                     // without refraction
    double rightAscensionDeg = 0, declinationDeg = 0; // geocentric
    double hourAngleDeg = 0;                          // geocentric, (-180, 180], afternoon positive
    double equationOfTimeMin = 0;                     // apparent minus mean solar time
    double earthSunAu = 1;

    bool isUp() const { return altitudeDeg > 0; }
};

SunPosition sunPosition(double utcSeconds, const Site& site, const SunOptions& options = {});

// TT - UT1 in seconds for a (fractional) year: polynomials of Espenak and Meeus, Five Millennium Canon of
// Solar Eclipses, NASA/TP-2006-214141. Observed values lie within 1 s from 1900 to 2010; in 2026 it is 6 s
// high: 0.00007 degrees of sun.
double deltaTSeconds(double year);

// The instant of a clock reading at a longitude (degrees east). For apparent solar time 12:00 is the
// geocentric transit; solved to 1e-6 s.
double utcSeconds(const Moment& moment, double longitudeDeg);
// Local apparent solar time of an instant.
Moment solarMoment(double utcSeconds, double longitudeDeg);

enum class DayKind { risesAndSets, alwaysUp, alwaysDown };

struct SunDay {
    double transitUtc = 0; // upper culmination
    DayKind kind = DayKind::risesAndSets;
    double sunriseUtc = 0, sunsetUtc = 0; // before and after that transit; only where it rises and sets
};

// The day whose transit is nearest to the given instant. Rise and set: the disc's centre at -0.8333 degrees
// geometric (upper limb, mean refraction) at sea level, solved on the full algorithm to 0.01 s.
SunDay sunDay(double utcSeconds, const Site& site);

} // namespace heliodon::daylight
