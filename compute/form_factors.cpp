#include "compute/form_factors.h"

#include <array>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "compute/exact_form_factors.h"
#include "compute/gpu/device.h"
#include "compute/hemicube.h"
#include "compute/hierarchical.h"
#include "compute/monte_carlo.h"
#include "geometry/input_error.h"

namespace heliodon::compute {

namespace {

FormFactors hemicubeFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                                const FormFactorOptions& options) {
    FormFactors result;
    result.patchCount = static_cast<uint32_t>(mesh.patchCount());
    HemicubeOptions hemicubeOptions;
    hemicubeOptions.resolution = options.resolution;
    Hemicube hemicube(device, mesh, hemicubeOptions);
    const PatchViewpoints views = patchViewpoints(mesh, options.points);
    result.values = hemicube.run(views.viewpoints, views.pointsPerPatch).factors;
    result.report.kernel = "hemicube";
    result.report.why = options.kernel == "auto" ? "the default kernel" : "as asked";
    result.report.resolution = options.resolution;
    result.report.points = views.pointsPerPatch;
    return result;
}

// Resolution R is that of a grid of R x R rays: as many as a hemicube's top has pixels.
FormFactors monteCarloFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                                  const FormFactorOptions& options) {
    const uint32_t side = std::min(options.resolution, 256u);
    FormFactors result = MonteCarlo(device, mesh, {side * side}).run().factors;
    result.report.resolution = options.resolution;
    return result;
}

FormFactors hierarchicalFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                                    const FormFactorOptions& options) {
    HierarchicalOptions hierarchical;
    if (options.maxError > 0) hierarchical.maxError = options.maxError;
    const HierarchicalFormFactors compressed(device, mesh, hierarchical);
    const uint32_t n = compressed.patchCount();
    std::vector<float> values(size_t{n} * n);
    compressed.rows(0, n, values);
    FormFactors result;
    result.patchCount = n;
    result.report = compressed.report();
    result.values = gpu::Buffer(device, (values.size() * sizeof(float) + 15) / 16 * 16, "form factors");
    result.values.upload(values);
    return result;
}

std::string kernelList() {
    std::string names = "auto";
    for (std::string_view name : formFactorKernels()) names += ", " + std::string(name);
    return names;
}

} // namespace

void measureFormFactors(const geometry::PatchMesh& mesh, const gpu::Buffer& values,
                        FormFactorReport& report) {
    const size_t n = mesh.patchCount();
    if (n == 0) return;
    std::vector<float> copy;
    const float* F = values.mapped<float>();
    if (!F) {
        copy = values.download<float>(n * n);
        F = copy.data();
    }
    std::vector<double> area(n);
    double total = 0, squares = 0;
    report.closureMax = 0;
    for (size_t i = 0; i < n; ++i) total += area[i] = geometry::patchArea(mesh, i);
    for (size_t i = 0; i < n; ++i) {
        double sum = 0;
        for (size_t j = 0; j < n; ++j) sum += F[i * n + j];
        const double gap = std::abs(sum - 1);
        report.closureMax = std::max(report.closureMax, gap);
        squares += gap * gap;
    }
    report.closureRms = std::sqrt(squares / static_cast<double>(n));
    // In blocks, since one of the two walks down columns.
    constexpr size_t kBlock = 64;
    double reciprocity = 0;
    for (size_t i0 = 0; i0 < n; i0 += kBlock)
        for (size_t j0 = i0; j0 < n; j0 += kBlock)
            for (size_t i = i0; i < std::min(n, i0 + kBlock); ++i)
                for (size_t j = std::max(j0, i + 1); j < std::min(n, j0 + kBlock); ++j) {
                    const double d = area[i] * F[i * n + j] - area[j] * F[j * n + i];
                    reciprocity += d * d;
                }
    const double pairs = 0.5 * static_cast<double>(n) * static_cast<double>(n - 1);
    report.reciprocityRms = std::sqrt(reciprocity / std::max(pairs, 1.0)) / (total / static_cast<double>(n));
}

std::span<const std::string_view> formFactorKernels() {
    static constexpr std::array<std::string_view, 4> kNames{"exact", "hemicube", "hierarchical",
                                                            "montecarlo"};
    return kNames;
}

FormFactors computeFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                               const FormFactorOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    FormFactors result;
    // A hemicube's error has a floor of about 2e-2 whatever its resolution: an error bound asks for `exact`.
    if (options.kernel == "exact" || (options.kernel == "auto" && options.maxError > 0)) {
        ExactOptions exact;
        if (options.maxError > 0) exact.maxError = options.maxError;
        result = exactFormFactors(device, mesh, exact).factors;
    } else if (options.kernel == "auto" || options.kernel == "hemicube")
        result = hemicubeFormFactors(device, mesh, options);
    else if (options.kernel == "hierarchical")
        result = hierarchicalFormFactors(device, mesh, options);
    else if (options.kernel == "montecarlo")
        result = monteCarloFormFactors(device, mesh, options);
    else
        throw geometry::InputError("--kernel", options.kernel, "unknown; expected " + kernelList());
    result.report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    measureFormFactors(mesh, result.values, result.report);
    return result;
}

} // namespace heliodon::compute
