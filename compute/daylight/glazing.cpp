#include "compute/daylight/glazing.h"

#include <algorithm>
#include <cmath>

#include "compute/daylight/quadrature.h"

namespace heliodon::daylight {

namespace {

double normalReflectance(double n) {
    return (n - 1.0) * (n - 1.0) / ((n + 1.0) * (n + 1.0));
}

// Equal channels are common (grey glass) and cost one evaluation.
template<typename F> glm::dvec3 perChannel(glm::dvec3 v, F f) {
    const double x = f(v.x);
    const double y = v.y == v.x ? x : f(v.y);
    return {x, y, v.z == v.y ? y : f(v.z)};
}

} // namespace

double maximumTransmittance(double n) {
    const double r = normalReflectance(n);
    return (1.0 - r) / (1.0 + r);
}

double transmissivityFromNormal(double tn, double n) {
    if (tn <= 0) return 0;
    const double r = normalReflectance(n);
    const double pass = (1.0 - r) * (1.0 - r);
    // The root in the header with its numerator made a sum: no cancellation for small Tn, and r = 0 is no
    // exception.
    const double t = 2.0 * tn / (pass + std::sqrt(pass * pass + 4.0 * r * r * tn * tn));
    return std::min(t, 1.0);
}

double slabTransmittance(double cosine, double t, double n) {
    const double c = std::min(std::abs(cosine), 1.0);
    if (c <= 0 || t <= 0) return 0;
    const double c2 = std::sqrt(1.0 - (1.0 - c * c) / (n * n));
    const double d = t >= 1.0 ? 1.0 : std::pow(t, 1.0 / c2);
    const auto polarised = [&](double amplitude) {
        const double r = amplitude * amplitude;
        if (r >= 1) return 0.0; // grazing, to the last bit
        return 0.5 * (1.0 - r) * (1.0 - r) * d / (1.0 - r * r * d * d);
    };
    return polarised((c - n * c2) / (c + n * c2)) + polarised((c2 - n * c) / (c2 + n * c));
}

double slabReflectance(double cosine, double t, double n) {
    const double c = std::min(std::abs(cosine), 1.0);
    if (c <= 0) return 1;
    const double c2 = std::sqrt(1.0 - (1.0 - c * c) / (n * n));
    const double d = t <= 0 ? 0.0 : t >= 1.0 ? 1.0 : std::pow(t, 1.0 / c2);
    const auto polarised = [&](double amplitude) {
        const double r = amplitude * amplitude;
        if (r >= 1) return 0.5;
        return 0.5 * (r + r * (1.0 - r) * (1.0 - r) * d * d / (1.0 - r * r * d * d));
    };
    return polarised((c - n * c2) / (c + n * c2)) + polarised((c2 - n * c) / (c2 + n * c));
}

glm::dvec3 Glazing::transmittance(double cosine) const {
    if (isHole()) return transmissivity;
    return perChannel(transmissivity,
                      [&](double t) { return slabTransmittance(cosine, t, refractiveIndex); });
}

glm::dvec3 Glazing::diffuseTransmittance() const {
    if (isHole()) return transmissivity;
    return perChannel(transmissivity, [&](double t) {
        double sum = 0;
        for (const auto& [c, w] : kGauss24) sum += w * 2.0 * c * slabTransmittance(c, t, refractiveIndex);
        return sum;
    });
}

Glazing glazingOf(const geometry::Material& material) {
    const double n = std::max(1.0, static_cast<double>(material.refractiveIndex));
    Glazing glazing;
    glazing.refractiveIndex = n;
    glazing.transmissivity = perChannel(glm::dvec3(material.transmittance), [&](double tn) {
        return n <= 1.0 ? std::clamp(tn, 0.0, 1.0) : transmissivityFromNormal(tn, n);
    });
    return glazing;
}

bool isPossible(const geometry::Material& material) {
    const double limit =
        maximumTransmittance(std::max(1.0, static_cast<double>(material.refractiveIndex))) + 1e-6;
    const auto& t = material.transmittance;
    return t.x <= limit && t.y <= limit && t.z <= limit;
}

} // namespace heliodon::daylight
