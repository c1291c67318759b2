// What is left of the sun at a point behind panes: product over the panes that its ray to the sun passes.
// Needs `panes` (SunPaneHeader and SunPane[]) and `paneEdges` to be declared.

// Crossing count of the outline to the right of q; half-open, so that no shared corner counts twice.
bool insideOutline(vec2 q, uint firstEdge, uint edgeCount) {
    bool inside = false;
    for (uint e = firstEdge; e < firstEdge + edgeCount; ++e) {
        vec4 edge = texelFetch(paneEdges, int(e));
        if ((edge.y > q.y) != (edge.w > q.y)) {
            float x = edge.x + (q.y - edge.y) / (edge.w - edge.y) * (edge.z - edge.x);
            if (x > q.x) inside = !inside;
        }
    }
    return inside;
}

vec3 sunThroughPanes(vec3 p) {
    vec3 left = vec3(1);
    bool outside = header.needsExit == 0u;
    vec2 q = vec2(dot(header.u, p), dot(header.v, p));
    for (uint i = 0u; i < header.paneCount; ++i) {
        if (panes[i].offset - dot(panes[i].normal, p) <= 0.0) continue;
        if (!insideOutline(q, panes[i].firstEdge, panes[i].edgeCount)) continue;
        left *= panes[i].transmittance;
        outside = outside || panes[i].leaves != 0u;
    }
    return outside ? left : vec3(0);
}
