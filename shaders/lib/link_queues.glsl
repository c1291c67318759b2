// Pairs of clusters handed on. Before this: uniform usamplerBuffer nodes, buffers counters, next and leafPairs,
// cluster.glsl.
#ifndef LINK_QUEUES_GLSL
#define LINK_QUEUES_GLSL

void handOn(uint i, uint j, bool leafI, bool leafJ) {
    if (leafI && leafJ)
        leafPairs[atomicAdd(counters[kHierarchicalLeaves], 1u)] = uvec2(i, j);
    else
        next[atomicAdd(counters[kHierarchicalPairs], 1u)] = uvec2(i, j);
}

bool isLeaf(uint index) { return texelFetch(nodes, int(5u * index + 4u)).x == 0u; }

const float kAlike = 1.5; // one radius over the other, up to which both are split

// The larger into its children, or both where they are alike.
void split(uint i, uint j, Cluster p, Cluster q) {
    bool both = p.child != 0u && q.child != 0u && max(p.radius, q.radius) < kAlike * min(p.radius, q.radius);
    bool splitP = both || (p.child != 0u && (q.child == 0u || p.radius >= q.radius)), splitQ = both || !splitP;
    [[dont_unroll]] for (uint k = 0u; k < (splitP ? 2u : 1u); ++k)
        [[dont_unroll]] for (uint l = 0u; l < (splitQ ? 2u : 1u); ++l) {
            uint a = splitP ? p.child + k : i, b = splitQ ? q.child + l : j;
            handOn(a, b, isLeaf(a), isLeaf(b));
        }
}

// What rays may miss, as a share of the light, where all of kHierarchicalRays agree: some triangles, if there are more.
float doubtOfAgreement(Cluster p, Cluster q) {
    return min(0.5, float(max(p.leafCount, q.leafCount)) / float(2u * kHierarchicalRays));
}
#endif
