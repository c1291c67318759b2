#include "compute/daylight/window.h"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "compute/daylight/quadrature.h"

namespace heliodon::daylight {

namespace {

using Kind = geometry::Blind::Kind;

// Seen along the slats, which run level in the opening's plane; along x where that itself is level.
double profileAngle(glm::dvec3 towards, glm::dvec3 normal) {
    glm::dvec3 up = glm::dvec3(0, 1, 0) - normal.y * normal;
    up = glm::length(up) > 1e-6 ? glm::normalize(up) : glm::dvec3(0, 0, -1);
    return std::atan2(glm::dot(towards, up), -glm::dot(towards, normal));
}

} // namespace

Window::Window(const geometry::Material& opening) : glazing_(glazingOf(opening)), kind_(opening.blind.kind) {
    const geometry::Blind& blind = opening.blind;
    if (kind_ == Kind::none) return;
    if (kind_ == Kind::slats) {
        slats_.emplace(double{blind.slatAngleDeg}, double{blind.slatSpacing}, double{blind.reflectance});
        transmittance_ = slats_->diffuseTransmittance(), reflectance_ = slats_->diffuseReflectance();
    } else {
        transmittance_ = double{blind.transmittance}, reflectance_ = double{blind.reflectance};
    }
    if (glazing_.isHole()) return;
    for (int c = 0; c < 3; ++c)
        for (const auto& [cosine, weight] : kGauss24)
            glassReflectance_[c] +=
                weight * 2 * cosine *
                slabReflectance(cosine, glazing_.transmissivity[c], glazing_.refractiveIndex);
}

glm::dvec3 Window::betweenGlassAndBlind() const {
    return glassReflectance_ / (1.0 - glassReflectance_ * reflectance_);
}

glm::dvec3 Window::straight(glm::dvec3 towards, glm::dvec3 normal) const {
    const double cosine = -glm::dot(towards, normal);
    if (cosine <= 0 || kind_ == Kind::fabric) return glm::dvec3(0);
    const double between = slats_ ? slats_->straight(profileAngle(towards, normal)) : 1;
    return between > 0 ? between * glazing_.transmittance(cosine) : glm::dvec3(0);
}

glm::dvec3 Window::scattered(glm::dvec3 towards, glm::dvec3 normal) const {
    const double cosine = -glm::dot(towards, normal);
    if (cosine <= 0 || !hasBlind()) return glm::dvec3(0);
    const double profile = slats_ ? profileAngle(towards, normal) : 0;
    const double on = slats_ ? slats_->scattered(profile) : transmittance_,
                 back = slats_ ? slats_->reflected(profile) : reflectance_;
    return glazing_.transmittance(cosine) * (on + back * transmittance_ * betweenGlassAndBlind());
}

glm::dvec3 Window::roomReflectance() const {
    if (!hasBlind()) return glm::dvec3(0);
    return reflectance_ + transmittance_ * transmittance_ * betweenGlassAndBlind();
}

// Over directions by Gauss's rule in the square of the sine from the normal and evenly around it.
glm::dvec3 Window::diffuseTransmittance() const {
    if (!slats_)
        return glazing_.diffuseTransmittance() *
               (hasBlind() ? transmittance_ * (1.0 + reflectance_ * betweenGlassAndBlind()) : glm::dvec3(1));
    constexpr int kAround = 96;
    const glm::dvec3 normal(0, 0, 1);
    glm::dvec3 sum(0);
    for (const auto& [square, weight] : kGauss24)
        for (int k = 0; k < kAround; ++k) {
            const double turn = 2 * std::numbers::pi * (k + 0.5) / kAround, sine = std::sqrt(square);
            const glm::dvec3 towards(sine * std::cos(turn), sine * std::sin(turn), -std::sqrt(1 - square));
            sum += weight / kAround * (straight(towards, normal) + scattered(towards, normal));
        }
    return sum;
}

geometry::Material withBlind(geometry::Material opening, const geometry::Blind& blind) {
    opening.blind = blind;
    if (blind.kind != Kind::none) opening.reflectance = glm::vec3(Window(opening).roomReflectance());
    return opening;
}

} // namespace heliodon::daylight
