// How much time does each form-factor kernel take for the error that it leaves? CSV on stdout, a plot as SVG
// beside it, and Embree's rays on the same scene in the same run where the library was found at configure
// time.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "compute/exact_form_factors.h"
#include "compute/form_factors.h"
#include "compute/gpu/device.h"
#include "geometry/model_file.h"
#include "geometry/whole_file.h"
#ifdef HELIODON_WITH_EMBREE
#include <embree3/rtcore.h>
#endif

namespace heliodon {
namespace {

using Matrix = std::vector<float>;

struct Result {
    std::string kernel, setting;
    double seconds = 0, rowError = 0, largest = 0, closure = 0;
};

Result judge(const std::string& kernel, const std::string& setting, double seconds, const Matrix& F,
             const Matrix& reference) {
    const size_t n = static_cast<size_t>(std::lround(std::sqrt(static_cast<double>(F.size()))));
    Result result{kernel, setting, seconds};
    double squares = 0;
    for (size_t i = 0; i < n; ++i) {
        double sum = 0;
        for (size_t j = 0; j < n; ++j) {
            const double error = double{F[i * n + j]} - double{reference[i * n + j]};
            squares += error * error;
            result.largest = std::max(result.largest, std::abs(error));
            sum += double{F[i * n + j]};
        }
        result.closure = std::max(result.closure, std::abs(sum - 1));
    }
    result.rowError = std::sqrt(squares / static_cast<double>(n));
    return result;
}

template<class Function> double medianSeconds(int runs, const Function& f) {
    std::vector<double> seconds;
    for (int k = 0; k < runs; ++k) {
        const auto start = std::chrono::steady_clock::now();
        f();
        seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    std::sort(seconds.begin(), seconds.end());
    return seconds[seconds.size() / 2];
}

Result benchKernel(gpu::Device& device, const geometry::PatchMesh& mesh,
                   const compute::FormFactorOptions& options, const std::string& setting,
                   const Matrix& reference, int runs) {
    compute::FormFactors F = compute::computeFormFactors(device, mesh, options); // warms caches of pipelines
    const double seconds =
        medianSeconds(runs, [&] { F = compute::computeFormFactors(device, mesh, options); });
    return judge(options.kernel, setting, seconds, F.values.download<float>(reference.size()), reference);
}

#ifdef HELIODON_WITH_EMBREE
// Van der Corput sequence in base 2 and 3: Halton's points.
double radicalInverse(uint32_t k, uint32_t base) {
    double result = 0, digit = 1.0 / base;
    for (; k > 0; k /= base, digit /= base) result += digit * (k % base);
    return result;
}

Matrix embreeMatrix(const geometry::PatchMesh& mesh, uint32_t rays) {
    RTCDevice device = rtcNewDevice(nullptr);
    RTCScene scene = rtcNewScene(device);
    RTCGeometry shape = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    std::vector<std::array<uint32_t, 3>> triangles;
    std::vector<uint32_t> patchOf;
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        for (size_t k = 1; k + 1 < mesh.patch(i).size(); ++k) {
            triangles.push_back({mesh.patch(i)[0], mesh.patch(i)[k], mesh.patch(i)[k + 1]});
            patchOf.push_back(static_cast<uint32_t>(i));
        }
    auto* corners = static_cast<float*>(rtcSetNewGeometryBuffer(
        shape, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
    for (size_t k = 0; k < mesh.vertices.size(); ++k)
        for (int c = 0; c < 3; ++c)
            corners[3 * k + static_cast<size_t>(c)] = static_cast<float>(mesh.vertices[k][c]);
    auto* indices = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(
        shape, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), triangles.size()));
    std::copy_n(triangles.data()->data(), 3 * triangles.size(), indices);
    rtcCommitGeometry(shape);
    rtcAttachGeometry(scene, shape);
    rtcReleaseGeometry(shape);
    rtcCommitScene(scene);
    const size_t n = mesh.patchCount();
    Matrix F(n * n, 0.0f);
    const auto rows = [&](size_t first, size_t step) {
        for (size_t i = first; i < n; i += step) {
            const glm::dvec3 a = mesh.vertices[mesh.patch(i)[0]], u = mesh.vertices[mesh.patch(i)[1]] - a;
            const glm::dvec3 v = mesh.vertices[mesh.patch(i)[2]] - a, normal = geometry::patchNormal(mesh, i);
            const glm::dvec3 tangent = glm::normalize(u), other = glm::cross(normal, tangent);
            for (uint32_t k = 0; k < rays; ++k) {
                double s = radicalInverse(k + 1, 2), t = radicalInverse(k + 1, 3);
                if (s + t > 1) {
                    s = 1 - s;
                    t = 1 - t;
                }
                const double r = std::sqrt(radicalInverse(k + 1, 5)),
                             angle = 6.283185307179586 * radicalInverse(k + 1, 7);
                const glm::dvec3 p = a + s * u + t * v;
                const glm::dvec3 d = r * std::cos(angle) * tangent + r * std::sin(angle) * other +
                                     std::sqrt(1 - r * r) * normal;
                RTCRayHit hit{};
                hit.ray.org_x = static_cast<float>(p.x);
                hit.ray.org_y = static_cast<float>(p.y);
                hit.ray.org_z = static_cast<float>(p.z);
                hit.ray.dir_x = static_cast<float>(d.x);
                hit.ray.dir_y = static_cast<float>(d.y);
                hit.ray.dir_z = static_cast<float>(d.z);
                hit.ray.tnear = 1e-5f;
                hit.ray.tfar = INFINITY;
                hit.ray.mask = UINT32_MAX;
                hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
                RTCIntersectContext context;
                rtcInitIntersectContext(&context);
                rtcIntersect1(scene, &context, &hit);
                if (hit.hit.geomID != RTC_INVALID_GEOMETRY_ID)
                    F[i * n + patchOf[hit.hit.primID]] += 1.0f / static_cast<float>(rays);
            }
        }
    };
    const size_t workers = std::max(1u, std::thread::hardware_concurrency());
    std::vector<std::jthread> threads;
    for (size_t w = 0; w < workers; ++w) threads.emplace_back(rows, w, workers);
    threads.clear();
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
    return F;
}
#endif

// Error over time, both logarithmic; what no other result beats in both is filled.
std::string plot(const std::vector<Result>& results) {
    std::string svg =
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 640 440\" font-family=\"sans-serif\" "
        "font-size=\"11\">\n<rect width=\"640\" height=\"440\" fill=\"white\"/>\n";
    const auto x = [](double seconds) { return 320 + 110 * std::log10(std::clamp(seconds, 2e-3, 400.0)); };
    const auto y = [](double error) { return 20 - 60 * (std::log10(std::clamp(error, 1e-7, 1.0))); };
    for (int e = -6; e <= 0; ++e)
        svg += fmt::format("<path d=\"M60 {0}H620\" stroke=\"#ddd\"/><text x=\"10\" y=\"{0}\">1e{1}</text>\n",
                           y(std::pow(10, e)), e);
    for (int e = -2; e <= 2; ++e)
        svg +=
            fmt::format("<path d=\"M{0} 20V400\" stroke=\"#ddd\"/><text x=\"{0}\" y=\"415\">1e{1} s</text>\n",
                        x(std::pow(10, e)), e);
    for (const Result& r : results) {
        const bool front = std::none_of(results.begin(), results.end(), [&](const Result& o) {
            return o.seconds < r.seconds && o.rowError < r.rowError;
        });
        const char* colour = r.kernel == "exact" ? "#c33" : r.kernel == "embree" ? "#383" : "#36c";
        svg += fmt::format("<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"4\" stroke=\"{2}\" fill=\"{3}\"/>"
                           "<text x=\"{4:.1f}\" y=\"{1:.1f}\" fill=\"{2}\">{5} {6}</text>\n",
                           x(r.seconds), y(r.rowError), colour, front ? colour : "white", x(r.seconds) + 7,
                           r.kernel, r.setting);
    }
    return svg + "<text x=\"250\" y=\"434\">RMS row error over wall time</text>\n</svg>\n";
}

int run(int argc, char** argv) {
    if (argc < 2) {
        fmt::print(stderr, "form_factors_bench MODEL.obj [REFERENCE.f32 | -] [PLOT.svg] [RUNS]\n");
        return 2;
    }
    const geometry::PatchMesh mesh = geometry::readPatches(argv[1]);
    const size_t n = mesh.patchCount();
    gpu::Device device;
    Matrix reference(n * n);
    if (argc > 2 && std::string(argv[2]) != "-") {
        std::ifstream file(argv[2], std::ios::binary);
        file.read(reinterpret_cast<char*>(reference.data()),
                  static_cast<std::streamsize>(n * n * sizeof(float)));
        if (!file) {
            fmt::print(stderr, "form_factors_bench: {}: expected {} floats\n", argv[2], n * n);
            return 2;
        }
    } else
        reference = compute::exactFormFactors(device, mesh, {1e-6}).factors.values.download<float>(n * n);
    const int runs = argc > 4 ? std::max(1, std::atoi(argv[4])) : 3;
    std::vector<Result> results;
    fmt::print("device,scene,patches,kernel,setting,seconds,row_error,largest_error,closure_max\n");
    const auto add = [&](const Result& r) {
        results.push_back(r);
        fmt::print("\"{}\",{},{},{},{},{:.4f},{:.3e},{:.3e},{:.3e}\n", device.info().name, argv[1], n,
                   r.kernel, r.setting, r.seconds, r.rowError, r.largest, r.closure);
        std::fflush(stdout);
    };
    for (uint32_t resolution : {32u, 64u, 128u}) {
        compute::FormFactorOptions options{"hemicube", resolution};
        add(benchKernel(device, mesh, options, std::to_string(resolution), reference, runs));
    }
    for (double error : {1e-2, 1e-3, 1e-4, 1e-5}) {
        compute::FormFactorOptions options{"exact"};
        options.maxError = error;
        add(benchKernel(device, mesh, options, fmt::format("{:g}", error), reference, runs));
    }
#ifdef HELIODON_WITH_EMBREE
    for (uint32_t rays : {1024u, 4096u}) {
        Matrix F;
        const double seconds = medianSeconds(runs, [&] { F = embreeMatrix(mesh, rays); });
        add(judge("embree", std::to_string(rays), seconds, F, reference));
    }
#endif
    if (argc > 3) geometry::writeWholeText(argv[3], plot(results));
    return 0;
}

} // namespace
} // namespace heliodon

int main(int argc, char** argv) {
    try {
        return heliodon::run(argc, argv);
    } catch (const std::exception& error) {
        fmt::print(stderr, "form_factors_bench: {}\n", error.what());
        return 1;
    }
}
