// Scene picture to display: lens, average of subpixels, tone or false colour, gain and black level.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/io/display.io.h"
#include "shaders/lib/viridis.glsl"

layout(set = 0, binding = 0) uniform sampler2D scene;
layout(set = 0, binding = 1) uniform samplerBuffer warp;
layout(push_constant, scalar) uniform Push { DisplayParams params; };
layout(constant_id = 0) const uint kTone = 0u;
layout(constant_id = 1) const bool kProjector = false;
layout(constant_id = 2) const int kSupersample = 1;
// A constant, as software devices run both sides of a branch, and pow is dear.
layout(constant_id = 3) const bool kGamma = false;

layout(location = 0) out vec4 colour;

const float kUnknownGrey = 0.22;
const float kSoftKey = 1.6, kSoftBurn = 32.0; // what stands for white, and what burns out: 20 x white
const float kLeastLux = 1e-6, kLogSlack = 1e-6; // of false colour; below the scale is black

// Fraction of white that stands for the light of one scene texel.
vec3 toned(vec3 light) {
    vec3 x = light / params.white;
    if (kTone == kToneSoft) {
        // E. Reinhard et al., "Photographic tone reproduction" (2002), eq. 4 on luminance.
        x *= kSoftKey;
        float y = dot(x, kLuminance);
        return x * (1.0 + y / (kSoftBurn * kSoftBurn)) / (1.0 + y);
    }
    if (kTone == kToneFalseColour) {
        float lux = 1000.0 * dot(light, kLuminance);
        if (lux < 0.0) return vec3(kUnknownGrey); // glazing
        float value = log(max(lux, kLeastLux)) / log(10.0);
        if (value < params.falseLow - kLogSlack) return vec3(0);
        float t = clamp((value - params.falseLow) / (params.falseHigh - params.falseLow), 0.0, 1.0);
        return linearFromSrgb(clamp(viridis(t), 0.0, 1.0));
    }
    return x;
}

// Brighter than white in a channel: luminance and hue stay, saturation gives way. Cut channel by channel, sun would be
// cyan on a blue wall and yellow on an orange floor.
vec3 withinWhite(vec3 x) {
    float most = max(x.r, max(x.g, x.b));
    if (most <= 1.0) return x;
    float grey = min(dot(x, kLuminance), 1.0);
    return grey + (x - grey) * ((1.0 - grey) / (most - grey));
}

vec3 shown(ivec2 at) {
    vec4 texel = texelFetch(scene, at, 0);
    if (kTone == kToneRaw && !kProjector) return texel.a == 1.0 ? 1000.0 * texel.rgb : vec3(0);
    if (!kProjector && texel.a != 1.0) return texel.rgb;
    vec3 value = toned(texel.rgb);
    value = max(value, 0.0); // less than nothing where scatter is left out
    // Here, where it is light: cut as each projector's drive, it would be brighter wherever more of them share it.
    if (kTone != kToneRaw) value = withinWhite(value);
    if (!kProjector) return value;
    return value * (params.fullScale * texel.a);
}

// Sum of kSupersample x kSupersample places, one subpixel apart, around `at`, each interpolated between four texels.
vec3 around(vec2 at) {
    vec2 first = at - 0.5 * float(kSupersample - 1), low = floor(first), share = first - low;
    ivec2 last = textureSize(scene, 0) - 1;
    vec3 sum = vec3(0);
    for (int j = 0; j <= kSupersample; ++j)
        for (int i = 0; i <= kSupersample; ++i) {
            float weight = (i == 0 ? 1.0 - share.x : i == kSupersample ? share.x : 1.0) *
                           (j == 0 ? 1.0 - share.y : j == kSupersample ? share.y : 1.0);
            sum += weight * shown(clamp(ivec2(low) + ivec2(i, j), ivec2(0), last));
        }
    return sum;
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 sum = vec3(0);
    vec3 warped = vec3(0);
    if (kProjector) {
        warped = texelFetch(warp, pixel.y * int(params.outputWidth) + pixel.x).rgb;
        sum = around(warped.xy);
    } else {
        for (int i = 0; i < kSupersample * kSupersample; ++i)
            sum += shown(kSupersample * pixel + ivec2(i % kSupersample, i / kSupersample));
    }
    sum /= float(kSupersample * kSupersample);
    if (kTone != kToneRaw) {
        // Beyond the projector's own reach, too, a hue that it has no more of grows pale, not dark.
        if (kProjector) sum = withinWhite(max((sum - warped.z) / (1.0 - params.blackLevel), 0.0));
        if (kGamma) sum = pow(sum, vec3(1.0 / params.gamma));
    }
    colour = vec4(sum, 1);
}
