// Corners of a patch for the gain: shaders/gain.frag.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/gain.io.h"
#include "shaders/lib/clip.glsl"

layout(location = 0) in vec3 position;
layout(location = 5) in vec3 smoothNormal;
layout(push_constant, scalar) uniform Push { GainParams params; };

layout(location = 0) out vec3 pointInWorld;
layout(location = 1) out vec3 smoothNormalOut;
layout(location = 2) flat out uint triangle;

void main() {
    gl_Position = clipFromPoint(params.clipFromWorld, vec4(position, 1));
    pointInWorld = position;
    smoothNormalOut = smoothNormal;
    triangle = gl_VertexIndex / 3;
}
