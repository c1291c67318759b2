// Least cut of a small graph (Dinic 1970): which nodes stay with the source.
#pragma once

#include <cstdint>
#include <vector>

namespace heliodon::geometry {

class MinCut {
public:
    explicit MinCut(uint32_t nodes) : toSource_(nodes, 0), toSink_(nodes, 0), nodes_(nodes) {}

    void addSource(uint32_t node, int64_t capacity) { toSource_[node] += capacity; }
    void addSink(uint32_t node, int64_t capacity) { toSink_[node] += capacity; }
    // Both ways.
    void addLink(uint32_t a, uint32_t b, int64_t capacity) { links_.push_back({a, b, capacity}); }

    // The smallest source side among all least cuts: true per node. O(V^2 E), far less in practice.
    std::vector<bool> sourceSide() const;

private:
    struct Link {
        uint32_t a, b;
        int64_t capacity;
    };
    std::vector<int64_t> toSource_, toSink_;
    std::vector<Link> links_;
    uint32_t nodes_;
};

} // namespace heliodon::geometry
