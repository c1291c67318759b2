// The one expression that takes world points to clip space: every pipeline of a frame must agree on depth to
// the last bit, so positions are declared invariant where this is used.
vec4 clipFromPoint(mat4 clipFromWorld, vec4 point) {
    return clipFromWorld * point;
}
