// Hemicube in compute: all patches rastered into an item buffer round a viewpoint, then delta form factors summed.
// Cohen and Greenberg, The Hemi-Cube, 1985; raster by homogeneous edge functions (Olano and Greer, Triangle Scan
// Conversion using 2D Homogeneous Coordinates, 1997): planes through the viewpoint and an edge, so that triangles that
// cross the horizon or touch the viewpoint need no clipping. One workgroup, one viewpoint;
// a lane rasters every `stripes`-th line of a triangle, later sums a line of pixels. Loops stay short on purpose: some CPU
// devices end an invocation's loops after 65535 turns in all.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/hemicube.io.h"
#include "shaders/lib/glazing.glsl"
#include "shaders/lib/sky_elements.glsl"

layout(local_size_x = kHemicubeGroup) in;
layout(set = 0, binding = 0) uniform usamplerBuffer triangles;
layout(set = 0, binding = 1) uniform usamplerBuffer viewpoints;
layout(set = 0, binding = 2) uniform usamplerBuffer deltas; // top R x R, then one side R x R/2; fixed point
layout(set = 0, binding = 3) uniform usamplerBuffer patchOpenings;
layout(set = 0, binding = 4) uniform samplerBuffer glazings;
layout(set = 0, binding = 5, scalar) coherent buffer Items { uint items[]; };     // 3 R^2 per workgroup, all ones
layout(set = 0, binding = 6, scalar) coherent buffer Factors { uint factors[]; }; // rows x patchCount, fixed point, zero before
layout(set = 0, binding = 7, scalar) coherent buffer Sky { uint sky[]; };         // rows x channels x skyElements
layout(push_constant, scalar) uniform Push { HemicubeParams params; };

const uint kEmpty = 0xffffffffu;

struct Frame {
    vec3 origin, u, v, n;
};

// Components along (pixel column, pixel line, depth) of a face: 0 the top, 1..4 the sides. All five maps are orthonormal,
// so planes turn as points do.
vec3 toFace(vec3 p, uint face) {
    if (face == 0u) return p;
    if (face == 1u) return vec3(p.y, p.z, p.x);
    if (face == 2u) return vec3(-p.y, p.z, -p.x);
    if (face == 3u) return vec3(-p.x, p.z, p.y);
    return vec3(p.x, p.z, -p.y);
}

vec3 fromFace(vec3 q, uint face) {
    if (face == 0u) return q;
    if (face == 1u) return vec3(q.z, q.x, q.y);
    if (face == 2u) return vec3(-q.z, -q.x, q.y);
    if (face == 3u) return vec3(-q.x, q.z, q.y);
    return vec3(q.x, -q.z, q.y);
}

// Grows the range of y/w over the part of edge a-b in front of the face's eye plane, w > 0; where the edge goes through
// that plane the range runs to infinity on the side of the passage.
void growRange(vec3 a, vec3 b, inout vec2 range) {
    if (a.z > 0.0) {
        float y = a.y / a.z;
        range = vec2(min(range.x, y), max(range.y, y));
    }
    if ((a.z > 0.0) != (b.z > 0.0)) {
        float y = (a.y * b.z - b.y * a.z) * (b.z > a.z ? 1.0 : -1.0);
        if (y >= 0.0) range.y = 1e9;
        if (y <= 0.0) range.x = -1e9;
    }
}

struct Raster {
    vec3 a, b, c;    // corners
    vec3 ea, eb, ec; // edge planes, positive inside
    vec3 depth;      // depth . direction = 1 / depth along the face
    uint id, stripe;
};

void rasterFace(Raster r, uint face, uint base) { // lines of the triangle's own stripe only
    vec3 a = toFace(r.a, face), b = toFace(r.b, face), c = toFace(r.c, face);
    float R = float(params.resolution);
    bool top = face == 0u;
    vec2 range = vec2(1e9, -1e9);
    growRange(a, b, range);
    growRange(b, c, range);
    growRange(c, a, range);
    float lineOffset = top ? 0.5 * R - 0.5 : -0.5;
    int first = int(ceil(clamp(range.x * 0.5 * R + lineOffset - 1e-3, 0.0, R)));
    int last = int(floor(clamp(range.y * 0.5 * R + lineOffset + 1e-3, -1.0, (top ? R : 0.5 * R) - 1.0)));
    first += (int(r.stripe) - first % int(params.stripes) + int(params.stripes)) % int(params.stripes);
    if (first > last) return;

    // Edge planes and 1/depth as linear functions of pixel column i and line j.
    mat3 e = mat3(toFace(r.ea, face), toFace(r.eb, face), toFace(r.ec, face));
    vec3 column = vec3(e[0].x, e[1].x, e[2].x), line = vec3(e[0].y, e[1].y, e[2].y);
    vec3 rest = vec3(e[0].z, e[1].z, e[2].z) + column * (1.0 / R - 1.0) + line * (1.0 / R - (top ? 1.0 : 0.0));
    column *= 2.0 / R;
    line *= 2.0 / R;
    column = mix(column, vec3(1e-30), equal(column, vec3(0)));
    vec3 d = toFace(r.depth, face);
    float depthRest = d.z + d.x * (1.0 / R - 1.0) + d.y * (1.0 / R - (top ? 1.0 : 0.0));
    bvec3 fromLeft = greaterThan(column, vec3(0));
    vec3 bound0 = -rest / column, boundStep = -line / column;
    float most = min(exp2(32.0 - float(params.idBits)), 16777216.0) - 2.0;
    for (int j = first; j <= last; j += int(params.stripes)) {
        vec3 bound = bound0 + boundStep * float(j);
        vec3 low = mix(vec3(-1e9), bound, fromLeft), high = mix(bound, vec3(1e9), fromLeft);
        // Pixels on an edge count for both sides: a crack would lose light, a tie is settled by depth and number.
        int i0 = int(ceil(clamp(max(low.x, max(low.y, low.z)) - 1e-4, 0.0, R)));
        int i1 = int(floor(clamp(min(high.x, min(high.y, high.z)) + 1e-4, -1.0, R - 1.0)));
        float perDepth = depthRest + d.y * (2.0 / R) * float(j);
        uint at = base + uint(j) * params.resolution;
        for (int i = i0; i <= i1; ++i) {
            float inverse = perDepth + d.x * (2.0 / R) * float(i);
            float depth = inverse > 0.0 ? min(params.depthScale / inverse, most) : most;
            uint item = (uint(depth) << params.idBits) | r.id;
            if (item < items[at + uint(i)]) atomicMin(items[at + uint(i)], item);
        }
    }
}

void rasterTriangle(uint t, uint stripe, Frame frame, uint self, uint room, uint base) {
    uvec4 t0 = texelFetch(triangles, int(3u * t)), t1 = texelFetch(triangles, int(3u * t + 1u)),
          t2 = texelFetch(triangles, int(3u * t + 2u));
    if (t0.w == self || (room != kHemicubeAnyRoom && t1.w != room)) return;
    mat3 turn = transpose(mat3(frame.u, frame.v, frame.n));
    Raster r;
    r.a = turn * (uintBitsToFloat(t0.xyz) - frame.origin);
    r.b = turn * (uintBitsToFloat(t1.xyz) - frame.origin);
    r.c = turn * (uintBitsToFloat(t2.xyz) - frame.origin);
    if (max(r.a.z, max(r.b.z, r.c.z)) <= params.flatness) return; // under the horizon
    vec3 normal = cross(r.b - r.a, r.c - r.a);
    float volume = dot(normal, r.a); // twice the area times the distance of the plane; negative seen from the front
    if (abs(volume) <= params.flatness * length(normal)) return;
    float side = volume < 0.0 ? -1.0 : 1.0;
    r.ea = side * cross(r.b, r.c);
    r.eb = side * cross(r.c, r.a);
    r.ec = side * cross(r.a, r.b);
    r.depth = normal / volume;
    r.id = t0.w * 2u + (volume < 0.0 ? 0u : 1u);
    r.stripe = stripe;
    uint R = params.resolution;
    vec3 x = vec3(r.a.x, r.b.x, r.c.x), y = vec3(r.a.y, r.b.y, r.c.y), z = vec3(r.a.z, r.b.z, r.c.z);
    // A face is skipped when all corners lie behind one of the planes that bound its pyramid.
    if (any(greaterThan(z, x)) && any(greaterThan(z, -x)) && any(greaterThan(z, y)) && any(greaterThan(z, -y)))
        rasterFace(r, 0u, base);
    base += R * R;
    for (uint face = 1u; face < 5u; ++face) {
        vec3 depth = face == 1u ? x : face == 2u ? -x : face == 3u ? y : -y;
        vec3 across = face < 3u ? y : x;
        if (any(greaterThan(depth, vec3(0))) && any(greaterThan(depth, across)) && any(greaterThan(depth, -across)) &&
            any(greaterThan(depth, z)))
            rasterFace(r, face, base);
        base += R * R / 2u;
    }
}

// One pixel that looks out through an opening: its share of the sky element that it sees, behind the glass.
void addSky(uint row, uint opening, vec3 direction, vec3 openingNormal, uint delta) {
    vec4 glazing = texelFetch(glazings, int(opening - 1u));
    vec3 through = slabTransmittance(glazing.rgb, glazing.a, abs(dot(direction, openingNormal)));
    uint at = row * params.channels * params.skyElements + skyElementOf(direction, params.skyDivision);
    for (uint channel = 0u; channel < params.channels; ++channel)
        atomicAdd(sky[at + channel * params.skyElements], uint(float(delta) * through[channel] + 0.5));
}

// Sums pixel line `k` (0 .. 3R: the top's lines, then those of the sides), a run of equal items at a time.
void sumLine(uint k, uint row, Frame frame, uint base) {
    uint R = params.resolution;
    uint face = k < R ? 0u : 1u + (k - R) / (R / 2u);
    uint line = k < R ? k : (k - R) % (R / 2u);
    uint deltaAt = (k < R ? 0u : R * R) + line * R;
    uint mask = (1u << params.idBits) - 1u;
    uint previous = kEmpty, sum = 0u, opening = 0u;
    vec3 openingNormal = vec3(0);
    float y = (2.0 * float(line) + 1.0) / float(R) - (face == 0u ? 1.0 : 0.0);
    for (uint i = 0u; i <= R; ++i) {
        uint item = i < R ? items[base + k * R + i] : kEmpty;
        uint id = item == kEmpty ? kEmpty : item & mask;
        if (id != previous) {
            if (sum > 0u) atomicAdd(factors[row * params.patchCount + (previous >> 1)], sum);
            sum = 0u;
            previous = id;
            opening = 0u;
            if ((id & 1u) == 0u && params.skyElements > 0u) {
                uvec4 info = texelFetch(patchOpenings, int(id >> 1));
                opening = info.w;
                openingNormal = uintBitsToFloat(info.xyz);
            }
        }
        if ((id & 1u) == 1u) continue; // nothing (a crack), or a back side: that light is lost, which closure shows
        uint delta = texelFetch(deltas, int(deltaAt + i)).x;
        sum += delta;
        if (opening > 0u) {
            vec3 local = normalize(fromFace(vec3((2.0 * float(i) + 1.0) / float(R) - 1.0, y, 1.0), face));
            vec3 world = local.x * frame.u + local.y * frame.v + local.z * frame.n;
            addSky(row, opening, world, openingNormal, delta);
        }
    }
}

void main() {
    uint lane = gl_LocalInvocationIndex, R = params.resolution;
    uint viewpoint = params.firstViewpoint + gl_WorkGroupID.x;
    uint row = (gl_WorkGroupID.x + params.viewpointInRow) / params.pointsPerRow, base = gl_WorkGroupID.x * 3u * R * R;
    uvec4 v0 = texelFetch(viewpoints, int(3u * viewpoint)), v1 = texelFetch(viewpoints, int(3u * viewpoint + 1u)),
          v2 = texelFetch(viewpoints, int(3u * viewpoint + 2u));
    Frame frame;
    frame.origin = uintBitsToFloat(v0.xyz);
    frame.n = uintBitsToFloat(v1.xyz);
    frame.u = uintBitsToFloat(v2.xyz);
    frame.v = cross(frame.n, frame.u);
    uint work = params.triangleCount * params.stripes;
    for (uint t = lane; t < work; t += kHemicubeGroup)
        rasterTriangle(t / params.stripes, t % params.stripes, frame, v0.w, v1.w, base);
    memoryBarrierBuffer();
    barrier();
    for (uint k = lane; k < 3u * R; k += kHemicubeGroup) sumLine(k, row, frame, base);
}
