// Pieces (what radiates) and, after them, blockers (what hides), as faces with corners in two floats a coordinate: only
// differences of corners are ever used, so positions far from the origin and near contact keep their digits.
#ifndef EXACT_SCENE_GLSL
#define EXACT_SCENE_GLSL
#include "shaders/lib/constants.glsl"
layout(set = 0, binding = 0) uniform samplerBuffer cornerHigh; // w first coordinate in the face's frame
layout(set = 0, binding = 1) uniform samplerBuffer cornerLow;  // w second
layout(set = 0, binding = 2) uniform samplerBuffer faceNormal; // xyz unit normal, w area
layout(set = 0, binding = 3) uniform samplerBuffer faceCentre; // xyz centroid from the first corner, w radius about it
layout(set = 0, binding = 4) uniform usamplerBuffer faceRange; // first corner, corners, room, and more: of pieces the place in
                                                               // its tile, of blockers 1 where they bound a solid

struct Face {
    uint first;
    uint count;
    uint room;
    vec3 normal;
    float area;
    uint more; // as in faceRange
};

Face faceAt(uint index) {
    uvec4 range = texelFetch(faceRange, int(index));
    vec4 n = texelFetch(faceNormal, int(index));
    return Face(range.x, range.y, range.z, n.xyz, n.w, range.w);
}

struct Origin {
    vec3 high;
    vec3 low;
};

Origin originAt(uint corner) {
    return Origin(texelFetch(cornerHigh, int(corner)).xyz, texelFetch(cornerLow, int(corner)).xyz);
}

vec3 cornerFrom(Origin o, uint corner) {
    precise vec3 high = texelFetch(cornerHigh, int(corner)).xyz - o.high;
    precise vec3 low = texelFetch(cornerLow, int(corner)).xyz - o.low;
    precise vec3 sum = high + low; // in this order, or the low halves are lost
    return sum;
}

// What float32 makes of faces. Heights below kFlat of the distance are rounding errors of the normal; planes whose sine
// is less than kParallel are parallel; borders of shadows are good to kBorder of the distance, as angles are to about
// 1e-7; less than kLeft of a piece is what such borders leave over.
const float kFlat = 3e-7, kParallel = 1e-6, kBorder = 5e-7, kLeft = 2e-6;

float heightOver(vec3 normal, vec3 relative) {
    float h = dot(normal, relative);
    return abs(h) <= kFlat * length(relative) ? 0.0 : h;
}

vec3 centreFrom(Origin o, uint face) {
    return cornerFrom(o, texelFetch(faceRange, int(face)).x) + texelFetch(faceCentre, int(face)).xyz;
}

// A face's first corner, two directions in its plane and its normal.
struct Frame {
    vec3 origin;
    vec3 u;
    vec3 v;
    vec3 n;
};

Frame frameOf(Origin o, Face face) {
    vec3 a = cornerFrom(o, face.first);
    vec3 u = normalize(cornerFrom(o, face.first + 1u) - a);
    u = normalize(u - dot(u, face.normal) * face.normal);
    return Frame(a, u, cross(face.normal, u), face.normal);
}

// In units of 1 / kExactOne and fractions of one, which are summed apart: a hundred thousand cells, each rounded down,
// may share a wall's form factor to a sliver, 1e-6 of the sliver's to the wall.
uvec2 fixedOf(float x) {
    float scaled = x * kExactOne, whole = floor(scaled);
    return uvec2(whole, (scaled - whole) * kExactFraction);
}

// A corner in the frame of its face.
vec2 cornerInFrame(uint corner) {
    return vec2(texelFetch(cornerHigh, int(corner)).w, texelFetch(cornerLow, int(corner)).w);
}

// x lowest, y highest height of a face's corners over the plane of another face.
vec2 heightsOver(Face plane, Face face) {
    Origin o = originAt(plane.first);
    vec2 range = vec2(kHuge, -kHuge);
    [[dont_unroll]] for (uint k = 0u; k < face.count; ++k) {
        float h = heightOver(plane.normal, cornerFrom(o, face.first + k));
        range = vec2(min(range.x, h), max(range.y, h));
    }
    return range;
}
#endif
