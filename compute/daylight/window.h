// An opening as it stands: its glass, and a blind before it on the room's side. Light from one direction is
// split into what passes straight on and what the blind scatters, which leaves it evenly in all directions
// (Lambertian), as does what the room sends back. Between glass and blind light goes to and fro, counted to
// the end with the glass's reflectance for light from all directions alike (1 - sums of the slab's, see
// glazing.h).
//   straight  = g(c) b                         g: glass at cosine c; b: straight through the blind
//   scattered = g(c) (s + r R T / (1 - R Q))   s, r: scattered on and reflected by the blind from that
//   direction room      = Q + T^2 R / (1 - R Q)          T, Q: of the blind, R: of the glass, light from
//   everywhere
// A fabric has b = 0, s = T and r = Q from every direction; for slats see slats.h. Errors: Lambertian faces
// and the even glow of the whole opening are the model; that glow is right on average and, within about one
// spacing of the slats, wrong in detail, as is the even shade of what passes between them.
#pragma once

#include <optional>

#include <glm/vec3.hpp>

#include "compute/daylight/glazing.h"
#include "compute/daylight/slats.h"
#include "geometry/patch_mesh.h"

namespace heliodon::daylight {

class Window {
public:
    // About 0.2 ms with slats, next to nothing otherwise.
    explicit Window(const geometry::Material& opening);

    const Glazing& glazing() const { return glazing_; }
    bool hasBlind() const { return kind_ != geometry::Blind::Kind::none; }
    bool passesStraight() const { return kind_ != geometry::Blind::Kind::fabric; }

    // Per channel, of what falls on the opening from outside. `towards`: unit, to the source; `normal`: unit,
    // into the room. Zero for directions from inside.
    glm::dvec3 straight(glm::dvec3 towards, glm::dvec3 normal) const;
    glm::dvec3 scattered(glm::dvec3 towards, glm::dvec3 normal) const;

    // Of light from the room, by glass and blind together; zero without a blind.
    glm::dvec3 roomReflectance() const;
    // Of light from outside from all directions alike, straight and scattered, through glass and blind.
    glm::dvec3 diffuseTransmittance() const;

private:
    glm::dvec3 betweenGlassAndBlind() const; // R / (1 - R Q)

    Glazing glazing_;
    geometry::Blind::Kind kind_;
    std::optional<Slats> slats_;
    double transmittance_ = 0, reflectance_ = 0; // T and Q
    glm::dvec3 glassReflectance_{0};             // R
};

// The material of an opening with a blind drawn: its reflectance is that of both.
geometry::Material withBlind(geometry::Material opening, const geometry::Blind& blind);

} // namespace heliodon::daylight
