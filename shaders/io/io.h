// What makes one header readable as GLSL and as C++20. A `*.io.h` file is, in this order: this include, IO_BEGIN,
// constants and structs, IO_END. Scalar block layout on the device, natural layout on the host: the same, as long
// as members are scalars or vectors of 4-byte components.
#ifdef __cplusplus
#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#define IO_BEGIN namespace heliodon::io { using glm::vec2; using glm::vec3; using glm::vec4; using glm::uvec2; \
    using glm::uvec4; using glm::mat4; using uint = uint32_t;
#define IO_END }
#else
#ifndef IO_H
#define IO_H
#define IO_BEGIN
#define IO_END
#endif
#endif
