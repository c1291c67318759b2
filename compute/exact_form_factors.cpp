#include "compute/exact_form_factors.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "compute/exact_scene.h"
#include "compute/gpu/commands.h"
#include "compute/gpu/device.h"
#include "compute/gpu/error.h"
#include "compute/gpu/kernel.h"
#include "shaders/io/exact_form_factors.io.h"
#include "spirv/exact_cells_comp.h"
#include "spirv/exact_classify_comp.h"
#include "spirv/exact_finish_comp.h"
#include "spirv/exact_sides_comp.h"

namespace heliodon::compute {

namespace {

constexpr uint32_t kTile = 2304;                      // rows and columns of the matrix handled at once
constexpr uint32_t kStrip = 128;                      // rows classified by one dispatch
constexpr uint32_t kBatch = 1u << 17;                 // records whose cells are refined together
constexpr size_t kSumBytes = 12;                      // per record: form factor, its fraction, error
constexpr uint32_t kMaxCells = 1u << 22;              // of one level of one batch
constexpr uint32_t kChunk = 65535u * io::kExactGroup; // invocations of one dispatch
// Tolerance of one form factor over that of a row. The finer the mesh, the more entries end far below their
// tolerance (calibrated on rooms of 672 and 2088 patches with partitions; measured errors stay below what is
// asked).
double entryShare(uint32_t pieces) {
    return std::clamp(0.02 * std::sqrt(static_cast<double>(pieces)), 0.2, 1.0);
}

class Timer {
public:
    explicit Timer(double& seconds) : seconds_(seconds) {}
    ~Timer() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
    double& seconds_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

class Solver {
public:
    Solver(gpu::Device& device, const geometry::PatchMesh& mesh, const ExactOptions& options)
        : device_(device), options_(options), n_(0) {
        {
            Timer timer(statistics.setupSeconds);
            scene_ = exactScene(device, mesh);
            n_ = scene_.pieceCount;
            tolerance_ = static_cast<float>(std::max(options.maxError, 1e-7) * entryShare(n_));
            chooseSizes();
            gpu::KernelCache& kernels = device.kernels();
            sidesKernel_ = &kernels.get(device, exact_sides_comp, "exact_sides");
            classifyKernel_ = &kernels.get(device, exact_classify_comp, "exact_classify",
                                           {{"kCorners", scene_.mostCorners}});
            firstKernel_ = &kernels.get(device, exact_cells_comp, "exact_cells first", {{"kFirstLevel", 1u}});
            cellsKernel_ = &kernels.get(device, exact_cells_comp, "exact_cells", {{"kFirstLevel", 0u}});
            finishKernel_ = &kernels.get(device, exact_finish_comp, "exact_finish");
            makeBuffers();
        }
        statistics.blockers = scene_.blockerCount;
        statistics.closed = scene_.closed;
        statistics.pairs = static_cast<uint64_t>(mesh.patchCount()) * (mesh.patchCount() - 1) / 2;
        rowSquares_.assign(n_, 0.0);
    }

    void run() {
        findSides();
        for (uint32_t row = 0; row < n_; row += tile_)
            for (uint32_t column = row; column < n_; column += tile_) runTile(row, column);
    }

    const ExactScene& scene() const { return scene_; }
    gpu::Buffer takeMatrix() { return std::move(matrix_); }
    const std::vector<double>& rowSquares() const { return rowSquares_; }

    ExactStatistics statistics;

private:
    gpu::Binding high() const { return gpu::texel(scene_.cornerHigh, VK_FORMAT_R32G32B32A32_SFLOAT); }
    gpu::Binding low() const { return gpu::texel(scene_.cornerLow, VK_FORMAT_R32G32B32A32_SFLOAT); }
    gpu::Binding normal() const { return gpu::texel(scene_.faceNormal, VK_FORMAT_R32G32B32A32_SFLOAT); }
    gpu::Binding centre() const { return gpu::texel(scene_.faceCentre, VK_FORMAT_R32G32B32A32_SFLOAT); }
    gpu::Binding range() const { return gpu::texel(scene_.faceRange, VK_FORMAT_R32G32B32A32_UINT); }
    gpu::Binding rowsOf(uint32_t first, uint32_t count) const {
        return gpu::part(matrix_, static_cast<size_t>(first) * n_ * 4, static_cast<size_t>(count) * n_ * 4);
    }

    void chooseSizes() {
        const uint64_t storage = device_.limits().maxStorageBufferRange;
        tile_ = kTile;
        // Multiples of 64 rows keep every offset aligned.
        while (tile_ > 64 && static_cast<uint64_t>(tile_) * n_ * 4 > storage) tile_ -= 64;
        if (static_cast<uint64_t>(tile_) * n_ * 4 > storage)
            throw gpu::Error(
                fmt::format("exact form factors of {} patches: a storage range of {} bytes is too "
                            "small for 64 rows",
                            n_, storage));
        const uint64_t side = std::min(tile_, n_);
        const uint64_t pairs = n_ <= tile_ ? side * (side - 1) / 2 : side * side;
        recordCapacity_ =
            static_cast<uint32_t>(std::clamp<uint64_t>(pairs, 1, storage / sizeof(io::ExactRecord)));
        listCapacity_ = static_cast<uint32_t>(std::min<uint64_t>(storage / 4, 1u << 25));
        cellCapacity_ =
            static_cast<uint32_t>(std::min<uint64_t>(storage / (4 * io::kExactCellWords), kMaxCells));
        words_ = std::max(1u, (scene_.blockerCount + 31) / 32);
    }

    void makeBuffers() {
        matrix_ = gpu::Buffer(device_, static_cast<size_t>(n_) * n_ * 4, "form factors");
        sides_ = gpu::Buffer(device_, static_cast<size_t>(n_) * words_ * 12, "exact sides");
        counters_ = gpu::Buffer(device_, io::kExactCounters * 4, "exact counters", gpu::Place::host);
        records_ = gpu::Buffer(device_, static_cast<size_t>(recordCapacity_) * sizeof(io::ExactRecord),
                               "exact records");
        lists_ = gpu::Buffer(device_, static_cast<size_t>(listCapacity_) * 4, "exact lists");
        sums_ = gpu::Buffer(device_, static_cast<size_t>(recordCapacity_) * kSumBytes, "exact sums");
        for (gpu::Buffer& cells : cells_)
            cells = gpu::Buffer(device_, static_cast<size_t>(cellCapacity_) * io::kExactCellWords * 4,
                                "exact cells");
    }

    uint32_t& counter(uint32_t index) { return counters_.mapped<uint32_t>()[index]; }

    void findSides() {
        Timer timer(statistics.sidesSeconds);
        gpu::Commands commands(device_);
        commands.fill(matrix_, 0);
        const io::ExactSidesParams params{n_, scene_.blockerCount, words_};
        commands.dispatch(*sidesKernel_, {high(), low(), normal(), centre(), range(), sides_}, params,
                          gpu::groupsFor(static_cast<size_t>(n_) * words_, io::kExactGroup));
        device_.submitAndWait(std::move(commands));
    }

    void runTile(uint32_t row, uint32_t column) {
        const uint32_t rows = std::min(tile_, n_ - row), columns = std::min(tile_, n_ - column);
        classify(row, rows, column, columns);
        const uint32_t visible = std::min(counter(io::kExactVisibleCount), recordCapacity_);
        const uint32_t partial = std::min(counter(io::kExactPartialCount), recordCapacity_ - visible);
        statistics.overflows += counter(io::kExactOverflowCount);
        counter(io::kExactOverflowCount) = 0;
        statistics.visible += visible;
        statistics.partial += partial;
        integrate(0, visible, row, column);
        integrate(recordCapacity_ - partial, partial, row, column);
    }

    void classify(uint32_t row, uint32_t rows, uint32_t column, uint32_t columns) {
        Timer timer(statistics.classifySeconds);
        for (uint32_t k = 0; k < io::kExactCounters; ++k) counter(k) = 0;
        gpu::Commands commands(device_);
        // In strips that begin at the diagonal: idle groups are not free.
        for (uint32_t strip = row; strip < row + rows; strip += kStrip) {
            const uint32_t first = std::max(column, strip / io::kExactGroup * io::kExactGroup);
            if (first >= column + columns) break;
            const io::ExactClassifyParams params{n_,
                                                 words_,
                                                 row,
                                                 column,
                                                 strip,
                                                 first,
                                                 column + columns,
                                                 recordCapacity_,
                                                 listCapacity_,
                                                 scene_.closed ? 1u : 0u,
                                                 tolerance_};
            commands.dispatch(*classifyKernel_,
                              {high(), low(), normal(), centre(), range(), sides_, counters_, records_,
                               lists_, rowsOf(row, rows), rowsOf(column, columns)},
                              params, gpu::groupsFor(column + columns - first, io::kExactGroup),
                              std::min(kStrip, row + rows - strip));
        }
        commands.barrier(gpu::Stage::compute, gpu::Stage::host);
        device_.submitAndWait(std::move(commands));
    }

    void integrate(uint32_t first, uint32_t count, uint32_t row, uint32_t column) {
        if (count == 0) return;
        Timer timer(statistics.cubatureSeconds);
        gpu::Commands zero(device_);
        zero.fill(sums_, 0, static_cast<size_t>(first) * kSumBytes, static_cast<size_t>(count) * kSumBytes);
        device_.submitAndWait(std::move(zero));
        for (uint32_t done = 0; done < count; done += kBatch)
            refine(first + done, std::min(kBatch, count - done));
        gpu::Commands commands(device_);
        const uint32_t rows = std::min(tile_, n_ - row), columns = std::min(tile_, n_ - column);
        for (uint32_t done = 0; done < count; done += kChunk) {
            const uint32_t part = std::min(kChunk, count - done);
            const io::ExactFinishParams params{n_, first + done, part, row, column};
            commands.dispatch(*finishKernel_,
                              {normal(), records_, sums_, rowsOf(row, rows), rowsOf(column, columns)}, params,
                              gpu::groupsFor(part, io::kExactGroup));
        }
        commands.barrier(gpu::Stage::compute, gpu::Stage::host);
        device_.submitAndWait(std::move(commands));
        collectErrors(first, count);
    }

    // Level by level: cells that are not good enough come back as four.
    void refine(uint32_t first, uint32_t count) {
        bool firstLevel = true;
        for (uint32_t depth = 0; count > 0; ++depth) {
            counter(io::kExactCellCount) = 0;
            gpu::Commands commands(device_);
            for (uint32_t done = 0; done < count; done += kChunk) {
                const uint32_t part = std::min(kChunk, count - done);
                const io::ExactCellsParams params{
                    n_, first + done, part, cellCapacity_, depth >= options_.maxDepth, tolerance_};
                commands.dispatch(firstLevel ? *firstKernel_ : *cellsKernel_,
                                  {high(), low(), normal(), centre(), range(), records_, lists_,
                                   cells_[depth % 2], counters_, sums_, cells_[(depth + 1) % 2]},
                                  params, gpu::groupsFor(part, io::kExactGroup));
            }
            commands.barrier(gpu::Stage::compute, gpu::Stage::any);
            device_.submitAndWait(std::move(commands));
            count = std::min(counter(io::kExactCellCount), cellCapacity_ / 4 * 4);
            statistics.cells += count;
            statistics.overflows += counter(io::kExactOverflowCount);
            counter(io::kExactOverflowCount) = 0;
            first = 0;
            firstLevel = false;
        }
    }

    void collectErrors(uint32_t first, uint32_t count) {
        const auto records = records_.download<io::ExactRecord>(count, first * sizeof(io::ExactRecord));
        const auto sums =
            sums_.download<uint32_t>(3 * static_cast<size_t>(count), static_cast<size_t>(first) * kSumBytes);
        for (uint32_t k = 0; k < count; ++k) {
            const double error = sums[3 * k + 2] / static_cast<double>(io::kExactOne);
            const io::ExactRecord& r = records[k];
            const double back = error * scene_.area[r.outer] / scene_.area[r.inner];
            rowSquares_[r.outer] += error * error;
            rowSquares_[r.inner] += back * back;
        }
    }

    gpu::Device& device_;
    ExactOptions options_;
    uint32_t n_, tile_ = kTile, words_ = 1, recordCapacity_ = 1, listCapacity_ = 1, cellCapacity_ = 1;
    float tolerance_ = 0;
    ExactScene scene_;
    const gpu::Kernel *sidesKernel_, *classifyKernel_, *firstKernel_, *cellsKernel_, *finishKernel_;
    gpu::Buffer matrix_, sides_, counters_, records_, lists_, sums_, cells_[2];
    std::vector<double> rowSquares_;
};

// Patches that were cut into pieces: F_IJ = sum_i A_i / A_I sum_j F_ij. Rare and small, so on the host.
gpu::Buffer mergePieces(gpu::Device& device, const ExactScene& scene, const gpu::Buffer& pieces) {
    const size_t n = scene.patchCount, m = scene.pieceCount;
    std::vector<double> sums(n * n, 0.0), area(n, 0.0);
    const std::vector<float> all = pieces.download<float>(m * m);
    for (size_t i = 0; i < m; ++i) {
        area[scene.patchOfPiece[i]] += scene.area[i];
        for (size_t j = 0; j < m; ++j)
            sums[scene.patchOfPiece[i] * n + scene.patchOfPiece[j]] +=
                static_cast<double>(scene.area[i]) * static_cast<double>(all[i * m + j]);
    }
    std::vector<float> result(n * n);
    for (size_t k = 0; k < n * n; ++k)
        result[k] = area[k / n] > 0 ? static_cast<float>(sums[k] / area[k / n]) : 0.0f;
    return gpu::Buffer::from(device, result, "form factors");
}

} // namespace

ExactFormFactors exactFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                                  const ExactOptions& options) {
    ExactFormFactors result;
    FormFactorReport& report = result.factors.report;
    report.kernel = "exact";
    result.factors.patchCount = static_cast<uint32_t>(mesh.patchCount());
    result.rowError.assign(mesh.patchCount(), 0.0f);
    if (mesh.patchCount() == 0) {
        result.factors.values = gpu::Buffer(device, 0, "form factors");
        return result;
    }
    {
        Timer timer(report.seconds);
        Solver solver(device, mesh, options);
        solver.run();
        const ExactScene& scene = solver.scene();
        result.statistics = solver.statistics;
        result.factors.values = solver.takeMatrix();
        if (scene.pieceCount != scene.patchCount)
            result.factors.values = mergePieces(device, scene, result.factors.values);
        double squares = 0;
        for (size_t i = 0; i < scene.pieceCount; ++i) {
            float& error = result.rowError[scene.patchOfPiece[i]];
            error = std::max(error, static_cast<float>(std::sqrt(solver.rowSquares()[i])));
            squares += solver.rowSquares()[i];
        }
        report.claimedRowError = std::sqrt(squares / static_cast<double>(scene.pieceCount));
    }
    const ExactStatistics& s = result.statistics;
    report.why = fmt::format("row error {:g} asked; {} blockers, {} pairs partly hidden, {} cells",
                             options.maxError, s.blockers, s.partial, s.cells);
    if (s.blockers == 0) report.skipped.push_back("occlusion: nothing can stand between two patches");
    if (s.overflows > 0)
        report.skipped.push_back(fmt::format("refinement in {} places where a buffer was full", s.overflows));
    return result;
}

} // namespace heliodon::compute
