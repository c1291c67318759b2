#include "compute/reference/radiosity.h"

#include <cmath>
#include <utility>

namespace heliodon::compute::reference {

std::vector<double> gather(std::span<const float> factors, size_t n, std::span<const float> in,
                           size_t columns) {
    std::vector<double> out(n * columns);
    for (size_t c = 0; c < columns; ++c)
        for (size_t i = 0; i < n; ++i)
            for (size_t j = 0; j < n; ++j) out[c * n + i] += double{factors[i * n + j]} * in[c * n + j];
    return out;
}

std::vector<double> radiosity(std::span<const float> factors, std::span<const float> reflectance,
                              std::span<const float> emitted) {
    const size_t n = emitted.size();
    std::vector<double> a(n * n), x(emitted.begin(), emitted.end());
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < n; ++j)
            a[i * n + j] = (i == j ? 1.0 : 0.0) - double{reflectance[i]} * factors[i * n + j];
    for (size_t k = 0; k < n; ++k) {
        size_t pivot = k;
        for (size_t i = k + 1; i < n; ++i)
            if (std::abs(a[i * n + k]) > std::abs(a[pivot * n + k])) pivot = i;
        for (size_t j = 0; j < n; ++j) std::swap(a[k * n + j], a[pivot * n + j]);
        std::swap(x[k], x[pivot]);
        for (size_t i = k + 1; i < n; ++i) {
            const double factor = a[i * n + k] / a[k * n + k];
            for (size_t j = k; j < n; ++j) a[i * n + j] -= factor * a[k * n + j];
            x[i] -= factor * x[k];
        }
    }
    for (size_t k = n; k-- > 0;) {
        for (size_t j = k + 1; j < n; ++j) x[k] -= a[k * n + j] * x[j];
        x[k] /= a[k * n + k];
    }
    return x;
}

} // namespace heliodon::compute::reference
