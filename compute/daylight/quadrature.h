// Gauss-Legendre rules on [0, 1], made at compile time.
#pragma once

#include <array>
#include <cstddef>
#include <numbers>

namespace heliodon::daylight {

struct Node {
    double x, weight;
};

// Newton's iteration on the Legendre polynomial of degree n from the usual cosine guess, here by its series:
// std::cos is not constexpr in C++20. Exact to a few 1e-16.
template<size_t n> constexpr std::array<Node, n> gaussLegendre() {
    constexpr auto cosine = [](double x) {
        double term = 1, sum = 1;
        for (int k = 1; k < 30; ++k) {
            term *= -x * x / ((2.0 * k - 1.0) * (2.0 * k));
            sum += term;
        }
        return sum;
    };
    std::array<Node, n> nodes{};
    for (size_t i = 0; i < n; ++i) {
        double x =
            cosine(std::numbers::pi * (static_cast<double>(i) + 0.75) / (static_cast<double>(n) + 0.5));
        double slope = 1;
        for (int round = 0; round < 12; ++round) {
            double previous = 1, value = x;
            for (size_t k = 2; k <= n; ++k) {
                const double kd = static_cast<double>(k);
                const double next = ((2 * kd - 1) * x * value - (kd - 1) * previous) / kd;
                previous = value;
                value = next;
            }
            slope = static_cast<double>(n) * (x * value - previous) / (x * x - 1);
            x -= value / slope;
        }
        nodes[i] = {0.5 * (1 - x), 1 / ((1 - x * x) * slope * slope)};
    }
    return nodes;
}

inline constexpr auto kGauss24 = gaussLegendre<24>();

} // namespace heliodon::daylight
