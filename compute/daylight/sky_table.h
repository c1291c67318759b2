// Luminances of eight skies at once by two tables each, for many directions: 1 ns a sky and direction instead
// of 40.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include <glm/vec3.hpp>

#include "compute/daylight/sky.h"

namespace heliodon::daylight {

// Of separable formulas. About 30 us a sky.
class alignas(32) SkyTables { // as AVX2 reads it, whatever the rest is compiled for
public:
    static constexpr size_t kSkies = 8;
    using Floats [[gnu::vector_size(kSkies * sizeof(float))]] = float; // one of each sky

    // Null is a black one. Throws std::invalid_argument on the intermediate sky's.
    explicit SkyTables(std::span<const Sky* const, kSkies> skies);

    // Where the gradation of a direction of height z = direction.y > 0 stands in its table: the same for
    // every sky.
    static float heightIndex(double z) { return static_cast<float>(kHeights * std::sqrt(z)); }

    // Adds `weight` times cd/m2 of a unit direction above the horizon, whose heightIndex is given. Off
    // Sky::luminance by 2e-5 of the sky's brightest in the root mean square over a year, by at most 2e-3 of
    // its own just above the horizon. As fast as said where compiled for AVX2, without math-errno.
    [[gnu::always_inline]] inline void add(glm::vec3 direction, float heightIndex, float weight,
                                           Floats& sums) const {
        // By the chord to the sun, in which the cone's tip there is none.
        const Floats x = direction.x - x_, y = direction.y - y_, z = direction.z - z_;
        Floats chord = x * x + y * y + z * z;
        for (size_t k = 0; k < kSkies; ++k) chord[k] = std::sqrt(chord[k]);
        chord *= 0.5F * kChords;
        const Ints at = __builtin_convertvector(chord, Ints);
        Floats nearer, farther;
        for (size_t k = 0; k < kSkies; ++k) {
            const auto row = static_cast<size_t>(at[k]);
            nearer[k] = indicatrix_[row][k], farther[k] = indicatrix_[row + 1][k];
        }
        const auto row = static_cast<size_t>(heightIndex);
        const Floats above = gradation_[row + 1] - gradation_[row],
                     beyond = chord - __builtin_convertvector(at, Floats);
        const Floats values = (gradation_[row] + (heightIndex - static_cast<float>(row)) * above) *
                              (nearer + beyond * (farther - nearer));
        sums += weight * (values > 0 ? values : 0);
    }

private:
    using Ints [[gnu::vector_size(kSkies * sizeof(int))]] = int;
    static constexpr int kHeights = 512, kChords = 512;

    Floats x_{}, y_{}, z_{}; // of the suns
    // One more than an index may reach by rounding.
    std::array<Floats, kHeights + 2> gradation_{};
    std::array<Floats, kChords + 2> indicatrix_{};
};

} // namespace heliodon::daylight
