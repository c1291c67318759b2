// lavapipe ends all loops of an invocation after 65,535 turns in sum (Mesa's LP_MAX_TGSI_LOOP_ITERATIONS), and
// silently: from then on every loop makes one turn. So whoever walks along lists of any length asks at the end whether
// it was cut short.
#ifndef LOOP_LIMIT_GLSL
#define LOOP_LIMIT_GLSL
// `four` is 4, not known when the shader is compiled. A loop that is cut may count one turn too many (seen in
// exact_cells.comp), which hid the cut from a loop of two.
bool cutShort(uint four) {
    uint turns = 0u;
    [[dont_unroll]] do {
        ++turns;
    } while (turns < four);
    return turns < 3u; // not `four`: a compiler may hold that whoever left the loop met its condition
}
#endif
