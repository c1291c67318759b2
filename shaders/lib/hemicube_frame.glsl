// Where a hemicube stands: position, two tangents and the normal; and its faces, 0 the top, 1..4 the sides.
struct Frame {
    vec3 origin, u, v, n;
};

// Components along (pixel column, pixel line, depth) of a face. All five maps are orthonormal, so planes turn as points
// do.
vec3 toFace(vec3 p, uint face) {
    if (face == 0u) return p;
    if (face == 1u) return vec3(p.y, p.z, p.x);
    if (face == 2u) return vec3(-p.y, p.z, -p.x);
    if (face == 3u) return vec3(-p.x, p.z, p.y);
    return vec3(p.x, p.z, -p.y);
}

Frame frameOf(uvec4 v0, uvec4 v1, uvec4 v2) { // a viewpoint's texels, shaders/io/hemicube.io.h
    Frame frame;
    frame.origin = uintBitsToFloat(v0.xyz);
    frame.n = uintBitsToFloat(v1.xyz);
    frame.u = uintBitsToFloat(v2.xyz);
    frame.v = cross(frame.n, frame.u);
    return frame;
}
