// A patch's corner: place and light.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/scene.io.h"
#include "shaders/lib/clip.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 reflectance;
layout(location = 3) in vec3 light;
layout(push_constant, scalar) uniform Push { SceneParams params; };
layout(constant_id = 0) const bool kSun = false;

invariant gl_Position;
layout(location = 0) out vec3 pointInWorld;
layout(location = 1) out vec3 lightOut; // the sun pass: reflected sun before glazing

void main() {
    gl_Position = clipFromPoint(params.clipFromWorld, vec4(position, 1));
    pointInWorld = position;
    lightOut = light;
    if (kSun) {
        float cosine = dot(normal, params.towardsSun);
        lightOut = reflectance * params.sunIlluminance * cosine;
        // All corners of a patch share its normal: what is turned from the sun shrinks to nothing.
        if (cosine <= 0.0) gl_Position = vec4(2, 2, 0, 1);
    }
}
