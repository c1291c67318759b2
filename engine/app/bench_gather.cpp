#include "engine/app/bench_gather.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <thread>

#include "compute/form_factors.h"
#include "compute/parallel.h"
#include "compute/radiosity_gather.h"
#include "compute/stopwatch.h"
#include "vision/median.h"

namespace heliodon::app {

namespace {

// F B as the processor itself does it best: eight floats at a time, four sums, rows spread over all cores.
typedef float Float8 __attribute__((vector_size(32)));

[[gnu::always_inline]] inline void multiplyRows(const float* F, const float* B, float* out, size_t n,
                                                size_t columns, size_t first, size_t last) {
    for (size_t i = first; i < last; ++i)
        for (size_t c = 0; c < columns; ++c) {
            const float *row = F + i * n, *light = B + c * n;
            Float8 sums[4]{}, f, b;
            size_t j = 0;
            for (; j + 32 <= n; j += 32)
                for (size_t k = 0; k < 4; ++k) {
                    std::memcpy(&f, row + j + 8 * k, sizeof f);
                    std::memcpy(&b, light + j + 8 * k, sizeof b);
                    sums[k] += f * b;
                }
            float sum = 0;
            for (; j < n; ++j) sum += row[j] * light[j];
            for (const Float8& part : sums)
                for (int k = 0; k < 8; ++k) sum += part[k];
            out[c * n + i] = sum;
        }
}

using MultiplyRows = void (*)(const float*, const float*, float*, size_t, size_t, size_t, size_t);

#if defined(__x86_64__)
[[gnu::target("avx2,fma")]] void multiplyRowsWide(const float* F, const float* B, float* out, size_t n,
                                                  size_t columns, size_t first, size_t last) {
    multiplyRows(F, B, out, n, columns, first, last);
}
#endif

void multiplyRowsPlain(const float* F, const float* B, float* out, size_t n, size_t columns, size_t first,
                       size_t last) {
    multiplyRows(F, B, out, n, columns, first, last);
}

MultiplyRows bestMultiplyRows() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return multiplyRowsWide;
#endif
    return multiplyRowsPlain;
}

double nativeSeconds(const std::vector<float>& F, const std::vector<float>& B, size_t n, size_t columns) {
    std::vector<float> out(n * columns);
    const size_t workers = std::max(1u, std::thread::hardware_concurrency());
    const auto repeats = std::clamp<size_t>(400'000'000 / (n * n * columns), 3, 1'000'000);
    const MultiplyRows multiply = bestMultiplyRows();
    const compute::Stopwatch watch;
    compute::inParallel(workers, [&](size_t w) {
        for (size_t k = 0; k < repeats; ++k)
            multiply(F.data(), B.data(), out.data(), n, columns, w * n / workers, (w + 1) * n / workers);
    });
    return watch.seconds() / static_cast<double>(repeats);
}

// The worst relative deviation of `out` from F B in double precision.
double worstDeviation(const std::vector<float>& F, const std::vector<float>& B, const std::vector<float>& out,
                      size_t n, size_t columns) {
    double worst = 0;
    for (size_t i = 0; i < n; ++i)
        for (size_t c = 0; c < columns; ++c) {
            double sum = 0;
            for (size_t j = 0; j < n; ++j) sum += double{F[i * n + j]} * double{B[c * n + j]};
            if (sum > 0) worst = std::max(worst, std::abs(out[c * n + i] - sum) / sum);
        }
    return worst;
}

} // namespace

std::vector<GatherResult> benchGather(gpu::Device& device, const geometry::PatchMesh& mesh,
                                      const compute::Roofline& roofline) {
    const auto n = static_cast<uint32_t>(mesh.patchCount());
    compute::FormFactorOptions options; // any matrix of the scene will do
    options.kernel = "hemicube";
    options.resolution = 32;
    const compute::FormFactors F = compute::computeFormFactors(device, mesh, options);
    const std::vector<float> matrix = F.values.download<float>(size_t{n} * n);
    compute::RadiosityGather gather(device, F.values, n);
    std::vector<GatherResult> results;
    for (const uint32_t columns : {1u, 3u}) {
        std::vector<float> B(size_t{n} * columns), out(B.size());
        for (size_t k = 0; k < B.size(); ++k) B[k] = 1 + static_cast<float>(k % 17) / 16;
        std::vector<double> seconds;
        for (int k = 0; k < 22; ++k) {
            const compute::Stopwatch watch;
            gather.gather(B, out, columns);
            if (k > 0) seconds.push_back(watch.seconds());
        }
        GatherResult result{"", n, columns, vision::median(seconds), nativeSeconds(matrix, B, n, columns)};
        result.bytesPerSecond = 4.0 * n * n / result.wallSeconds;
        result.rooflineFraction = roofline.seconds(2.0 * n * n * columns, 4.0 * n * n) / result.wallSeconds;
        result.error = worstDeviation(matrix, B, out, n, columns);
        results.push_back(std::move(result));
    }
    return results;
}

} // namespace heliodon::app
