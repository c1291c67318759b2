// What slats do to light: two neighbours and the openings between their edges bound a channel of one cross
// section, in which every mean over directions along the slats is exact (the enclosure of EN ISO 15099, section
// 7). Light from one direction: what passes between the slats follows from its profile angle alone; the rest
// falls on a stretch of the slats with sharp ends and is given on between strips of their faces, Lambertian, by
// Hottel's crossed strings. Exact but for strips of constant light, 24 to a face: within 0.0015 of a million
// traced rays, which is their noise (tests/daylight/window_test.cpp).
#pragma once

#include <vector>

namespace heliodon::daylight {

class Slats {
public:
    // As in geometry::Blind. Width 1.
    Slats(double angleDeg, double spacing, double reflectance);

    // Shares of what falls on the plane of the blind from outside, from a profile angle: that of the
    // direction towards the source, seen along the slats, above the horizontal; radians, (-pi/2, pi/2).
    double straight(double profile) const;  // passes untouched
    double scattered(double profile) const; // leaves on the other side by way of slats, as from a Lambertian
    double reflected(double profile) const; // leaves on the side that it came from

    // The same for light from all directions alike, from either side: the channel is its own mirror image.
    double diffuseTransmittance() const { return transmitted_; } // straight and scattered
    double diffuseReflectance() const { return returned_; }

private:
    double blocked(double profile) const;
    double byWayOfSlats(double profile, const std::vector<double>& lower,
                        const std::vector<double>& upper) const;

    double angle_, spacing_;
    // Of what falls on a strip of the lower slat's upper face, or the upper slat's lower face, counted from
    // the outer edge: the share that leaves in the end on the room's side (in) or outside (out).
    std::vector<double> lowerIn_, upperIn_, lowerOut_, upperOut_;
    double transmitted_ = 0, returned_ = 0;
};

} // namespace heliodon::daylight
