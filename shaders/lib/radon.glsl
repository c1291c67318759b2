// Cubature of a triangle, exact to degree 5: the centre and two times three points (J. Radon, 1948).
#ifndef RADON_GLSL
#define RADON_GLSL
// The three points at barycentric coordinates (1 - 2 t, t, t).
const float kRadonNear = 0.470142064105, kRadonFar = 0.101286507323;
const float kRadonCentreWeight = 0.225, kRadonNearWeight = 0.132394152788, kRadonFarWeight = 0.125939180545; // of each
// How far they lie from the centre, over the way to the corner.
const float kRadonNearOut = -0.410426192314, kRadonFarOut = 0.696140478028;
// Three such points integrate quadratics with the centre when they weigh 1/4 / (1 - 3 t)^2 together.
const float kRadonNearLow = 0.25 / ((1.0 - 3.0 * kRadonNear) * (1.0 - 3.0 * kRadonNear));
const float kRadonFarLow = 0.25 / ((1.0 - 3.0 * kRadonFar) * (1.0 - 3.0 * kRadonFar));
// What points of it prove of a shadow's border between them, measured in rooms: the error is at least kLeastError of
// what differs from point to point, kQuickError of how far four points' two rules are apart, as four agree by accident
// more often than seven, and kMissed of what is there in the open, a sliver between points that agree.
const float kLeastError = 0.1, kQuickError = 2.0, kMissed = 0.02;
#endif
