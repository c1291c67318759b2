// Hash of keys that are a few whole numbers, for std::unordered_map.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace heliodon::geometry {

struct KeyHash {
    template<size_t N> size_t operator()(const std::array<int64_t, N>& key) const {
        uint64_t hash = 0;
        for (const int64_t value : key) {
            hash = (hash ^ static_cast<uint64_t>(value)) * 0x9E3779B97F4A7C15ull;
            hash ^= hash >> 32;
        }
        return hash;
    }
};

} // namespace heliodon::geometry
