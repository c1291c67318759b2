// What belongs together, found pair by pair (Galler and Fischer 1964, paths halved).
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace heliodon::geometry {

class DisjointSets {
public:
    DisjointSets() = default;
    explicit DisjointSets(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

    void add() { parent_.push_back(static_cast<uint32_t>(parent_.size())); }
    uint32_t root(uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    // The root of both is that of `to`.
    void join(uint32_t i, uint32_t to) { parent_[root(i)] = root(to); }

private:
    std::vector<uint32_t> parent_;
};

} // namespace heliodon::geometry
