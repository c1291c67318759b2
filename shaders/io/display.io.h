#ifdef __cplusplus
#pragma once
#endif
#include "shaders/io/io.h"
IO_BEGIN
const uint kToneLinear = 0u;
const uint kToneSoft = 1u;
const uint kToneFalseColour = 2u;
const uint kToneRaw = 3u;
const vec3 kLuminance = vec3(0.2126, 0.7152, 0.0722); // of linear Rec. 709: geometry/luminance.h
// Scene picture (shaders/scene.frag) to what a display is sent.
struct DisplayParams {
    float white;      // kilolux shown as white
    float fullScale;  // drive of white times gain; 1 in previews
    float blackLevel; // what the projector leaks, fraction of full
    float gamma;      // of the display; 0: the attachment encodes sRGB
    float falseLow;   // log10 lux at both ends of the scale
    float falseHigh;
    uint outputWidth; // pixels of a row of the warp
};
IO_END
