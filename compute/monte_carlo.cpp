#include "compute/monte_carlo.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "compute/chi_squared.h"
#include "compute/gpu/commands.h"
#include "compute/gpu/device.h"
#include "compute/gpu/error.h"
#include "compute/texel.h"
#include "geometry/perpendicular.h"
#include "spirv/monte_carlo_combine_comp.h"
#include "spirv/monte_carlo_comp.h"

namespace heliodon::compute {

namespace {

// Of one invocation; fewer where devices end its loops (shaders/lib/loop_limit.glsl).
constexpr uint32_t kRaysEach = 64;
constexpr uint64_t kRaysPerSubmit = 1u << 20; // about a second of a processor: a caller may stop in between
constexpr uint32_t kMostKeptBits = 5;
// Standard deviations: somewhat above 99 in 100 (2.33), since neighbours' hits are not independent.
constexpr double kPercentile = 2.8;
constexpr VkFormat kUvec4 = VK_FORMAT_R32G32B32A32_UINT;

uint32_t reversed(uint32_t x) {
    x = (x << 16) | (x >> 16);
    x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
    x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
    return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

// Each bit is turned by a hash of those above it: a nested uniform scramble. S. Laine, T. Karras, "Stratified
// Sampling for Stochastic Transparency", 2011, with the constants of B. Burley, "Practical Hash-based Owen
// Scrambling", 2020.
uint32_t owenScrambled(uint32_t x, uint32_t seed) {
    x = reversed(x);
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return reversed(x);
}

// Direction numbers of one dimension from its primitive polynomial (degree s, inner coefficients a) and m_1
// .. m_s.
std::array<uint32_t, 32> directionNumbers(uint32_t s, uint32_t a, std::array<uint32_t, 3> m) {
    std::array<uint32_t, 32> v{};
    for (uint32_t k = 0; k < 32; ++k) {
        if (s == 0)
            v[k] = 1u << (31 - k);
        else if (k < s)
            v[k] = m[k] << (31 - k);
        else {
            v[k] = v[k - s] ^ (v[k - s] >> s);
            for (uint32_t j = 1; j < s; ++j) v[k] ^= ((a >> (s - 1 - j)) & 1u) * v[k - j];
        }
    }
    return v;
}

} // namespace

void MonteCarloSpread::add(const MonteCarloSpread& other) {
    halves += other.halves;
    rays += other.rays;
    squares += other.squares;
}

double MonteCarloSpread::estimate() const {
    return std::sqrt(halves);
}

// Sums of squares of as many normal values as `rays` and `squares` say: of such a sum over its expectation by
// chi-squared, of one over another by F (E. Paulson, 1942, from Wilson and Hilferty's roots).
double MonteCarloSpread::claim() const {
    if (!(rays > 0)) return estimate();
    const double spread = chiSquaredSpread(rays, squares), rest = 1 - spread;
    const double ofRays = rays * chiSquaredOverMean(spread, kPercentile);
    const double c = kPercentile * kPercentile * spread / (rest * rest);
    if (c >= 1) return std::sqrt(ofRays);
    return std::sqrt(std::min(ofRays, halves * std::pow((1 + std::sqrt(c * (2 - c))) / (1 - c), 3)));
}

std::vector<glm::uvec4> monteCarloPoints(uint32_t halfRays) {
    const std::array<std::array<uint32_t, 32>, 4> numbers{
        directionNumbers(0, 0, {}), directionNumbers(1, 0, {1}), directionNumbers(2, 1, {1, 3}),
        directionNumbers(3, 1, {1, 3, 1})};
    constexpr std::array<uint32_t, 4> kSeeds{0x68bc21ebu, 0x02e5be93u, 0x967a889bu, 0x368cc8b7u};
    std::vector<glm::uvec4> points(halfRays);
    for (uint32_t k = 0; k < halfRays; ++k)
        for (uint32_t d = 0; d < 4; ++d) {
            uint32_t x = 0;
            for (uint32_t bit = 0; bit < 32; ++bit) x ^= ((k >> bit) & 1u) * numbers[d][bit];
            points[k][static_cast<int>(d)] = owenScrambled(x, kSeeds[d]);
        }
    return points;
}

uint32_t monteCarloKeptBits(uint32_t halfRays) {
    return std::min(kMostKeptBits, static_cast<uint32_t>(std::bit_width(halfRays) - 1) / 2);
}

MonteCarlo::MonteCarlo(gpu::Device& device, const geometry::PatchMesh& mesh, const MonteCarloOptions& options)
    : device_(&device), bvh_(buildBvh(device, bvhTriangles(mesh))),
      trace_(device, monte_carlo_comp, "monte carlo rays",
             {{"kAtomic", device.info().type == "software" ? 0u : 1u}}),
      combine_(device, monte_carlo_combine_comp, "monte carlo combine"),
      cuts_(device, 1, "monte carlo cuts") {
    params_.patchCount = static_cast<uint32_t>(mesh.patchCount());
    // 16 bits hold the hits of either half.
    params_.halfRays = std::bit_ceil(std::clamp(options.rays, 64u, 65536u)) / 2;
    params_.keptBits = monteCarloKeptBits(params_.halfRays);
    params_.rays = std::min(kRaysEach, params_.halfRays);
    params_.nodeCount = bvh_.nodeCount;
    params_.flatness = static_cast<float>(kMonteCarloInPlane * bvh_.diagonal);
    points_ = gpu::Buffer::from(device, monteCarloPoints(params_.halfRays), "monte carlo points");
    uploadEmitters(mesh);
}

void MonteCarlo::uploadEmitters(const geometry::PatchMesh& mesh) {
    std::vector<glm::uvec4> patches, parts;
    std::vector<float> areas;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const auto c = mesh.patch(i);
        const double area = geometry::patchArea(mesh, i);
        areas.push_back(static_cast<float>(area));
        const auto first = static_cast<uint32_t>(parts.size() / 3);
        double sum = 0;
        for (size_t k = 1; k + 1 < c.size() && area > 0; ++k) {
            const glm::dvec3 a = mesh.vertices[c[0]], e = mesh.vertices[c[k]] - a,
                             f = mesh.vertices[c[k + 1]] - a;
            sum += 0.5 * glm::length(glm::cross(e, f)) / area;
            const float share = k + 2 == c.size() ? 1.0f : static_cast<float>(sum);
            parts.push_back(texelOf(a - bvh_.centre, std::bit_cast<uint32_t>(share)));
            parts.push_back(texelOf(e, 0));
            parts.push_back(texelOf(f, 0));
        }
        const glm::dvec3 normal = area > 0 ? geometry::patchNormal(mesh, i) : glm::dvec3(0, 1, 0);
        patches.push_back(texelOf(normal, first));
        patches.push_back(
            texelOf(geometry::perpendicular(normal), static_cast<uint32_t>(parts.size() / 3) - first));
        patches.push_back({mesh.room[i], 0, 0, 0});
    }
    patches.insert(patches.end(), parts.begin(), parts.end());
    emitters_ = gpu::Buffer::from(*device_, patches, "monte carlo emitters");
    areas_ = gpu::Buffer::from(*device_, areas, "monte carlo areas");
}

// A multiple of 64 rows, so that windows begin on any alignment of the device.
uint32_t MonteCarlo::windowRows() const {
    const uint64_t rowBytes = uint64_t{params_.patchCount} * sizeof(uint32_t);
    const uint64_t rows = device_->limits().maxStorageBufferRange / std::max<uint64_t>(rowBytes, 1) / 64 * 64;
    return static_cast<uint32_t>(std::clamp<uint64_t>(rows, 64, uint64_t{1} << 30));
}

void MonteCarlo::trace(const gpu::Buffer& counts, uint32_t firstInBuffer, uint32_t first, uint32_t count) {
    while (!traceInParts(counts, firstInBuffer, first, count)) sendFewerEach();
}

void MonteCarlo::sendFewerEach() {
    if (params_.rays == 1) throw gpu::Error("rays: the device ends loops early, however short they are");
    params_.rays = std::max(params_.rays / 4, 1u);
}

bool MonteCarlo::traceInParts(const gpu::Buffer& counts, uint32_t firstInBuffer, uint32_t first,
                              uint32_t count) {
    io::MonteCarloParams params = params_;
    const size_t rowBytes = size_t{params.patchCount} * sizeof(uint32_t);
    const bool shared = device_->info().type != "software";
    params.firstRow = first;
    params.rowCount = count;
    const uint32_t chunks = rays() / params.rays;
    const uint64_t ofChunk = uint64_t{std::max(count, 1u)} * params.rays;
    const uint32_t perSubmit =
        static_cast<uint32_t>(std::clamp<uint64_t>(kRaysPerSubmit / ofChunk, 1, chunks));
    for (uint32_t from = 0; from < chunks; from += perSubmit) {
        const uint32_t to = std::min(chunks, from + perSubmit);
        gpu::Commands commands(*device_);
        if (from == 0) commands.fill(counts, 0, firstInBuffer * rowBytes, count * rowBytes);
        cuts_.clear(commands);
        const uint32_t each = shared ? to - from : 1;
        for (uint32_t chunk = from; chunk < to; chunk += each) {
            params.firstRay = chunk * params.rays;
            commands.dispatch(trace_,
                              {gpu::texel(bvh_.nodes, kUvec4), gpu::texel(bvh_.triangles, kUvec4),
                               gpu::texel(emitters_, kUvec4), gpu::texel(points_, kUvec4),
                               gpu::part(counts, firstInBuffer * rowBytes, count * rowBytes), cuts_.buffer()},
                              params, gpu::groupsFor(count, io::kMonteCarloGroup), each);
            commands.barrier(gpu::Stage::compute,
                             gpu::Stage::compute); // the next rays add to the same counts
        }
        cuts_.submitAndRead(std::move(commands));
        if (cuts_[0] > 0) return false;
    }
    return true;
}

void MonteCarlo::combine(const gpu::Buffer& counts, const gpu::Buffer& spreads) {
    const uint32_t n = params_.patchCount, window = windowRows(), tile = io::kMonteCarloTile;
    const size_t rowBytes = size_t{n} * sizeof(uint32_t);
    gpu::Commands commands(*device_);
    commands.fill(spreads, 0);
    commands.barrier(gpu::Stage::transfer, gpu::Stage::compute);
    for (uint32_t row = 0; row < n; row += window)
        for (uint32_t column = row; column < n; column += window) {
            const uint32_t rowEnd = std::min(n, row + window), columnEnd = std::min(n, column + window);
            const io::MonteCarloCombineParams params{
                n,         row,        rowEnd,        column,
                columnEnd, row / tile, column / tile, 1.0f / static_cast<float>(rays())};
            commands.dispatch(
                combine_,
                {gpu::texel(areas_, VK_FORMAT_R32_SFLOAT),
                 gpu::part(counts, row * rowBytes, (rowEnd - row) * rowBytes),
                 gpu::part(counts, column * rowBytes, (columnEnd - column) * rowBytes), spreads},
                params, gpu::groupsFor(columnEnd - column, tile), gpu::groupsFor(rowEnd - row, tile));
        }
    device_->submitAndWait(std::move(commands));
}

MonteCarloFormFactors MonteCarlo::run() {
    const uint32_t n = params_.patchCount, window = windowRows();
    MonteCarloFormFactors result;
    FormFactors& factors = result.factors;
    factors.patchCount = n;
    factors.values = gpu::Buffer(*device_, size_t{n} * n * sizeof(float), "form factors");
    factors.report.points = rays();
    result.rows.resize(n);
    if (n == 0) return result;
    for (uint32_t first = 0; first < n; first += window)
        trace(factors.values, first, first, std::min(window, n - first));
    const uint32_t tiles = gpu::groupsFor(n, io::kMonteCarloTile);
    const gpu::Buffer spreads(*device_, size_t{tiles} * n * sizeof(glm::vec3), "monte carlo spreads");
    combine(factors.values, spreads);
    const auto parts = spreads.download<glm::vec3>(size_t{tiles} * n);
    MonteCarloSpread all;
    for (uint32_t i = 0; i < n; ++i) {
        glm::dvec3 hits(0);
        for (uint32_t t = 0; t < tiles; ++t) hits += parts[size_t{t} * n + i];
        result.rows[i] = spreadOf(hits);
        all.add(result.rows[i]);
    }
    all.squares *= 2; // each pair errs in both its rows alike
    factors.report.claimedRowError = all.claim() / std::sqrt(n);
    factors.report.why = fmt::format("{} rays a patch, each pair measured from both ends", rays());
    return result;
}

// Of hits, with one more, that may have been missed.
MonteCarloSpread MonteCarlo::spreadOf(const glm::dvec3& hits) const {
    const double ofOne = 1.0 / rays() / rays();
    return {(hits.x + 1) * ofOne, (hits.y + 1) * ofOne, (hits.z + 1) * ofOne * ofOne};
}

double MonteCarlo::entryError(double factor, double areaFrom, double areaTo, uint32_t rays) {
    const double ofOneHit = areaTo / ((areaFrom + areaTo) * rays); // hits of both directions count
    return ofOneHit * std::sqrt(std::max(factor / ofOneHit, 1.0));
}

void MonteCarlo::rows(uint32_t first, uint32_t count, std::span<float> values,
                      std::span<MonteCarloSpread> spreads) {
    const uint32_t n = params_.patchCount, window = windowRows();
    if (n == 0 || count == 0) return;
    const gpu::Buffer counts(*device_, size_t{std::min(window, count)} * n * sizeof(uint32_t),
                             "monte carlo counts", gpu::Place::host);
    const double scale = 1.0 / rays();
    for (uint32_t done = 0; done < count; done += window) {
        const uint32_t part = std::min(window, count - done);
        trace(counts, 0, first + done, part);
        const auto* hits = counts.mapped<uint32_t>();
        for (uint32_t i = 0; i < part; ++i) {
            glm::dvec3 spread(0);
            for (uint32_t j = 0; j < n; ++j) {
                const double low = hits[size_t{i} * n + j] & 0xffffu, high = hits[size_t{i} * n + j] >> 16;
                const double factor = (low + high) * scale, ofRays = (low + high) * (1 - factor);
                values[size_t{done + i} * n + j] = static_cast<float>(factor);
                spread += glm::dvec3((low - high) * (low - high), ofRays, ofRays * ofRays);
            }
            spreads[done + i] = spreadOf(spread);
        }
    }
}

} // namespace heliodon::compute
