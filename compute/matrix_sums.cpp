#include "compute/matrix_sums.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "compute/gpu/commands.h"
#include "compute/gpu/device.h"
#include "compute/gpu/kernel.h"
#include "compute/matrix_band.h"
#include "compute/parallel.h"
#include "shaders/io/matrix_sums.io.h"
#include "spirv/matrix_sums_comp.h"

namespace heliodon::compute {

namespace {

// In blocks, since one of the two walks down columns; sums in four, since each addition waits for the last.
MatrixSums onHost(const float* F, std::span<const double> area) {
    constexpr size_t kBlock = 64;
    const size_t n = area.size();
    std::vector<double> squares((n + kBlock - 1) / kBlock, 0.0);
    MatrixSums result{std::vector<double>(n, 0.0)};
    inParallel(squares.size(), [&](size_t block) {
        const size_t i0 = block * kBlock, i1 = std::min(n, i0 + kBlock);
        for (size_t i = i0; i < i1; ++i) {
            std::array<double, 4> part{};
            for (size_t j = 0; j < n; ++j) part[j % 4] += double{F[i * n + j]};
            result.rows[i] = part[0] + part[1] + part[2] + part[3];
        }
        std::array<double, 4> part{};
        for (size_t j0 = i0; j0 < n; j0 += kBlock)
            for (size_t i = i0; i < i1; ++i)
                for (size_t j = std::max(j0, i + 1); j < std::min(n, j0 + kBlock); ++j) {
                    const double d = area[i] * F[i * n + j] - area[j] * F[j * n + i];
                    part[j % 4] += d * d;
                }
        squares[block] = part[0] + part[1] + part[2] + part[3];
    });
    result.reciprocitySquares = std::accumulate(squares.begin(), squares.end(), 0.0);
    return result;
}

// In bands of rows, of as many as a binding holds: each is met by each.
MatrixSums onDevice(gpu::Device& device, const gpu::Buffer& values, std::span<const double> area) {
    constexpr size_t kAcross = 32768; // groups along one axis
    const size_t n = area.size(), rowBytes = 4 * n,
                 most =
                     std::max<size_t>(1, (device.limits().maxStorageBufferRange - kBandAlignment) / rowBytes),
                 bands = (n + most - 1) / most;
    const std::vector<float> single(area.begin(), area.end());
    const gpu::Buffer areas = gpu::Buffer::from(device, single, "patch areas"),
                      sums(device, 16 * n * bands, "matrix sums");
    const gpu::Kernel& kernel = device.kernels().get(matrix_sums_comp, "matrix_sums");
    gpu::Commands commands(device);
    for (size_t a = 0; a < n; a += most)
        for (size_t b = 0; b < n; b += most) {
            const size_t rows = std::min(most, n - a), columns = std::min(most, n - b);
            io::MatrixSumsParams params{};
            params.patches = static_cast<uint32_t>(n);
            params.firstRow = static_cast<uint32_t>(a);
            params.rows = static_cast<uint32_t>(rows);
            params.firstColumn = static_cast<uint32_t>(b);
            params.columns = static_cast<uint32_t>(columns);
            params.sumsAt = static_cast<uint32_t>(b / most * n + a);
            const MatrixBand ofRows = bandOf(values, a * n, (a + rows) * n),
                             ofColumns = bandOf(values, b * n, (b + columns) * n);
            params.rowsAt = ofRows.first + params.firstColumn;
            params.columnsAt = ofColumns.first + params.firstRow;
            const size_t across = std::min(rows, kAcross);
            commands.dispatch(
                kernel, {ofRows.binding, ofColumns.binding, gpu::texel(areas, VK_FORMAT_R32_SFLOAT), sums},
                params, static_cast<uint32_t>(across), static_cast<uint32_t>((rows + across - 1) / across));
        }
    device.submitAndWait(std::move(commands));
    const gpu::HostView<std::array<float, 4>> parts(sums, n * bands);
    MatrixSums result{std::vector<double>(n, 0.0)};
    for (size_t k = 0; k < n * bands; ++k) {
        result.rows[k % n] += double{parts[k][0]} + double{parts[k][1]};
        result.reciprocitySquares += double{parts[k][2]};
    }
    return result;
}

} // namespace

MatrixSums sumsOfMatrix(gpu::Device& device, const gpu::Buffer& values, std::span<const double> area) {
    return values.mapped() ? onHost(values.mapped<float>(), area) : onDevice(device, values, area);
}

} // namespace heliodon::compute
