// What sensors answer to the light of any moment: to each sky element, to sun on each patch, to what blinds
// scatter and to the room's own emission. Importance, as annual_daylight.h has it: a sensor costs one
// solution of the radiosity system, whatever the number of moments.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/daylight_transport.h"
#include "compute/host_gather.h"

namespace heliodon::compute {

struct SensorResponses {
    size_t sensors = 0;
    std::vector<float> sky; // sensors x elements, photometric; not what they see straight (StraightSky)
    // Rows (glow_rows.h) x sensors, each times its channel's luminous share; one unless panes are tinted.
    std::array<std::vector<float>, 3> sun;
    std::vector<float> own; // per sensor, lux

    // What light on one row gives, added to one value a sensor. Where one channel stands for three, light
    // that walls have coloured counts by its lux.
    void add(size_t row, glm::vec3 lux, float* to) const {
        if (sun[1].empty()) lux = glm::vec3(static_cast<float>(photometric(lux)));
        for (int b = 0; b < 3 && !sun[static_cast<size_t>(b)].empty(); ++b) {
            const float *answer = &sun[static_cast<size_t>(b)][row * sensors], times = lux[b];
            for (size_t s = 0; s < sensors; ++s) to[s] += times * answer[s];
        }
    }
};

class SensorResponder {
public:
    using Told = std::function<void(size_t sensors)>; // after some more of them

    // `transport` must outlive this and keep its materials.
    explicit SensorResponder(DaylightTransport& transport);

    // Of the transport's sensors: 2.5 CPU ms each at 500 patches, in proportion to them. Form factors are
    // held once more: on the host, which gathers there, of at most 8000 patches in its memory.
    SensorResponses respond(const TransportParts& parts, const Told& told);

    size_t bytes() const { return bytes_; } // held between calls, of the host

private:
    struct Importance;
    // Per channel of the sky, sensors x patches: importance of what falls on patches like the sky, smoothly.
    using Smooth = std::array<std::vector<float>, 3>;

    void takeFactors(const TransportParts& parts);
    Importance importanceOf(const TransportParts& parts, size_t first, size_t count);
    void addAnswers(const TransportParts& parts, const Importance& sent, size_t k, SensorResponses& result,
                    Smooth& smooth) const;
    void addSky(const TransportParts& parts, const Smooth& smooth, SensorResponses& result) const;
    void addLobes(const TransportParts& parts, const Smooth& smooth, SensorResponses& result) const;
    void addGlow(const TransportParts& parts, SensorResponses& result) const;
    void hideGlow(const TransportParts& parts, SensorResponses& result) const;
    void addOutside(const TransportParts& parts, const Smooth& smooth, SensorResponses& result) const;

    DaylightTransport& transport_;
    size_t beams_;               // that a sensor answers to apart: 3 where panes are tinted, else 1
    std::vector<float> area_;    // of patches
    std::vector<uint8_t> clear_; // patches of clear glass between rooms
    size_t bytes_ = 0;
    gpu::Buffer adjoint_; // where the device gathers faster
    std::unique_ptr<FormFactorOperator> gather_;
    std::optional<TintedFactors> tinted_;
    std::optional<RadiositySolver> solver_;
};

} // namespace heliodon::compute
