// Of each row of a block of F: the sum, in two floats, and of pairs that have not come yet, i < j, the sum of
// (A_i F_ij - A_j F_ji)^2. One group a row, in a set order.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/matrix_sums.io.h"

layout(local_size_x = kSumsGroup) in;
layout(set = 0, binding = 0, scalar) readonly buffer Rows { float rows_[]; };       // the block's rows of F, whole
layout(set = 0, binding = 1, scalar) readonly buffer Columns { float columns_[]; }; // those rows that are its columns
layout(set = 0, binding = 2) uniform samplerBuffer area;
layout(set = 0, binding = 3, scalar) writeonly buffer Sums { vec4 sums[]; };
layout(push_constant, scalar) uniform Push { MatrixSumsParams params; };

shared vec3 parts[kSumsGroup];

// The sum and what rounding took from it (D. E. Knuth, "The Art of Computer Programming", 2, 4.2.2).
vec2 twoSum(float a, float b) {
    precise float sum = a + b, ofB = sum - a;
    precise float rest = (a - (sum - ofB)) + (b - ofB);
    return vec2(sum, rest);
}

void main() {
    uint row = gl_WorkGroupID.x + gl_NumWorkGroups.x * gl_WorkGroupID.y, lane = gl_LocalInvocationID.x,
         i = params.firstRow + row;
    bool there = row < params.rows;
    vec2 sum = vec2(0.0);
    float squares = 0.0, ofRow = there ? texelFetch(area, int(i)).x : 0.0;
    for (uint column = lane; there && column < params.columns; column += kSumsGroup) {
        float f = rows_[params.rowsAt + row * params.patches + column];
        vec2 next = twoSum(sum.x, f);
        sum = vec2(next.x, sum.y + next.y);
        uint j = params.firstColumn + column;
        if (j <= i) continue;
        float d = ofRow * f - texelFetch(area, int(j)).x * columns_[params.columnsAt + column * params.patches + row];
        squares += d * d;
    }
    parts[lane] = vec3(sum, squares);
    for (uint half_ = kSumsGroup / 2u; half_ > 0u; half_ /= 2u) {
        barrier();
        if (lane >= half_) continue;
        vec3 a = parts[lane], b = parts[lane + half_];
        vec2 both = twoSum(a.x, b.x);
        parts[lane] = vec3(both.x, a.y + b.y + both.y, a.z + b.z);
    }
    if (lane == 0u && there) sums[params.sumsAt + row] = vec4(parts[0], 0.0);
}
