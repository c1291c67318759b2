// Lambert's formula in float32, arranged so that small and grazing polygons lose no digits.
#ifndef LAMBERT_GLSL
#define LAMBERT_GLSL
#include "shaders/lib/constants.glsl"

// atan(y / x) for y >= 0, in [0, pi]; two ulp. GLSL's own may be off by 4096 ulp. Polynomial: S. L. Moshier, Cephes.
float angleOf(float y, float x) {
    float low = min(y, abs(x)), high = max(y, abs(x));
    float t = high > 0.0 ? low / high : 0.0;
    bool reduce = t > 0.41421356237;
    float s = reduce ? (t - 1.0) / (t + 1.0) : t;
    float z = s * s;
    float p = (((8.05374449538e-2 * z - 1.38776856032e-1) * z + 1.99777106478e-1) * z - 3.33329491539e-1) * z * s + s;
    float a = reduce ? 0.785398163397 + p : p;
    a = y > abs(x) ? 1.57079632679 - a : a;
    return x < 0.0 ? kPi - a : a;
}

// Twice pi times the share of the edge a -> b (relative to the element) in the element's form factor.
float lambertEdge(vec3 a, vec3 b, vec3 normal) {
    vec3 c = cross(a, b - a); // a x b, exact for short edges
    float sine = length(c), cosine = dot(a, b);
    return sine > 0.0 ? angleOf(sine, cosine) / sine * dot(c, normal) : 0.0;
}
#endif
