// What is drawn but not simulated: a flat colour, modelled a little by the direction of each face.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/scene.io.h"
#include "shaders/lib/clip.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(push_constant, scalar) uniform Push { SolidParams params; };

invariant gl_Position;
layout(location = 0) flat out vec4 colour;

void main() {
    gl_Position = clipFromPoint(params.clipFromWorld, vec4(position, 1));
    // Reversed depth is near / distance: the same, further away.
    gl_Position.z *= gl_Position.w / (gl_Position.w + params.pushBack);
    colour = params.colour;
    colour.rgb *= 1.0 - params.shading * (0.5 - 0.5 * dot(normal, params.key));
}
