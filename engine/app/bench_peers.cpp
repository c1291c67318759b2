#include "engine/app/bench_peers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <span>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <unistd.h>

#include "compute/parallel.h"
#include "engine/app/bench_clock.h"
#include "engine/app/interrupt.h"
#include "geometry/bounds.h"
#include "geometry/perpendicular.h"
#ifdef HELIODON_WITH_EMBREE
#include <embree3/rtcore.h>

#include "compute/hemicube.h"
#endif

namespace heliodon::app {

namespace {

// A_i F_ij of both measurements of each pair, combined by their weights; our montecarlo kernel does the same.
[[maybe_unused]] void makeReciprocal(const geometry::PatchMesh& mesh, std::vector<float>& F) {
    const size_t n = mesh.patchCount();
    std::vector<double> area(n);
    for (size_t i = 0; i < n; ++i) area[i] = geometry::patchArea(mesh, i);
    for (size_t i = 0; i < n; ++i)
        for (size_t j = i + 1; j < n; ++j) {
            // A ray of patch i measures A_i F_ij with a variance in proportion to A_i.
            float &there = F[i * n + j], &back = F[j * n + i];
            const double exchange = area[i] * area[j] * (double{there} + double{back}) / (area[i] + area[j]);
            there = static_cast<float>(exchange / area[i]);
            back = static_cast<float>(exchange / area[j]);
        }
}

} // namespace

#ifdef HELIODON_WITH_EMBREE

namespace {

// Sixteen numbers side by side: loops over one become vector instructions.
using Lanes = std::array<float, 16>;

// Directions in a patch's own frame (z along its normal), which all patches share, with the weight of each
// ray. Packets that are not full end in rays of weight 0 along the normal.
struct Bundle {
    std::vector<Lanes> x, y, z, weight;
    size_t rays = 0;

    void add(const glm::dvec3& direction, double w) {
        if (rays % 16 == 0) {
            x.push_back({});
            y.push_back({});
            z.emplace_back().fill(1);
            weight.push_back({});
        }
        const size_t lane = rays++ % 16;
        x.back()[lane] = static_cast<float>(direction.x);
        y.back()[lane] = static_cast<float>(direction.y);
        z.back()[lane] = static_cast<float>(direction.z);
        weight.back()[lane] = static_cast<float>(w);
    }
};

struct Frame {
    glm::vec3 u, v, n;
};

class EmbreeScene {
public:
    explicit EmbreeScene(const geometry::PatchMesh& mesh) : device_(rtcNewDevice(nullptr)) {
        std::vector<std::array<uint32_t, 3>> triangles;
        for (size_t i = 0; i < mesh.patchCount(); ++i)
            for (size_t k = 1; k + 1 < mesh.patch(i).size(); ++k) {
                triangles.push_back({mesh.patch(i)[0], mesh.patch(i)[k], mesh.patch(i)[k + 1]});
                patchOf_.push_back(static_cast<uint32_t>(i));
            }
        nearest_ = static_cast<float>(1e-6 * geometry::boundsOf(mesh.vertices).diagonal());
        RTCGeometry shape = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* corners = static_cast<float*>(rtcSetNewGeometryBuffer(
            shape, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
        for (size_t k = 0; k < mesh.vertices.size(); ++k)
            for (int c = 0; c < 3; ++c)
                corners[3 * k + static_cast<size_t>(c)] = static_cast<float>(mesh.vertices[k][c]);
        void* indices = rtcSetNewGeometryBuffer(shape, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                3 * sizeof(uint32_t), triangles.size());
        std::copy_n(triangles.data(), triangles.size(), static_cast<std::array<uint32_t, 3>*>(indices));
        rtcCommitGeometry(shape);
        scene_ = rtcNewScene(device_);
        rtcAttachGeometry(scene_, shape);
        rtcReleaseGeometry(shape);
        rtcCommitScene(scene_);
    }
    ~EmbreeScene() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    // Shoots one packet of the bundle from `x, y, z` and adds what it hits on the front to `row`.
    void shoot(const Bundle& bundle, size_t packet, const Frame& frame, const Lanes& x, const Lanes& y,
               const Lanes& z, float* row) const {
        alignas(64) RTCRayHit16 rays;
        const Lanes &a = bundle.x[packet], &b = bundle.y[packet], &c = bundle.z[packet];
        for (size_t k = 0; k < 16; ++k) {
            rays.ray.org_x[k] = x[k];
            rays.ray.org_y[k] = y[k];
            rays.ray.org_z[k] = z[k];
            rays.ray.dir_x[k] = a[k] * frame.u.x + b[k] * frame.v.x + c[k] * frame.n.x;
            rays.ray.dir_y[k] = a[k] * frame.u.y + b[k] * frame.v.y + c[k] * frame.n.y;
            rays.ray.dir_z[k] = a[k] * frame.u.z + b[k] * frame.v.z + c[k] * frame.n.z;
            rays.ray.tnear[k] = nearest_;
            rays.ray.tfar[k] = INFINITY;
            rays.ray.time[k] = 0;
            rays.ray.mask[k] = UINT32_MAX;
            rays.ray.flags[k] = 0;
            rays.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
        }
        alignas(64) static constexpr std::array<int, 16> kAll{-1, -1, -1, -1, -1, -1, -1, -1,
                                                              -1, -1, -1, -1, -1, -1, -1, -1};
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        rtcIntersect16(kAll.data(), scene_, &context, &rays);
        for (size_t k = 0; k < 16; ++k) {
            if (rays.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) continue;
            const float towards = rays.hit.Ng_x[k] * rays.ray.dir_x[k] +
                                  rays.hit.Ng_y[k] * rays.ray.dir_y[k] + rays.hit.Ng_z[k] * rays.ray.dir_z[k];
            if (towards < 0) row[patchOf_[rays.hit.primID[k]]] += bundle.weight[packet][k];
        }
    }

private:
    RTCDevice device_;
    RTCScene scene_ = nullptr;
    std::vector<uint32_t> patchOf_; // of each triangle
    float nearest_ = 0;
};

// Where it is rounded least: floats lose a ray's start and ends where a scene lies far from the origin.
geometry::PatchMesh aboutOrigin(geometry::PatchMesh mesh) {
    const glm::dvec3 centre = geometry::boundsOf(mesh.vertices).centre();
    for (glm::dvec3& v : mesh.vertices) v -= centre;
    return mesh;
}

double radicalInverse(uint32_t k, uint32_t base) {
    double result = 0, digit = 1.0 / base;
    for (; k > 0; k /= base, digit /= base) result += digit * (k % base);
    return result;
}

} // namespace

bool hasEmbree() {
    return true;
}

namespace {

// A hemicube's pixels in packets of 4 x 4 neighbours.
Bundle hemicubeBundle(uint32_t resolution) {
    const size_t R = resolution;
    const std::vector<double> deltas = compute::hemicubeDeltas(resolution);
    Bundle bundle;
    const auto face = [&](const glm::dvec3& across, const glm::dvec3& down, const glm::dvec3& ahead,
                          size_t firstLine, const double* delta) {
        const auto pixel = [&](size_t k) {
            return (2 * static_cast<double>(k) + 1) / static_cast<double>(R) - 1;
        };
        for (size_t y0 = firstLine; y0 < R; y0 += 4)
            for (size_t x0 = 0; x0 < R; x0 += 4)
                for (size_t y = y0; y < std::min(R, y0 + 4); ++y)
                    for (size_t x = x0; x < std::min(R, x0 + 4); ++x)
                        bundle.add(ahead + pixel(x) * across + pixel(y) * down,
                                   delta[(y - firstLine) * R + x]);
    };
    const glm::dvec3 u(1, 0, 0), v(0, 1, 0), normal(0, 0, 1);
    face(u, v, normal, 0, deltas.data());
    for (const glm::dvec3& side : {u, -u, v, -v})
        face(glm::cross(normal, side), normal, side, R / 2, deltas.data() + R * R);
    return bundle;
}

Frame frameOf(const glm::dvec3& normal, double turn) {
    const glm::dvec3 a = geometry::perpendicular(normal), b = glm::cross(normal, a);
    const glm::dvec3 u = std::cos(turn) * a + std::sin(turn) * b;
    return {glm::vec3(u), glm::vec3(glm::cross(normal, u)), glm::vec3(normal)};
}

Lanes everywhere(double value) {
    Lanes lanes;
    lanes.fill(static_cast<float>(value));
    return lanes;
}

} // namespace

PeerResult embreeHemicube(const geometry::PatchMesh& given, uint32_t resolution) {
    const size_t n = given.patchCount();
    PeerResult result;
    result.factors.assign(n * n, 0);
    const BenchClock clock;
    const geometry::PatchMesh mesh = aboutOrigin(given);
    const EmbreeScene scene(mesh);
    const Bundle bundle = hemicubeBundle(resolution);
    result.rays = static_cast<double>(n) * static_cast<double>(bundle.rays);
    const compute::PatchViewpoints views = compute::patchViewpoints(mesh, 1);
    compute::inParallel(n, [&](size_t i) {
        throwIfInterrupted();
        const compute::Viewpoint& view = views.viewpoints[i];
        const Frame frame = frameOf(view.normal, view.turn);
        const Lanes x = everywhere(view.position.x), y = everywhere(view.position.y),
                    z = everywhere(view.position.z);
        for (size_t packet = 0; packet < bundle.x.size(); ++packet)
            scene.shoot(bundle, packet, frame, x, y, z, &result.factors[i * n]);
    });
    clock.stop(result.wallSeconds, result.cpuSeconds);
    return result;
}

namespace {

// Where a patch's rays start: Halton's points, moved by a shift of the patch's own so that the errors of
// neighbours do not agree, on the triangles of its fan.
class Starts {
public:
    Starts(const geometry::PatchMesh& mesh, size_t patch, double shift) : mesh_(mesh), shift_(shift) {
        corners_ = mesh.patch(patch);
        for (size_t k = 1; k + 1 < corners_.size(); ++k)
            areas_.push_back(area_ +=
                             glm::length(glm::cross(corner(k) - corner(0), corner(k + 1) - corner(0))));
    }

    glm::dvec3 at(double first, double second) const {
        double s = (first + shift_ < 1 ? first + shift_ : first + shift_ - 1) * area_;
        double t = second + shift_ < 1 ? second + shift_ : second + shift_ - 1;
        const auto fan =
            static_cast<size_t>(std::lower_bound(areas_.begin(), areas_.end() - 1, s) - areas_.begin());
        const double before = fan > 0 ? areas_[fan - 1] : 0;
        s = areas_[fan] > before ? (s - before) / (areas_[fan] - before) : 0;
        if (s + t > 1) {
            s = 1 - s;
            t = 1 - t;
        }
        return corner(0) + s * (corner(fan + 1) - corner(0)) + t * (corner(fan + 2) - corner(0));
    }

private:
    const glm::dvec3& corner(size_t k) const { return mesh_.vertices[corners_[k]]; }

    const geometry::PatchMesh& mesh_;
    double shift_, area_ = 0;
    std::span<const uint32_t> corners_;
    std::vector<double> areas_; // of the fan's triangles, added up, doubled
};

} // namespace

PeerResult embreeRays(const geometry::PatchMesh& given, uint32_t raysPerPatch) {
    const size_t n = given.patchCount();
    PeerResult result;
    result.factors.assign(n * n, 0);
    result.rays = static_cast<double>(n) * raysPerPatch;
    const BenchClock clock;
    const geometry::PatchMesh mesh = aboutOrigin(given);
    const EmbreeScene scene(mesh);
    Bundle bundle;
    std::vector<std::array<double, 2>> starts(raysPerPatch);
    for (uint32_t k = 0; k < raysPerPatch; ++k) {
        starts[k] = {radicalInverse(k + 1, 2), radicalInverse(k + 1, 3)};
        const double sine = std::sqrt(radicalInverse(k + 1, 5)),
                     turn = 2 * std::numbers::pi * radicalInverse(k + 1, 7);
        bundle.add({sine * std::cos(turn), sine * std::sin(turn), std::sqrt(1 - sine * sine)},
                   1.0 / raysPerPatch);
    }
    compute::inParallel(n, [&](size_t i) {
        throwIfInterrupted();
        const double shift = std::fmod(0.6180339887498949 * static_cast<double>(i), 1.0);
        const Starts places(mesh, i, shift);
        const Frame frame = frameOf(geometry::patchNormal(mesh, i), 2 * std::numbers::pi * shift);
        for (size_t packet = 0; packet < bundle.x.size(); ++packet) {
            Lanes x, y, z;
            for (size_t k = 0; k < 16; ++k) {
                const auto& start = starts[std::min<size_t>(16 * packet + k, raysPerPatch - 1)];
                const glm::dvec3 p = places.at(start[0], start[1]);
                x[k] = static_cast<float>(p.x);
                y[k] = static_cast<float>(p.y);
                z[k] = static_cast<float>(p.z);
            }
            scene.shoot(bundle, packet, frame, x, y, z, &result.factors[i * n]);
        }
    });
    makeReciprocal(mesh, result.factors);
    clock.stop(result.wallSeconds, result.cpuSeconds);
    return result;
}

#else

bool hasEmbree() {
    return false;
}
PeerResult embreeHemicube(const geometry::PatchMesh&, uint32_t) {
    return {};
}
PeerResult embreeRays(const geometry::PatchMesh&, uint32_t) {
    return {};
}

#endif

std::string findView3d() {
    std::istringstream folders(std::getenv("PATH") ? std::getenv("PATH") : "");
    for (std::string folder; std::getline(folders, folder, ':');)
        for (const char* name : {"View3D", "view3d"})
            if (const auto file = std::filesystem::path(folder) / name; ::access(file.c_str(), X_OK) == 0)
                return file.string();
    return "";
}

namespace {

class ScratchFolder {
public:
    ScratchFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "heliodon-view3d-XXXXXX").string();
        if (!::mkdtemp(name.data())) throw std::runtime_error("cannot make a folder for View3D");
        path_ = name;
    }
    ~ScratchFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

// View3D's own format 3.
std::string view3dInput(const geometry::PatchMesh& mesh, double epsilon) {
    std::string text = fmt::format("T heliodon bench\nC encl=0 list=0 out=1 eps={:g}\nF 3\n", epsilon);
    for (size_t k = 0; k < mesh.vertices.size(); ++k)
        text += fmt::format("V {} {:.9g} {:.9g} {:.9g}\n", k + 1, mesh.vertices[k].x, mesh.vertices[k].y,
                            mesh.vertices[k].z);
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const auto c = mesh.patch(i);
        if (c.size() > 4) throw std::runtime_error("View3D takes triangles and quadrilaterals only");
        text += fmt::format("S {} {} {} {} {} 0 0 0.5 s{}\n", i + 1, c[0] + 1, c[1] + 1, c[2] + 1,
                            c.size() == 4 ? c[3] + 1 : 0, i + 1);
    }
    return text + "End of data\n";
}

} // namespace

PeerResult view3d(const std::string& program, const geometry::PatchMesh& mesh, double epsilon) {
    const size_t n = mesh.patchCount();
    const ScratchFolder folder;
    std::ofstream(folder.path() / "in.vs3") << view3dInput(mesh, epsilon);
    PeerResult result;
    const BenchClock clock;
    const std::string command =
        fmt::format("cd '{}' && '{}' in.vs3 out.txt > said.txt 2>&1", folder.path().string(), program);
    if (std::system(command.c_str()) != 0) throw std::runtime_error("View3D failed");
    clock.stop(result.wallSeconds, result.cpuSeconds);
    // Its binary form: a line of 32 bytes, areas, rows, emittances, all float32.
    std::ifstream out(folder.path() / "out.txt", std::ios::binary);
    out.seekg(static_cast<std::streamoff>(32 + n * sizeof(float)));
    result.factors.resize(n * n);
    out.read(reinterpret_cast<char*>(result.factors.data()),
             static_cast<std::streamsize>(n * n * sizeof(float)));
    if (!out) throw std::runtime_error("View3D wrote something else than was expected");
    return result;
}

} // namespace heliodon::app
