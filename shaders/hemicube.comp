// Hemicube in compute, second of three: what hemicube_lists.comp lists is rastered into an item buffer round a viewpoint.
// Cohen and Greenberg, The Hemi-Cube, 1985; raster by homogeneous edge functions (Olano and Greer, Triangle Scan
// Conversion using 2D Homogeneous Coordinates, 1997): planes through the viewpoint and an edge, so that triangles that
// cross the horizon or touch the viewpoint need no clipping. A row of workgroups, one viewpoint.
// CPU devices run what is in an `if` whether or not a lane wants it, and a loop as long as its longest lane: so lanes do
// listed work of one size, and all have some, and loops ask at their foot, since at the head they cost a turn more. Such
// devices keep the variables of kernels with barriers in memory and load push constants where they are used: so there is no
// barrier here and no constant in a loop. Where loops were cut short (lib/loop_limit.glsl) the host takes more workgroups
// and finer stripes.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/io/hemicube.io.h"
#include "shaders/lib/constants.glsl"
#include "shaders/lib/hemicube_frame.glsl"
#include "shaders/lib/loop_limit.glsl"

layout(local_size_x = kHemicubeGroup) in;
layout(set = 0, binding = 0) uniform usamplerBuffer triangles;
layout(set = 0, binding = 1) uniform usamplerBuffer viewpoints;
layout(set = 0, binding = 2, scalar) readonly buffer Lists { uint lists[]; };   // listLength per viewpoint
layout(set = 0, binding = 3, scalar) readonly buffer Counts { uint counts[]; }; // kHemicubeSizes per viewpoint
layout(set = 0, binding = 4, scalar) buffer Items { uint items[]; };            // 3 R^2 per viewpoint, all ones before
layout(set = 0, binding = 5, scalar) buffer Cuts { uint cuts; }; // invocations whose loops the device ended early
layout(push_constant, scalar) uniform Push { HemicubeParams params; };
#include "shaders/lib/hemicube_triangle.glsl"

const float kOutside = 1e9; // pixels: beyond every picture
// Pixels: lines and edges are known to less. What lies on an edge counts for both sides: a crack would lose light, a
// tie is settled by depth and number.
const float kLineSlack = 1e-3, kEdgeSlack = 1e-4;
const float kMostDepth = 16777216.0; // steps that float32 tells apart
// Of sheets without thickness the front is seen, whatever rounding makes of both depths: the back lies deeper.
const float kBackDeeper = 2e-6, kBackSteps = 2.0;

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

uint itemOf(float inverse, float scale, vec2 bias, float most, uint idBits, uint id) {
    float depth = inverse > 0.0 ? min(scale / inverse * bias.x + bias.y, most) : most;
    return (uint(depth) << idBits) | id;
}

int firstPixel(vec3 from, float R) { return int(ceil(clamp(max(from.x, max(from.y, from.z)), 0.0, R))); }
int lastPixel(vec3 to, float R) { return int(floor(clamp(min(to.x, min(to.y, to.z)), -1.0, R - 1.0))); }

// Every `stripes`-th line, a power of two, from the `stripe`-th on, of a triangle on a face; `small`: of few pixels.
void rasterItem(uint item, bool small, int stripe, int stripes, Frame frame, uint self, uint room, uint base) {
    uint face = item % 8u;
    Raster r = setUp(item / 8u, frame, self, room);
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
    first += (stripe - first) & (stripes - 1);

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
    uint idBits = params.idBits;
    float most = min(exp2(32.0 - float(idBits)), kMostDepth) - kBackSteps;
    vec2 bias = (r.id & kHemicubeBack) != 0u ? vec2(1.0 + kBackDeeper, kBackSteps) : vec2(1.0, 0.0);
    float scale = params.depthScale;
    uint at = base + (face == 0u ? 0u : (face + 1u) * params.resolution * params.resolution / 2u) +
              uint(first) * params.resolution;
    uint nextLine = uint(stripes) * params.resolution;
    int j = first, place = 0, lastPlace = -1;
    float inverse = 0.0;
    if (small) {
        // All lines in one loop: with a loop in a loop each line takes as long as the longest that the lanes
        // have at a time.
        do {
            bool next = place > lastPlace; // line
            vec3 from = low + lowStep * float(j), to = high + highStep * float(j);
            int i = firstPixel(from, R), end = j <= last ? lastPixel(to, R) : -1;
            place = next ? int(at) + i : place;
            lastPlace = next ? int(at) + end : lastPlace;
            inverse = next ? depthRest + depthStep.y * float(j) + depthStep.x * float(i) : inverse;
            at += next ? nextLine : 0u;
            j += next ? stripes : 0;
            if (place <= lastPlace) atomicMin(items[place], itemOf(inverse, scale, bias, most, idBits, r.id));
            inverse += depthStep.x;
            ++place;
        } while (place <= lastPlace || j <= last);
    } else {
        // Where lines are long, what begins one costs less once a line than once a pixel.
        do {
            vec3 from = low + lowStep * float(j), to = high + highStep * float(j);
            int i = firstPixel(from, R), end = j <= last ? lastPixel(to, R) : -1;
            place = int(at) + i;
            lastPlace = int(at) + end;
            inverse = depthRest + depthStep.y * float(j) + depthStep.x * float(i);
            uint value = itemOf(inverse, scale, bias, most, idBits, r.id);
            do {
                if (place <= lastPlace) atomicMin(items[place], value);
                inverse += depthStep.x;
                value = itemOf(inverse, scale, bias, most, idBits, r.id);
                ++place;
            } while (place <= lastPlace);
            at += nextLine;
            j += stripes;
        } while (j <= last);
    }
}

void main() {
    uint R = params.resolution;
    uint view = gl_WorkGroupID.y;
    int viewpoint = 3 * int(params.firstViewpoint + view);
    uvec4 v0 = texelFetch(viewpoints, viewpoint), v1 = texelFetch(viewpoints, viewpoint + 1),
          v2 = texelFetch(viewpoints, viewpoint + 2);
    Frame frame = frameOf(v0, v1, v2);
    uint ends[kHemicubeSizes], all = 0u;
    for (uint size = 0u; size < kHemicubeSizes; ++size) {
        all += counts[view * kHemicubeSizes + size] << (size + 1u < kHemicubeSizes ? 0u : params.stripeBits);
        ends[size] = all;
    }
    uint stripeBits = params.stripeBits, lanes = gl_NumWorkGroups.x * kHemicubeGroup, k = gl_GlobalInvocationID.x;
    do {
        uint size = k < ends[0] ? 0u : k < ends[1] ? 1u : k < ends[2] ? 2u : 3u;
        uint first = size == 0u ? 0u : size == 1u ? ends[0] : size == 2u ? ends[1] : ends[2];
        uint bits = size < 3u ? 0u : stripeBits, stripes = 1u << bits;
        if (k < all)
            rasterItem(lists[listPlace(view, size, (k - first) >> bits)], size < 2u, int((k - first) & (stripes - 1u)),
                       int(stripes), frame, v0.w, v1.w, view * 3u * R * R);
        k += lanes;
    } while (k < all);
    if (cutShort(3u + min(params.pointsPerRow, 1u))) atomicAdd(cuts, 1u);
}
