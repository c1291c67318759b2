// What a radiosity solver needs of form factors: products with F, however F is kept (dense, compressed).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace heliodon::compute {

class FormFactorOperator {
public:
    virtual ~FormFactorOperator() = default;

    virtual uint32_t patchCount() const = 0;

    // out[c][i] = sum_j F(i, j) in[c][j], any number of columns, each of patchCount values. Waits for the
    // device; the same bits for the same input.
    virtual void gather(std::span<const float> in, std::span<float> out, uint32_t columns) = 0;

    // The same of columns in these channels, for an F that is not the same in all.
    virtual void gatherIn(std::span<const uint32_t> channel, std::span<const float> in,
                          std::span<float> out) {
        gather(in, out, static_cast<uint32_t>(channel.size()));
    }

    // sum_j F(i, j), one pass.
    std::vector<float> rowSums() {
        const std::vector<float> ones(patchCount(), 1.0f);
        std::vector<float> sums(patchCount());
        gather(ones, sums, 1);
        return sums;
    }
};

} // namespace heliodon::compute
