#ifdef __cplusplus
#pragma once
#endif
#include "shaders/io/io.h"
IO_BEGIN
// A projector's gain on the surfaces that it shows.
struct GainParams {
    mat4 clipFromWorld;
    float shownReflectance; // of the physical surface
    float guard;            // the fade's, of geometry/projector_blend.h
    float falloff;
    float leastSlope;
    float leastFade;
    float endFade;
    float leastCosine;
    uint projector; // whose gain it is
    uint projectorCount;
};
struct BlendProjector {
    vec3 centre;
    float candela; // of its white
    float leak;    // of its black
};
// One more than there are triangles: the last only ends the list of borders.
struct BlendTriangle {
    uint visible; // the projectors that see it, as bits
    uint firstBorder;
};
// An edge between two sets of projectors (bits).
struct BlendBorder {
    vec3 from;
    uint left;
    vec3 to;
    uint right;
};
IO_END
