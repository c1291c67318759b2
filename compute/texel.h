// Values as texels of 32-bit numbers, for buffers that shaders read as usamplerBuffer.
#pragma once

#include <bit>
#include <cstdint>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace heliodon::compute {

inline uint32_t bitsOf(double x) {
    return std::bit_cast<uint32_t>(static_cast<float>(x));
}

// Three floats by their bits, and a number.
inline glm::uvec4 texelOf(const glm::dvec3& v, uint32_t w) {
    return {bitsOf(v.x), bitsOf(v.y), bitsOf(v.z), w};
}

} // namespace heliodon::compute
