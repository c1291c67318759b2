// Absorbing slab: transmittance at incidence cosine c, from its transmissivity t (per normal passage) and refractive index
// n. Both polarisations with all inner reflections; n = 1, t = 1 is an open hole.
vec3 slabTransmittance(vec3 t, float n, float c) {
    if (n == 1.0) return t;
    c = max(c, 1e-4);
    float c2 = sqrt(max(0.0, 1.0 - (1.0 - c * c) / (n * n)));
    vec3 d = pow(t, vec3(1.0 / c2));
    float r1 = (c - n * c2) / (c + n * c2), r2 = (c2 - n * c) / (c2 + n * c);
    r1 *= r1;
    r2 *= r2;
    return 0.5 * (1.0 - r1) * (1.0 - r1) * d / (1.0 - r1 * r1 * d * d) +
           0.5 * (1.0 - r2) * (1.0 - r2) * d / (1.0 - r2 * r2 * d * d);
}
