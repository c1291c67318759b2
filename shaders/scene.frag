// Light that leaves the surface, kilolux per channel. Alpha: in a preview 1 ("simulated light"), for a
// projector the gain by which light becomes intensity (metres squared): share r^2 / (rho cos theta), after
// R. Raskar et al., "Shader Lamps" (2001).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/scene.io.h"

layout(location = 0) in vec3 pointInWorld;
layout(location = 1) in vec4 lightAndShare;
layout(location = 2) in vec3 smoothNormal;
layout(push_constant, scalar) uniform Push { SceneParams params; };
layout(constant_id = 1) const bool kProjector = false;

layout(location = 0) out vec4 colour;

void main() {
    colour = vec4(lightAndShare.rgb, 1);
    if (!kProjector) return;
    vec3 towardsEye = params.eye - pointInWorld;
    float r2 = dot(towardsEye, towardsEye);
    // The share is zero below the grazing limit; this bound only keeps the quotient finite.
    float cosine = max(dot(normalize(smoothNormal), towardsEye) * inversesqrt(r2), 0.05);
    colour.a = lightAndShare.a * r2 / (params.shownReflectance * cosine);
}
