#include "engine/app/finite_light.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

namespace heliodon::app {

namespace {

[[noreturn]] void refuse(const char* kind, size_t place, const std::string& found) {
    throw std::runtime_error(
        fmt::format("{} {} (counted from 0) gets light that is no finite number ({}): nothing is written of "
                    "it, the program is at fault",
                    kind, place, found));
}

void expectFinite(const char* kind, std::span<const compute::LightParts> places) {
    for (size_t k = 0; k < places.size(); ++k) {
        const compute::LightParts& p = places[k];
        const glm::vec3 total = p.total();
        if (std::isfinite(total.x) && std::isfinite(total.y) && std::isfinite(total.z) &&
            std::isfinite(p.error))
            continue;
        refuse(kind, k,
               fmt::format("sun {:.6g}, sky {:.6g}, ground {:.6g}, interreflected {:.6g}, error {:.4g} lux",
                           compute::photometric(p.sun), compute::photometric(p.sky),
                           compute::photometric(p.ground), compute::photometric(p.interreflected),
                           static_cast<double>(p.error)));
    }
}

} // namespace

void expectFinite(const compute::Moment& moment) {
    expectFinite("sensor", moment.sensors);
    expectFinite("patch", moment.patches);
}

void expectFinite(std::span<const float> lux, size_t first, size_t records) {
    for (size_t at = 0; at < lux.size(); ++at)
        if (!std::isfinite(lux[at])) refuse("sensor", first + at / records, fmt::format("{} lux", lux[at]));
}

} // namespace heliodon::app
