#ifdef __cplusplus
#pragma once
#endif
#include "shaders/io/io.h"
IO_BEGIN
// Light in the scene picture is in kilolux (in units of white where a preview is drawn for the eye).
struct SceneParams {
    mat4 clipFromWorld;
    vec3 towardsSun;     // unit; zero when no sun is drawn
    vec3 sunIlluminance; // outside, facing the sun; kilolux
};
// Flat colour for what is not simulated.
struct SolidParams {
    mat4 clipFromWorld;
    vec4 colour;
    vec3 key;       // direction from which the shape is modelled a little; zero: plain colour
    float shading;  // how much darker a face turned away from it is
    float pushBack; // metres away from the eye, so that coplanar surfaces win
};
struct SunPane {
    vec3 normal; // divided by its cosine with the sun: distance along the ray = offset - dot(normal, p)
    float offset;
    vec3 transmittance;
    uint firstEdge;
    uint edgeCount;
    uint leaves; // 1 where the ray leaves a room here
};
struct SunPaneHeader {
    vec3 u; // across the rays
    vec3 v;
    uint paneCount;
    uint needsExit; // 1: a ray that leaves its room through no pane is dark
};
IO_END
