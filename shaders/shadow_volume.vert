// Corners of shadow volumes; w = 0 lies at infinity.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/scene.io.h"
#include "shaders/lib/clip.glsl"

layout(location = 0) in vec4 point;
layout(push_constant, scalar) uniform Push { SceneParams params; };

invariant gl_Position;

void main() {
    gl_Position = clipFromPoint(params.clipFromWorld, point);
}
