// Where a ray starts and where it goes, from four numbers in [0, 1).
#ifndef MONTE_CARLO_POINTS_GLSL
#define MONTE_CARLO_POINTS_GLSL

// M. Jarzynski, M. Olano, "Hash Functions for GPU Rendering", 2020: PCG in one dimension.
uint hashOf(uint x) {
    x = x * 747796405u + 2891336453u;
    x = ((x >> ((x >> 28u) + 4u)) ^ x) * 277803737u;
    return (x >> 22u) ^ x;
}

float unitOf(uint bits) { return float(bits >> 8u) * 5.9604644775390625e-8; }

// Area-preserving and continuous: E. Heitz, "A Low-Distortion Map Between Triangle and Square", 2019. Returns the
// weights of both edges.
vec2 squareToTriangle(vec2 s) {
    return s.y > s.x ? vec2(0.5 * s.x, s.y - 0.5 * s.x) : vec2(s.x - 0.5 * s.y, 0.5 * s.y);
}

// Square to disk, lifted to the hemisphere: density cosine / pi. P. Shirley, K. Chiu, "A Low Distortion Map Between
// Disk and Square", 1997; N. Malley.
vec3 squareToCosine(vec2 s) {
    vec2 c = 2.0 * s - 1.0;
    bool wide = abs(c.x) > abs(c.y);
    float r = wide ? c.x : c.y;
    float ratio = r == 0.0 ? 0.0 : (wide ? c.y : c.x) / r;
    float angle = 0.785398163397 * ratio;
    float cosine = cos(angle), sine = sin(angle);
    vec2 d = wide ? r * vec2(cosine, sine) : r * vec2(sine, cosine);
    return vec3(d, sqrt(max(0.0, 1.0 - dot(d, d))));
}
#endif
