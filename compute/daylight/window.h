// An opening as it stands: its glass, and a blind before it on the room's side. Light from one direction is
// split into what passes straight on and what the blind scatters: fabrics evenly in all directions
// (Lambertian), slats as one sees them, up from faces that the sun shines on and hardly down (slats.h).
// Between glass and blind light goes to and fro, counted to the end.
//   straight  = g(c) b                         g: glass at cosine c; b: straight through the blind
//   scattered = g(c) (s + r R T / (1 - R Q))   s, r: scattered on and reflected by the blind from that way
//   room      = Q + T^2 R / (1 - R Q)          T, Q: of the blind, R: of the glass, from everywhere
// So for a fabric, with b = 0, s = T and r = Q from every direction. For slats r, T and Q are matrices
// between directions, and R is the glass's mirror, which keeps the elevation of light: its reflectance by
// that, over all turns along the slats; but what it sends straight on between the slats into the room is told
// by the turn, too. Glass is some spacings off: what it mirrors falls on slats anywhere. Errors: Lambertian
// faces and a blind without end are the model; the glow is even over the opening, right on average and,
// within about one spacing of the slats, wrong in detail, as is the even shade of what passes between them.
// What the opening sends back into the room is taken to leave evenly.
#pragma once

#include <array>
#include <optional>

#include <glm/vec3.hpp>

#include "compute/daylight/glazing.h"
#include "compute/daylight/slats.h"
#include "geometry/patch_mesh.h"

namespace heliodon::daylight {

// Directions of light from slats: nodes for what the faces send, then as many for what glass mirrors.
constexpr size_t kSlatLobes = 2 * kSlatNodes;
inline double lobeShare(size_t lobe) {
    return nodeShare(lobe % kSlatNodes);
}

class Window {
public:
    // About 6 ms and 190 KB with slats, next to nothing otherwise.
    explicit Window(const geometry::Material& opening);

    const Glazing& glazing() const { return glazing_; }
    bool hasBlind() const { return kind_ != geometry::Blind::Kind::none; }
    bool hasSlats() const { return slats_.has_value(); }
    bool passesStraight() const { return kind_ != geometry::Blind::Kind::fabric; }

    // Per channel, of what falls on the opening from outside. `towards`: unit, to the source; `normal`: unit,
    // into the room. Zero for directions from inside.
    glm::dvec3 straight(glm::dvec3 towards, glm::dvec3 normal) const;
    glm::dvec3 scattered(glm::dvec3 towards, glm::dvec3 normal) const;

    // Of slats: how what is scattered differs from an even glow, as luminance x pi: of the slats' own faces
    // in the nodes' directions, then, again by nodes, of what the glass mirrors and slats let pass, in the
    // mean over all turns along the slats. Glass mirrors sideways more than straight on: such light has
    // mirrored() times that mean. The mean of all over their shares is 0.
    using Lobes = std::array<glm::dvec3, kSlatLobes>;
    // `direction`: any length, of light that travels into the room; 0 without glass.
    double mirrored(glm::dvec3 direction, glm::dvec3 normal) const;
    Lobes lobes(glm::dvec3 towards, glm::dvec3 normal) const;
    Lobes lobesBehindGlass(double profile) const; // of what the glass has let in, from a profile angle
    // Elevation at which light travels into the room, seen along the slats, radians. `direction`: any length.
    static double slatElevation(glm::dvec3 direction, glm::dvec3 normal);

    // Of light from the room, by glass and blind together; zero without a blind.
    glm::dvec3 roomReflectance() const;
    // Of light from outside from all directions alike, straight and scattered, through glass and blind.
    glm::dvec3 diffuseTransmittance() const;

private:
    glm::dvec3 betweenGlassAndBlind() const; // R / (1 - R Q), of a fabric
    void sendBackByGlass();

    Glazing glazing_;
    geometry::Blind::Kind kind_;
    std::optional<Slats> slats_;
    double transmittance_ = 0, reflectance_ = 0; // T and Q
    glm::dvec3 glassReflectance_{0};             // R
    std::array<Lobes, kSlatNodes>
        byGlass_{};             // light of slats on the room's side, of what leaves towards the glass
    SlatLight mirror_{};        // of the glass, by elevation, in the mean of the channels
    glm::dvec3 roomByGlass_{0}; // of light from the room through slats, sent back
};

// The material of an opening with a blind drawn: its reflectance is that of both.
geometry::Material withBlind(geometry::Material opening, const geometry::Blind& blind);

} // namespace heliodon::daylight
