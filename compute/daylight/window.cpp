#include "compute/daylight/window.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "compute/daylight/quadrature.h"

namespace heliodon::daylight {

namespace {

using Kind = geometry::Blind::Kind;

// Upwards across the slats, which run level in the opening's plane; along x where that itself is level.
glm::dvec3 upAcross(glm::dvec3 normal) {
    const glm::dvec3 up = glm::dvec3(0, 1, 0) - normal.y * normal;
    return glm::length(up) > 1e-6 ? glm::normalize(up) : glm::dvec3(0, 0, -1);
}

double profileAngle(glm::dvec3 towards, glm::dvec3 normal) {
    return std::atan2(glm::dot(towards, upAcross(normal)), -glm::dot(towards, normal));
}

glm::dvec3 mean(const Window::Lobes& lobes) {
    glm::dvec3 sum(0);
    for (size_t lobe = 0; lobe < lobes.size(); ++lobe) sum += lobeShare(lobe) * lobes[lobe];
    return sum;
}

// What a pane reflects of light about a node's elevation, over all turns along the slats.
SlatLight mirrorOf(double transmissivity, double refractiveIndex) {
    constexpr size_t kFine = 8; // between two nodes
    SlatLight mirror{};
    for (size_t q = 0; q < kFine * (kSlatNodes - 1); ++q) {
        const double elevation =
            std::numbers::pi * ((static_cast<double>(q) + 0.5) / (kFine * (kSlatNodes - 1)) - 0.5);
        double sum = 0, weights = 0;
        for (const auto& [x, weight] : kGauss24) {
            const double turn = 0.5 * std::numbers::pi * x, share = weight * std::cos(turn) * std::cos(turn);
            sum += share *
                   slabReflectance(std::cos(elevation) * std::cos(turn), transmissivity, refractiveIndex);
            weights += share;
        }
        const BetweenNodes at = betweenNodes(elevation);
        const double look =
            0.5 * std::cos(elevation) * sum / weights * std::numbers::pi / (kFine * (kSlatNodes - 1));
        mirror[at.lower] += (1 - at.part) * look / nodeShare(at.lower);
        mirror[at.lower + 1] += at.part * look / nodeShare(at.lower + 1);
    }
    return mirror;
}

} // namespace

Window::Window(const geometry::Material& opening) : glazing_(glazingOf(opening)), kind_(opening.blind.kind) {
    const geometry::Blind& blind = opening.blind;
    if (kind_ == Kind::none) return;
    if (kind_ == Kind::slats) {
        slats_.emplace(double{blind.slatAngleDeg}, double{blind.slatSpacing}, double{blind.reflectance});
        transmittance_ = slats_->diffuseTransmittance(), reflectance_ = slats_->diffuseReflectance();
        if (!glazing_.isHole()) sendBackByGlass();
        return;
    }
    transmittance_ = double{blind.transmittance}, reflectance_ = double{blind.reflectance};
    if (glazing_.isHole()) return;
    for (int c = 0; c < 3; ++c)
        for (const auto& [cosine, weight] : kGauss24)
            glassReflectance_[c] +=
                weight * 2 * cosine *
                slabReflectance(cosine, glazing_.transmissivity[c], glazing_.refractiveIndex);
}

void Window::sendBackByGlass() {
    for (int c = 0; c < 3; ++c) {
        const SlatLight mirror = mirrorOf(glazing_.transmissivity[c], glazing_.refractiveIndex);
        for (size_t node = 0; node < kSlatNodes; ++node) mirror_[node] += mirror[node] / 3;
        // All that arrives at the slats in the end of what leaves towards the glass.
        const auto mirroredOn = [&](const SlatLight& leaving) {
            SlatLight arriving{}, all{};
            for (size_t node = 0; node < kSlatNodes; ++node) arriving[node] = mirror[node] * leaving[node];
            for (double left = 1; left > 1e-12;) {
                left = 0;
                for (size_t node = 0; node < kSlatNodes; ++node)
                    all[node] += arriving[node], left = std::max(left, arriving[node]);
                arriving = slats_->backward(arriving);
                for (size_t node = 0; node < kSlatNodes; ++node) arriving[node] *= mirror[node];
            }
            return all;
        };
        SlatLight even;
        even.fill(1);
        SlatLight outwards = slats_->onward(even); // from the room: the channel turned by half a turn
        std::reverse(outwards.begin(), outwards.end());
        const SlatLight back = slats_->onward(mirroredOn(outwards));
        for (size_t from = 0; from < kSlatNodes; ++from) {
            roomByGlass_[c] += nodeShare(from) * back[from];
            SlatLight one{};
            one[from] = 1;
            const SlatLight arriving = mirroredOn(one), light = slats_->onward(arriving),
                            straight = slats_->straightOn(arriving);
            for (size_t to = 0; to < kSlatNodes; ++to)
                byGlass_[from][to][c] = light[to] - straight[to],
                byGlass_[from][kSlatNodes + to][c] = straight[to];
        }
    }
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
    if (!slats_)
        return glazing_.transmittance(cosine) * transmittance_ *
               (1.0 + reflectance_ * betweenGlassAndBlind());
    const double profile = profileAngle(towards, normal);
    glm::dvec3 all(slats_->scattered(profile));
    if (!glazing_.isHole()) {
        const SlatLight back = slats_->reflectedLight(profile);
        for (size_t node = 0; node < kSlatNodes; ++node) all += back[node] * mean(byGlass_[node]);
    }
    return glazing_.transmittance(cosine) * all;
}

Window::Lobes Window::lobesBehindGlass(double profile) const {
    Lobes lobes{};
    if (!slats_) return lobes;
    const SlatLight on = slats_->scatteredLight(profile), back = slats_->reflectedLight(profile);
    for (size_t to = 0; to < kSlatNodes; ++to) lobes[to] = glm::dvec3(on[to]);
    for (size_t to = 0; to < kSlatLobes; ++to)
        for (size_t from = 0; from < kSlatNodes; ++from) lobes[to] += back[from] * byGlass_[from][to];
    const glm::dvec3 even = mean(lobes);
    for (size_t to = 0; to < kSlatNodes; ++to) lobes[to] -= even;
    return lobes;
}

Window::Lobes Window::lobes(glm::dvec3 towards, glm::dvec3 normal) const {
    const double cosine = -glm::dot(towards, normal);
    if (cosine <= 0 || !slats_) return {};
    Lobes lobes = lobesBehindGlass(profileAngle(towards, normal));
    for (glm::dvec3& lobe : lobes) lobe *= glazing_.transmittance(cosine);
    return lobes;
}

double Window::slatElevation(glm::dvec3 direction, glm::dvec3 normal) {
    return -profileAngle(-direction, normal);
}

double Window::mirrored(glm::dvec3 direction, glm::dvec3 normal) const {
    if (glazing_.isHole()) return 0;
    const double cosine = std::clamp(glm::dot(direction, normal) / glm::length(direction), 0.0, 1.0);
    const BetweenNodes at = betweenNodes(slatElevation(direction, normal));
    double there = 0;
    for (int c = 0; c < 3; ++c)
        there += slabReflectance(cosine, glazing_.transmissivity[c], glazing_.refractiveIndex) / 3;
    return there / ((1 - at.part) * mirror_[at.lower] + at.part * mirror_[at.lower + 1]);
}

glm::dvec3 Window::roomReflectance() const {
    if (!hasBlind()) return glm::dvec3(0);
    if (slats_) return reflectance_ + roomByGlass_;
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
