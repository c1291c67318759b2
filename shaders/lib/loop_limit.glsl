// lavapipe ends all loops of an invocation after 65,535 turns in sum (Mesa's LP_MAX_TGSI_LOOP_ITERATIONS), and
// silently: from then on every loop makes one turn. So whoever walks along lists of any length asks at the end whether
// it was cut short.
#ifndef LOOP_LIMIT_GLSL
#define LOOP_LIMIT_GLSL
// `two` is 2, not known when the shader is compiled.
bool cutShort(uint two) {
    uint turns = 0u;
    [[dont_unroll]] do {
        ++turns;
    } while (turns < two);
    return turns < two;
}
#endif
