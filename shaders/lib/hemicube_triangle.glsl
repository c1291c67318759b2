// A triangle as a hemicube sees it, and where the lists of triangles to raster lie. For shaders with `triangles`, as
// shaders/io/hemicube.io.h has them, and `params`.
struct Raster {
    vec3 a, b, c;    // corners
    vec3 ea, eb, ec; // edge planes, positive inside
    vec3 depth;      // depth . direction = 1 / depth along the face
    float volume;    // twice the area times the distance of the plane; negative seen from the front
    uint id;
    bool visible;
};

Raster setUp(uint t, Frame frame, uint self, uint room) {
    uvec4 t0 = texelFetch(triangles, int(3u * t)), t1 = texelFetch(triangles, int(3u * t + 1u)),
          t2 = texelFetch(triangles, int(3u * t + 2u));
    mat3 turn = transpose(mat3(frame.u, frame.v, frame.n));
    Raster r;
    r.a = turn * (uintBitsToFloat(t0.xyz) - frame.origin);
    r.b = turn * (uintBitsToFloat(t1.xyz) - frame.origin);
    r.c = turn * (uintBitsToFloat(t2.xyz) - frame.origin);
    vec3 normal = cross(r.b - r.a, r.c - r.a);
    r.volume = dot(normal, r.a);
    float side = r.volume < 0.0 ? -1.0 : 1.0;
    r.ea = side * cross(r.b, r.c);
    r.eb = side * cross(r.c, r.a);
    r.ec = side * cross(r.a, r.b);
    r.depth = normal / r.volume;
    r.id = t0.w * 2u + (r.volume < 0.0 ? 0u : kHemicubeBack);
    r.visible = t0.w != self && (room == kHemicubeAnyRoom || t1.w == room) &&
                max(r.a.z, max(r.b.z, r.c.z)) > params.flatness &&
                abs(r.volume) > params.flatness * length(normal);
    return r;
}

// Where class `size` of a viewpoint of this dispatch keeps its k-th entry: two lists, each filled from both ends.
uint listPlace(uint viewpoint, uint size, uint k) {
    uint half_ = params.listLength / 2u;
    uint place = (size / 2u) * half_ + ((size & 1u) == 0u ? k : half_ - 1u - k);
    return viewpoint * params.listLength + place;
}
