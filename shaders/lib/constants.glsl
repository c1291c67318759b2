// Numbers of mathematics.
#ifndef CONSTANTS_GLSL
#define CONSTANTS_GLSL
const float kPi = 3.14159265359;
const float kInversePi = 0.318309886184;
const float kInverseTwoPi = 0.159154943092;
const float kGolden = 0.618034; // fractions of its multiples are spread evenly
// Of rounding: no length of a scene is as large, no divisor as small, and their squares are still numbers or zero.
const float kHuge = 1e30;
const float kTiny = 1e-30;
#endif
