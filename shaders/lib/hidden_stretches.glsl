// Of a straight line a convex blocker hides one stretch. Four lines at a time; what is hidden of them is kept as 32
// bits each, so that what any number of blockers hides is their union.
#ifndef HIDDEN_STRETCHES_GLSL
#define HIDDEN_STRETCHES_GLSL

struct Stretches {
    vec4 from, to; // 0 to 1 along the lines
};

// To where a linear function is positive, of which a and b are the values at both ends.
void narrow(inout Stretches s, vec4 a, vec4 b) {
    vec4 t = a / (a - b);
    bvec4 atA = lessThan(a, vec4(0.0)), atB = lessThan(b, vec4(0.0));
    vec4 from = mix(max(s.from, t), vec4(2.0), atB);
    s.from = mix(s.from, from, atA);
    s.to = mix(mix(s.to, min(s.to, t), atB), s.to, atA);
}

// Jittered by less than one bit, so that their mean is the stretch.
uvec4 bitsOf(Stretches s, vec4 jitter) {
    uvec4 from = uvec4(clamp(s.from * 32.0 + jitter, 0.0, 32.0)), to = uvec4(clamp(s.to * 32.0 + jitter, 0.0, 32.0));
    uvec4 count = mix(to - from, uvec4(0u), lessThanEqual(to, from));
    uvec4 bits = ((uvec4(1u) << (count & 31u)) - 1u) << (from & 31u);
    return mix(bits, uvec4(~0u), greaterThan(count, uvec4(31u)));
}
#endif
