// Hemicube in compute, first of three: lists which triangles each face sees, by the pixels that they cover. One workgroup,
// one viewpoint.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/hemicube.io.h"
#include "shaders/lib/hemicube_frame.glsl"

layout(local_size_x = kHemicubeGroup) in;
layout(set = 0, binding = 0) uniform usamplerBuffer triangles;
layout(set = 0, binding = 1) uniform usamplerBuffer viewpoints;
layout(set = 0, binding = 2, scalar) writeonly buffer Lists { uint lists[]; }; // listLength per viewpoint
layout(set = 0, binding = 3, scalar) buffer Counts { uint counts[]; };         // kHemicubeSizes per viewpoint, 0 before
layout(push_constant, scalar) uniform Push { HemicubeParams params; };
#include "shaders/lib/hemicube_triangle.glsl"

// Lists the faces of the hemicube that a triangle may touch: not those where all its corners lie behind one of the planes
// that bound the face's pyramid.
void classify(uint t, Frame frame, uint self, uint room, uint unseen) {
    Raster r = setUp(t, frame, self, room);
    vec3 x = vec3(r.a.x, r.b.x, r.c.x), y = vec3(r.a.y, r.b.y, r.c.y), z = vec3(r.a.z, r.b.z, r.c.z);
    bvec4 zOver = bvec4(any(greaterThan(z, x)), any(greaterThan(z, -x)), any(greaterThan(z, y)),
                        any(greaterThan(z, -y)));
    bool xOverY = any(greaterThan(x, y)), yOverX = any(greaterThan(y, x)), xOverMinusY = any(greaterThan(x, -y)),
         minusYOverX = any(greaterThan(-y, x));
    uint faces = 0u;
    if (all(zOver)) faces = 1u;
    if (any(greaterThan(x, z)) && any(greaterThan(x, vec3(0))) && xOverY && xOverMinusY) faces |= 2u;
    if (any(greaterThan(-x, z)) && any(greaterThan(-x, vec3(0))) && yOverX && minusYOverX) faces |= 4u;
    if (any(greaterThan(y, z)) && any(greaterThan(y, vec3(0))) && yOverX && xOverMinusY) faces |= 8u;
    if (any(greaterThan(-y, z)) && any(greaterThan(-y, vec3(0))) && xOverY && minusYOverX) faces |= 16u;
    if (!r.visible || (r.id & unseen) != 0u) faces = 0u;
    // Solid angle, roughly, in pixels of the top's middle.
    vec3 middle = (r.a + r.b + r.c) / 3.0;
    float distance2 = dot(middle, middle);
    float R = float(params.resolution);
    float pixels = abs(r.volume) * R * R / (8.0 * distance2 * sqrt(distance2));
    uint size = pixels < 8.0 ? 0u : pixels < 32.0 ? 1u : pixels < 128.0 ? 2u : 3u;
    do {
        if (faces != 0u) {
            uint face = uint(findLSB(faces));
            uint k = atomicAdd(counts[gl_WorkGroupID.x * kHemicubeSizes + size], 1u);
            lists[listPlace(gl_WorkGroupID.x, size, k)] = t * 8u + face;
            faces &= faces - 1u;
        }
    } while (faces != 0u);
}

void main() {
    int viewpoint = 3 * int(params.firstViewpoint + gl_WorkGroupID.x);
    uvec4 v0 = texelFetch(viewpoints, viewpoint), v1 = texelFetch(viewpoints, viewpoint + 1),
          v2 = texelFetch(viewpoints, viewpoint + 2);
    Frame frame = frameOf(v0, v1, v2);
    uint count = params.triangleCount, t = gl_LocalInvocationIndex,
         unseen = v0.w != kHemicubeNoPatch && params.frontsOnly != 0u ? kHemicubeBack : 0u; // flags
    do {
        if (t < count) classify(t, frame, v0.w, v1.w, unseen);
        t += kHemicubeGroup;
    } while (t < count);
}
