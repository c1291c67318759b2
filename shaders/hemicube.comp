// Hemicube in compute, first half: all patches rastered into an item buffer round a viewpoint.
// Cohen and Greenberg, The Hemi-Cube, 1985; raster by homogeneous edge functions (Olano and Greer, Triangle Scan
// Conversion using 2D Homogeneous Coordinates, 1997): planes through the viewpoint and an edge, so that triangles that
// cross the horizon or touch the viewpoint need no clipping. One workgroup, one viewpoint.
// CPU devices run what is in an `if` whether or not a lane wants it, and a loop as long as its longest lane: so work is
// first listed by face and size, then done by lanes that all have some. Loops also stay short because such devices
// end an invocation's loops after 65535 turns in all.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/hemicube.io.h"
#include "shaders/lib/constants.glsl"
#include "shaders/lib/hemicube_frame.glsl"

layout(local_size_x = kHemicubeGroup) in;
layout(set = 0, binding = 0) uniform usamplerBuffer triangles;
layout(set = 0, binding = 1) uniform usamplerBuffer viewpoints;
layout(set = 0, binding = 2, scalar) coherent buffer Lists { uint lists[]; }; // listLength per workgroup
layout(set = 0, binding = 3, scalar) buffer Items { uint items[]; };          // 3 R^2 per workgroup, all ones before
layout(push_constant, scalar) uniform Push { HemicubeParams params; };

const uint kSizes = 4u; // classes of triangles by the pixels that they cover
const float kOutside = 1e9; // pixels: beyond every picture
// Pixels: lines and edges are known to less. What lies on an edge counts for both sides: a crack would lose light, a
// tie is settled by depth and number.
const float kLineSlack = 1e-3, kEdgeSlack = 1e-4;
const float kMostDepth = 16777216.0; // steps that float32 tells apart
// Of sheets without thickness the front is seen, whatever rounding makes of both depths: the back lies deeper.
const float kBackDeeper = 2e-6, kBackSteps = 2.0;
shared uint sizeCounts[kSizes];

// Grows the range of y/w over the part of edge a-b in front of the face's eye plane, w > 0; where the edge goes through
// that plane the range runs to infinity on the side of the passage.
void growRange(vec3 a, vec3 b, inout vec2 range) {
    if (a.z > 0.0) {
        float y = a.y / a.z;
        range = vec2(min(range.x, y), max(range.y, y));
    }
    if ((a.z > 0.0) != (b.z > 0.0)) {
        float y = (a.y * b.z - b.y * a.z) * (b.z > a.z ? 1.0 : -1.0);
        if (y >= 0.0) range.y = kOutside;
        if (y <= 0.0) range.x = -kOutside;
    }
}

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

// Where class `size` keeps its k-th entry: two lists, each filled from both ends.
uint listPlace(uint size, uint k) {
    uint half_ = params.listLength / 2u;
    uint place = (size / 2u) * half_ + ((size & 1u) == 0u ? k : half_ - 1u - k);
    return gl_WorkGroupID.x * params.listLength + place;
}

// Lists the faces of the hemicube that a stripe of a triangle may touch: not those where all its corners lie behind
// one of the planes that bound the face's pyramid.
void classify(uint work, Frame frame, uint self, uint room) {
    Raster r = setUp(work / params.stripes, frame, self, room);
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
    if (!r.visible) faces = 0u;
    // Solid angle, roughly, in pixels of the top's middle.
    vec3 middle = (r.a + r.b + r.c) / 3.0;
    float distance2 = dot(middle, middle);
    float R = float(params.resolution);
    float pixels = abs(r.volume) * R * R / (8.0 * distance2 * sqrt(distance2) * float(params.stripes));
    uint size = pixels < 8.0 ? 0u : pixels < 32.0 ? 1u : pixels < 128.0 ? 2u : 3u;
    do {
        if (faces != 0u) {
            uint face = uint(findLSB(faces));
            lists[listPlace(size, atomicAdd(sizeCounts[size], 1u))] = work * 8u + face;
            faces &= faces - 1u;
        }
    } while (faces != 0u);
}

void rasterItem(uint item, Frame frame, uint self, uint room, uint base) {
    uint work = item / 8u, face = item % 8u, stripe = work % params.stripes;
    Raster r = setUp(work / params.stripes, frame, self, room);
    vec3 a = toFace(r.a, face), b = toFace(r.b, face), c = toFace(r.c, face);
    float R = float(params.resolution);
    bool top = face == 0u;
    vec2 range = vec2(kOutside, -kOutside);
    growRange(a, b, range);
    growRange(b, c, range);
    growRange(c, a, range);
    float lineOffset = top ? 0.5 * R - 0.5 : -0.5;
    int first = int(ceil(clamp(range.x * 0.5 * R + lineOffset - kLineSlack, 0.0, R)));
    int last = int(floor(clamp(range.y * 0.5 * R + lineOffset + kLineSlack, -1.0, (top ? R : 0.5 * R) - 1.0)));
    int stripes = int(params.stripes);
    first += (int(stripe) - first % stripes + stripes) % stripes;

    // Edge planes and 1/depth as linear functions of pixel column i and line j.
    mat3 e = mat3(toFace(r.ea, face), toFace(r.eb, face), toFace(r.ec, face));
    vec3 column = vec3(e[0].x, e[1].x, e[2].x), line = vec3(e[0].y, e[1].y, e[2].y);
    vec3 rest = vec3(e[0].z, e[1].z, e[2].z) + column * (1.0 / R - 1.0) + line * (1.0 / R - (top ? 1.0 : 0.0));
    column *= 2.0 / R;
    line *= 2.0 / R;
    column = mix(column, vec3(kTiny), equal(column, vec3(0)));
    vec3 d = toFace(r.depth, face);
    float depthRest = d.z + d.x * (1.0 / R - 1.0) + d.y * (1.0 / R - (top ? 1.0 : 0.0));
    vec2 depthStep = d.xy * (2.0 / R);
    bvec3 fromLeft = greaterThan(column, vec3(0));
    vec3 bound = -rest / column, boundStep = -line / column;
    vec3 low = mix(vec3(-kOutside), bound - kEdgeSlack, fromLeft), lowStep = mix(vec3(0), boundStep, fromLeft);
    vec3 high = mix(bound + kEdgeSlack, vec3(kOutside), fromLeft), highStep = mix(boundStep, vec3(0), fromLeft);
    float most = min(exp2(32.0 - float(params.idBits)), kMostDepth) - kBackSteps;
    vec2 bias = (r.id & kHemicubeBack) != 0u ? vec2(1.0 + kBackDeeper, kBackSteps) : vec2(1.0, 0.0);
    uint at = base + (face == 0u ? 0u : (face + 1u) * params.resolution * params.resolution / 2u) +
              uint(first) * params.resolution;
    for (int j = first; j <= last; j += stripes) {
        vec3 from = low + lowStep * float(j), to = high + highStep * float(j);
        int i = int(ceil(clamp(max(from.x, max(from.y, from.z)), 0.0, R)));
        int end = int(floor(clamp(min(to.x, min(to.y, to.z)), -1.0, R - 1.0)));
        float inverse = depthRest + depthStep.y * float(j) + depthStep.x * float(i);
        do {
            float depth = inverse > 0.0 ? min(params.depthScale / inverse * bias.x + bias.y, most) : most;
            uint value = (uint(depth) << params.idBits) | r.id;
            if (i <= end) atomicMin(items[at + uint(i)], value);
            inverse += depthStep.x;
            ++i;
        } while (i <= end);
        at += uint(stripes) * params.resolution;
    }
}

void main() {
    uint lane = gl_LocalInvocationIndex, R = params.resolution;
    int viewpoint = 3 * int(params.firstViewpoint + gl_WorkGroupID.x);
    uvec4 v0 = texelFetch(viewpoints, viewpoint), v1 = texelFetch(viewpoints, viewpoint + 1),
          v2 = texelFetch(viewpoints, viewpoint + 2);
    Frame frame = frameOf(v0, v1, v2);
    if (lane < kSizes) sizeCounts[lane] = 0u;
    memoryBarrierShared();
    barrier();
    uint work = params.triangleCount * params.stripes;
    for (uint w = lane; w < work; w += kHemicubeGroup) classify(w, frame, v0.w, v1.w);
    memoryBarrierShared();
    memoryBarrierBuffer();
    barrier();
    for (uint size = 0u; size < kSizes; ++size) {
        uint count = sizeCounts[size];
        for (uint k = lane; k < count; k += kHemicubeGroup)
            rasterItem(lists[listPlace(size, k)], frame, v0.w, v1.w, gl_WorkGroupID.x * 3u * R * R);
    }
}
