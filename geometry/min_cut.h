// Least cut of a small graph (Dinic 1970): which nodes stay with the source.
#pragma once

#include <cstdint>
#include <vector>

namespace heliodon::geometry {

class MinCut {
public:
    struct Link {
        uint32_t a, b;
        int64_t capacity; // both ways
    };

    MinCut() = default;
    MinCut(uint32_t nodes, const std::vector<Link>& links);

    // With what each node has from the source and to the sink: the smallest source side among all least cuts,
    // true per node. Sums of capacities are to stay below 2^62. O(V^2 E), far less in practice.
    std::vector<bool> sourceSide(std::vector<int64_t> fromSource, std::vector<int64_t> toSink) const;

private:
    class Flow;

    struct Arc {
        uint32_t to, back; // the arc in the opposite direction
    };
    std::vector<Arc> arcs_;       // by the node that they leave
    std::vector<uint32_t> first_; // of node v: arcs_[first_[v] .. first_[v + 1])
    std::vector<int64_t> capacity_;
};

} // namespace heliodon::geometry
