// What slats do to light: two neighbours and the openings between their edges bound a channel of one cross
// section, in which every mean over directions along the slats is exact (the enclosure of EN ISO 15099,
// section 7). Light from one direction: what passes between the slats follows from its profile angle alone;
// the rest falls on a stretch of the slats with sharp ends and is given on between strips of their faces,
// Lambertian, by Hottel's crossed strings. Who looks at the blind sees strips of slats, which ones follows
// from the profile angle of the look: so slats in the sun shine up from their upper faces and hardly down.
// Exact but for strips of constant light, 24 to a face: within 0.0015 of a million traced rays, which is
// their noise (tests/daylight/window_test.cpp).
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace heliodon::daylight {

// Directions in which light travels away from one side of a blind, by their elevation seen along the slats:
// nodes every 3.75 degrees from straight down to straight up, light runs linearly between them: of what is
// seen, the line that comes nearest to it, for it has sharp bends where slats are seen edge-on or hide all.
constexpr size_t kSlatNodes = 49;
using SlatLight = std::array<double, kSlatNodes>; // luminance x pi at the nodes, per illuminance of the plane

// Share of a Lambertian face's light that belongs to a node; all shares sum to 1.
double nodeShare(size_t node);

// An elevation, radians, between two nodes: (1 - part) of the lower one and `part` of the next.
struct BetweenNodes {
    size_t lower;
    double part;
};
BetweenNodes betweenNodes(double elevation);

class Slats {
public:
    // As in geometry::Blind. Width 1. About 2 ms.
    Slats(double angleDeg, double spacing, double reflectance);

    // Shares of what falls on the plane of the blind from outside, from a profile angle: that of the
    // direction towards the source, seen along the slats, above the horizontal; radians, (-pi/2, pi/2).
    double straight(double profile) const;  // passes untouched
    double scattered(double profile) const; // leaves on the other side by way of slats
    double reflected(double profile) const; // leaves on the side that it came from

    // Where these go. Their means over the nodes are the shares, within 1e-3.
    SlatLight scatteredLight(double profile) const;
    SlatLight reflectedLight(double profile) const;

    // The same for light from all directions alike, from either side: the channel is its own mirror image.
    double diffuseTransmittance() const { return transmitted_; } // straight and scattered
    double diffuseReflectance() const { return returned_; }

    // What becomes of light from outside, luminance x pi by the elevation of its travel: on the room's side,
    // with what passes straight, and back.
    SlatLight onward(const SlatLight& arriving) const { return times(arriving, onward_); }
    SlatLight straightOn(const SlatLight& arriving) const; // of that, what touches no slat
    SlatLight backward(const SlatLight& arriving) const { return times(arriving, backward_); }

private:
    static constexpr size_t kStrips = 24; // of a face
    // Strips of the lower slat's upper face, then of the upper slat's lower face, each from the outer edge.
    using OnStrips = std::array<double, 2 * kStrips>;

    using Exchange = std::array<SlatLight, kSlatNodes>; // from each node to each

    static SlatLight times(const SlatLight& arriving, const Exchange& exchange);
    double blocked(double profile) const;
    OnStrips seenFromOutside(double profile) const; // as shares of the plane
    static OnStrips mirrored(const OnStrips& strips);
    double byWayOfSlats(double profile, const OnStrips& toSide) const;

    double angle_, spacing_;
    // Of what falls on a strip, the share that leaves in the end on the room's side (in) or outside (out),
    // and the light of the nodes there.
    OnStrips toIn_{}, toOut_{};
    std::array<OnStrips, kSlatNodes> nodesIn_{}, nodesOut_{};
    SlatLight passing_{}; // about each node, straight
    Exchange onward_{}, backward_{};
    double transmitted_ = 0, returned_ = 0;
};

} // namespace heliodon::daylight
