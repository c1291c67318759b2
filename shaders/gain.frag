// The gain by which light becomes a projector's intensity (metres squared): share r^2 / (rho cos theta), after
// R. Raskar et al., "Shader Lamps" (2001). It changes with the geometry alone, and is drawn once for it; so is, as
// light to begin with, the exitance (lux) that all projectors leak: what is black is as bright as they are many.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/gain.io.h"

layout(location = 0) in vec3 pointInWorld;
layout(location = 1) in vec3 smoothNormal;
layout(location = 2) flat in uint triangle;
layout(set = 0, binding = 0, scalar) readonly buffer Projectors { BlendProjector projectors[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Triangles { BlendTriangle triangles[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Borders { BlendBorder borders[]; };
layout(push_constant, scalar) uniform Push { GainParams params; };

layout(location = 0) out vec4 colour; // alpha: the gain

float distanceToSegment(vec3 p, vec3 from, vec3 to) {
    vec3 along = to - from;
    float t = clamp(dot(p - from, along) / dot(along, along), 0.0, 1.0);
    return distance(from + t * along, p);
}

// cos / r^2.
float steepness(uint projector) {
    vec3 towards = projectors[projector].centre - pointInWorld;
    float r2 = dot(towards, towards);
    return max(dot(normalize(smoothNormal), towards) * inversesqrt(r2), params.leastCosine) / r2;
}

float fade(uint projector) {
    float nearest = params.falloff, end = params.falloff;
    for (uint i = triangles[triangle].firstBorder; i < triangles[triangle + 1].firstBorder; ++i)
        if (((borders[i].left ^ borders[i].right) >> projector & 1u) != 0u) {
            float away = distanceToSegment(pointInWorld, borders[i].from, borders[i].to);
            if (borders[i].right == 0u)
                end = min(end, away);
            else
                nearest = min(nearest, away);
        }
    float beyond = max(nearest - params.guard, 0.0) / (params.falloff - params.guard);
    float x = clamp(beyond + params.leastSlope * nearest / params.falloff, params.leastFade, 1.0);
    return smoothstep(0.0, 1.0, x) * mix(params.endFade, 1.0, smoothstep(0.0, params.falloff, end));
}

void main() {
    uint visible = triangles[triangle].visible;
    colour = vec4(0);
    if ((visible >> params.projector & 1u) == 0u) return;
    float all = 0.0, own = 0.0, leaked = 0.0;
    for (uint p = 0u; p < params.projectorCount; ++p) {
        if ((visible >> p & 1u) == 0u) continue;
        float weight = fade(p) * projectors[p].candela * steepness(p);
        all += weight;
        if (p == params.projector) own = weight;
        leaked += projectors[p].leak * params.shownReflectance * steepness(p);
    }
    colour = vec4(vec3(leaked), own / (all * params.shownReflectance * steepness(params.projector)));
}
