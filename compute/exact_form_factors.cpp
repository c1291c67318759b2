#include "compute/exact_form_factors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "compute/exact_scene.h"
#include "compute/exact_tiles.h"
#include "compute/gpu/commands.h"
#include "compute/gpu/counters.h"
#include "compute/gpu/device.h"
#include "compute/gpu/kernel.h"
#include "compute/stopwatch.h"
#include "shaders/io/exact_form_factors.io.h"
#include "spirv/exact_blocks_comp.h"
#include "spirv/exact_cells_comp.h"
#include "spirv/exact_few_comp.h"
#include "spirv/exact_few_one_comp.h"
#include "spirv/exact_few_open_comp.h"
#include "spirv/exact_few_two_comp.h"
#include "spirv/exact_finish_comp.h"
#include "spirv/exact_lines_comp.h"
#include "spirv/exact_pairs_clear_comp.h"
#include "spirv/exact_pairs_comp.h"
#include "spirv/exact_pairs_mixed_comp.h"
#include "spirv/exact_sides_comp.h"

namespace heliodon::compute {

namespace {

constexpr uint32_t kTile = 2304; // pieces along a side of what is handled at once
// Records whose cells are refined together: few on a CPU, which wants them in its cache; a discrete device
// waits longer for the host between two levels than it works on so many.
constexpr uint32_t kBatch = 1u << 16, kDiscreteBatch = 1u << 19;
constexpr size_t kSumBytes = 12;                      // per record: form factor, its fraction, error
constexpr uint32_t kMaxCells = 1u << 21;              // of one level of one batch
constexpr uint32_t kChunk = 65535u * io::kExactGroup; // invocations of one dispatch
constexpr uint32_t kMostGroups = 65535;
constexpr double kQuickFrom = 3e-5; // row error from which four points settle most pairs
constexpr double kLinesFrom = 3e-5; // and from which lines across far pieces cost less than exact borders
constexpr uint32_t kLineLevels = 3; // halvings of a piece in exact_lines.comp
constexpr double kFewestPerRow = 8; // of fewer pairs each is held to about the row's error
constexpr double kRowCaution = 1.3; // of single rows over their estimates, so that 99 of 100 hold (measured)
// Estimates of partly hidden pairs lie above their errors, the more so the finer the mesh (measured in twelve
// rooms of 500 to 2088 patches).
double pairCaution(double rowError, uint32_t pieces) {
    return 2.2 * std::clamp(std::pow(rowError / 1e-4, 0.2), 0.5, 1.0) *
           std::clamp(std::pow(pieces / 500.0, 0.2), 1.0, 1.4);
}

// Tolerance of one form factor over that of a row. The finer the mesh and the looser the tolerance, the more
// entries end far below it (calibrated on rooms of 672 and 2088 patches with partitions: measured errors stay
// below what is asked).
double entryTolerance(double rowError, uint32_t pieces) {
    const double share = std::clamp(0.02 * std::sqrt(static_cast<double>(pieces)), 0.2, 1.0) *
                         std::clamp(std::pow(rowError / 1e-4, 0.3), 0.2, 1.0);
    return std::max(rowError * share, 1e-7); // below lies the rounding of float32
}

class Solver {
public:
    Solver(gpu::Device& device, const geometry::PatchMesh& mesh, const ExactOptions& options)
        : device_(device), options_(options) {
        SecondsAdded timer(statistics.setupSeconds);
        const uint64_t storage = device_.limits().maxStorageBufferRange;
        const auto side = static_cast<uint32_t>(std::sqrt(static_cast<double>(storage) / 4));
        scene_ = exactScene(device, mesh, std::min(kTile, side));
        tolerance_ = static_cast<float>(entryTolerance(options.maxError, scene_.pieceCount));
        words_ = std::max(1u, (scene_.blockerCount + 31) / 32);
        prepareKernels();
        makeBuffers(storage);
        statistics.blockers = scene_.blockerCount;
        statistics.closed = scene_.closed;
        statistics.pairs = static_cast<uint64_t>(mesh.patchCount()) * (mesh.patchCount() - 1) / 2;
        rowSquares_.assign(scene_.pieceCount, 0.0);
        if (!options.entryErrors) return;
        entryErrors_.assign(size_t{scene_.patchCount} * scene_.patchCount, 0.0f);
        shareOfPatch_.assign(scene_.pieceCount, 0.0f);
        std::vector<float> patchArea(scene_.patchCount, 0.0f);
        for (size_t i = 0; i < scene_.pieceCount; ++i) patchArea[scene_.patchOfPiece[i]] += scene_.area[i];
        for (size_t i = 0; i < scene_.pieceCount; ++i)
            if (scene_.area[i] > 0) shareOfPatch_[i] = scene_.area[i] / patchArea[scene_.patchOfPiece[i]];
    }

    const ExactScene& scene() const { return scene_; }
    const std::vector<double>& rowSquares() const { return rowSquares_; }
    // Of what was integrated; far pairs in the open, which were held to the tolerance, are left at zero.
    std::vector<float> takeEntryErrors() { return std::move(entryErrors_); }
    float tolerance() const { return tolerance_; }
    // The only tile's values; pieces stand in patch order.
    gpu::Buffer takeMatrix() { return std::move(there_); }

    // Calls `done(a, b)` after each pair of tiles.
    template<class Done> void run(const Done& done) {
        for (const ExactTileRange& a : scene_.tiles) {
            findSides(a, sidesA_);
            for (const ExactTileRange* b = &a; b < scene_.tiles.data() + scene_.tiles.size(); ++b) {
                if (b != &a) findSides(*b, sidesB_);
                runTile(a, *b);
                done(a, *b);
            }
        }
    }

    const gpu::Buffer& there() const { return there_; }
    const gpu::Buffer& back() const { return back_; }

    ExactStatistics statistics;

private:
    gpu::Binding high() const { return gpu::texel(scene_.cornerHigh, VK_FORMAT_R32G32B32A32_SFLOAT); }
    gpu::Binding low() const { return gpu::texel(scene_.cornerLow, VK_FORMAT_R32G32B32A32_SFLOAT); }
    gpu::Binding normal() const { return gpu::texel(scene_.faceNormal, VK_FORMAT_R32G32B32A32_SFLOAT); }
    gpu::Binding centre() const { return gpu::texel(scene_.faceCentre, VK_FORMAT_R32G32B32A32_SFLOAT); }
    gpu::Binding range() const { return gpu::texel(scene_.faceRange, VK_FORMAT_R32G32B32A32_UINT); }
    gpu::Binding clusters() const { return gpu::texel(scene_.clusters, VK_FORMAT_R32G32B32A32_UINT); }
    const gpu::Buffer& sidesOf(bool diagonal) const { return diagonal ? sidesA_ : sidesB_; }
    const gpu::Buffer& backOf(bool diagonal) const { return diagonal ? there_ : back_; }

    struct Source {
        std::span<const uint32_t> spirv;
        std::string name;
        gpu::Specialization values;
    };
    static Source sidesSource() { return {exact_sides_comp, "exact_sides", {}}; }
    static Source blocksSource() { return {exact_blocks_comp, "exact_blocks", {{"kCorners", 4u}}}; }
    static Source finishSource() { return {exact_finish_comp, "exact_finish", {}}; }
    static Source linesSource() { return {exact_lines_comp, "exact_lines", {}}; }
    static Source manySource() { return {exact_cells_comp, "exact_cells", {}}; }
    // Patches of three corners have shaders of their own, folded when the program is built.
    Source pairsSource(bool clear) const {
        using Words = std::span<const uint32_t>;
        const Words folded = clear ? Words(exact_pairs_clear_comp) : Words(exact_pairs_mixed_comp);
        return {scene_.mostCorners == 3 ? folded : Words(exact_pairs_comp),
                "exact_pairs",
                {{"kCorners", scene_.mostCorners}, {"kClear", clear ? 1u : 0u}}};
    }
    Source fewSource(uint32_t blockers) const {
        const uint32_t corners = std::min(scene_.mostCorners, io::kExactFewCorners);
        using Words = std::span<const uint32_t>;
        static constexpr std::array<Words, io::kExactFew + 1> kFolded{
            Words(exact_few_open_comp), Words(exact_few_one_comp), Words(exact_few_two_comp)};
        return {corners == 3 ? kFolded[blockers] : Words(exact_few_comp),
                "exact_few",
                {{"kCorners", corners}, {"kBlockers", blockers}}};
    }

    // Kernels take longer to make than many scenes to compute: those that are likely to have work are begun
    // together, in the order of their use.
    void prepareKernels() {
        std::vector<Source> likely{sidesSource(), blocksSource(), pairsSource(true), pairsSource(false),
                                   fewSource(0)};
        if (byLines()) {
            likely.push_back(linesSource());
            likely.push_back(fewSource(io::kExactFew));
        } else {
            for (uint32_t k = 1; k <= std::min(scene_.blockerCount, io::kExactFew); ++k)
                likely.push_back(fewSource(k));
            if (scene_.blockerCount > io::kExactFew) likely.push_back(manySource());
        }
        likely.push_back(finishSource());
        for (const Source& s : likely) device_.kernels().prepare(s.spirv, s.name, s.values);
    }

    // Whether far pairs with blockers are sampled along lines.
    bool byLines() const {
        return options_.maxError >= kLinesFrom && scene_.mostCorners == 3 && scene_.blockerCount > 0;
    }

    const gpu::Kernel& made(const Source& s) { return device_.kernels().get(s.spirv, s.name, s.values); }

    void makeBuffers(uint64_t storage) {
        uint64_t pieces = 0, mostClusters = 1;
        for (const ExactTileRange& tile : scene_.tiles) {
            pieces = std::max<uint64_t>(pieces, tile.pieces);
            mostClusters = std::max<uint64_t>(mostClusters, tile.clusters);
        }
        const bool oneTile = scene_.tiles.size() == 1;
        const uint64_t pairs = oneTile ? pieces * (pieces - 1) / 2 : pieces * pieces;
        recordCapacity_ =
            static_cast<uint32_t>(std::clamp<uint64_t>(pairs, 1, storage / sizeof(io::ExactRecord)));
        listCapacity_ = static_cast<uint32_t>(std::min<uint64_t>(storage / 4, 1u << 25));
        cellCapacity_ =
            static_cast<uint32_t>(std::min<uint64_t>(storage / (4 * io::kExactCellWords), kMaxCells));
        there_ = gpu::Buffer(device_, pieces * pieces * 4, "form factors");
        if (!oneTile) back_ = gpu::Buffer(device_, pieces * pieces * 4, "exact mirror tile");
        for (gpu::Buffer* sides : {&sidesA_, &sidesB_})
            *sides = gpu::Buffer(device_, (pieces + mostClusters) * words_ * 12, "exact sides");
        blocks_ = gpu::Buffer(device_, mostClusters * mostClusters * 4, "exact blocks");
        masks_ = gpu::Buffer(device_, mostClusters * mostClusters * words_ * 4, "exact masks");
        counters_ = gpu::Counters(device_, io::kExactCounters, "exact counters");
        for (gpu::Buffer* records : {&records_, &fewRecords_})
            *records = gpu::Buffer(device_, static_cast<size_t>(recordCapacity_) * sizeof(io::ExactRecord),
                                   "exact records");
        lists_ = gpu::Buffer(device_, static_cast<size_t>(listCapacity_) * 4, "exact lists");
        sums_ = gpu::Buffer(device_, static_cast<size_t>(recordCapacity_) * kSumBytes, "exact sums");
        for (gpu::Buffer& cells : cells_)
            cells = gpu::Buffer(device_, static_cast<size_t>(cellCapacity_) * io::kExactCellWords * 4,
                                "exact cells");
    }

    void findSides(const ExactTileRange& tile, const gpu::Buffer& sides) {
        SecondsAdded timer(statistics.classifySeconds);
        gpu::Commands commands(device_);
        const io::ExactSidesParams params{scene_.pieceCount, scene_.blockerCount, words_,
                                          tile.firstPiece,   tile.pieces,         tile.firstCluster,
                                          tile.clusters,     scene_.samePlane};
        const size_t count = static_cast<size_t>(tile.pieces + tile.clusters) * words_;
        commands.dispatch(made(sidesSource()), {high(), low(), normal(), centre(), range(), sides}, params,
                          gpu::groupsFor(count, io::kExactGroup));
        commands.barrier(gpu::Stage::compute, gpu::Stage::compute);
        device_.submitAndWait(std::move(commands));
    }

    void runTile(const ExactTileRange& a, const ExactTileRange& b) {
        classify(a, b);
        const uint32_t open = std::min(counters_[io::kExactOpenCount], recordCapacity_);
        const uint32_t one = std::min(counters_[io::kExactOneCount], recordCapacity_);
        const uint32_t lines = std::min(counters_[io::kExactLineCount], recordCapacity_);
        const uint32_t two = std::min(counters_[io::kExactTwoCount], recordCapacity_ - std::max(one, lines));
        const uint32_t many = std::min(counters_[io::kExactManyCount], recordCapacity_ - open);
        statistics.partial += counters_[io::kExactPartialCount];
        statistics.visible += open + one + two + many + lines - counters_[io::kExactPartialCount];
        cellTolerance_ = tolerance_;
        if (lines) integrateLines(lines, a, b);
        if (open) integrate(made(fewSource(0)), records_, 0, open, a, b);
        if (byLines()) cellTolerance_ = std::min(tolerance_, pairTolerance(one + two + many, a, b));
        if (one) integrate(made(fewSource(1)), fewRecords_, 0, one, a, b);
        if (two) integrate(made(fewSource(2)), fewRecords_, recordCapacity_ - two, two, a, b);
        if (many) integrate(made(manySource()), records_, recordCapacity_ - many, many, a, b);
    }

    void classify(const ExactTileRange& a, const ExactTileRange& b) {
        SecondsAdded timer(statistics.classifySeconds);
        const bool diagonal = &a == &b;
        gpu::Commands find(device_);
        find.fill(there_, 0, 0, static_cast<size_t>(a.pieces) * b.pieces * 4);
        if (!diagonal) find.fill(back_, 0, 0, static_cast<size_t>(a.pieces) * b.pieces * 4);
        counters_.clear(find);
        const io::ExactBlocksParams params{scene_.pieceCount, words_,         a.pieces,
                                           b.pieces,          a.firstCluster, a.clusters,
                                           b.firstCluster,    b.clusters,     scene_.closed ? 1u : 0u};
        find.dispatch(made(blocksSource()),
                      {high(), low(), normal(), centre(), range(), clusters(), sidesA_, sidesOf(diagonal),
                       counters_.buffer(), blocks_, masks_},
                      params, gpu::groupsFor(b.clusters, io::kExactGroup), a.clusters);
        counters_.submitAndRead(std::move(find));
        const uint32_t clear = counters_[io::kExactClearCount], mixed = counters_[io::kExactMixedCount];
        statistics.clearBlocks += clear;
        statistics.mixedBlocks += mixed;
        gpu::Commands commands(device_);
        recordPairs(commands, a, b, 0, clear, true);
        recordPairs(commands, a, b, a.clusters * b.clusters - mixed, mixed, false);
        counters_.submitAndRead(std::move(commands));
        statistics.overflows += counters_[io::kExactOverflowCount];
    }

    void recordPairs(gpu::Commands& commands, const ExactTileRange& a, const ExactTileRange& b,
                     uint32_t first, uint32_t count, bool clear) {
        const bool diagonal = &a == &b;
        for (uint32_t done = 0; done < count; done += kMostGroups) {
            const io::ExactPairsParams params{scene_.pieceCount,
                                              words_,
                                              first + done,
                                              a.firstPiece,
                                              b.firstPiece,
                                              a.firstCluster,
                                              b.firstCluster,
                                              b.clusters,
                                              a.pieces,
                                              b.pieces,
                                              recordCapacity_,
                                              listCapacity_,
                                              scene_.closed ? 1u : 0u,
                                              byLines() ? 1u : 0u,
                                              tolerance_};
            commands.dispatch(made(pairsSource(clear)),
                              {high(), low(), normal(), centre(), range(), clusters(), sidesA_,
                               sidesOf(diagonal), counters_.buffer(), blocks_, masks_, records_, lists_,
                               there_, backOf(diagonal), fewRecords_},
                              params, io::kExactStrips, std::min(kMostGroups, count - done));
        }
    }

    void integrate(const gpu::Kernel& kernel, const gpu::Buffer& records, uint32_t first, uint32_t count,
                   const ExactTileRange& a, const ExactTileRange& b) {
        SecondsAdded timer(statistics.cubatureSeconds);
        const uint32_t batch = device_.info().type == "discrete" ? kDiscreteBatch : kBatch;
        for (uint32_t done = 0; done < count; done += batch)
            refine(kernel, records, first + done, std::min(batch, count - done));
        finish(records, first, count, a, b);
    }

    // Errors of a row's entries add up as squares: each of so many pairs may have its share.
    float pairTolerance(uint32_t count, const ExactTileRange& a, const ExactTileRange& b) const {
        const double perRow =
            static_cast<double>(count) * (&a == &b ? 2 : 1) / a.pieces * scene_.pieceCount / b.pieces;
        return static_cast<float>(pairCaution(options_.maxError, scene_.pieceCount) * options_.maxError /
                                  std::sqrt(std::max(perRow, kFewestPerRow)));
    }

    // Far pairs with blockers: in rounds, of which the next takes pairs that are not good enough.
    void integrateLines(uint32_t count, const ExactTileRange& a, const ExactTileRange& b) {
        SecondsAdded timer(statistics.cubatureSeconds);
        const float tolerance = pairTolerance(count, a, b);
        uint32_t left = count;
        for (uint32_t level = 0; level <= kLineLevels && left > 0; ++level) {
            gpu::Commands commands(device_);
            counters_.clear(commands);
            for (uint32_t done = 0; done < left; done += kChunk) {
                const uint32_t part = std::min(kChunk, left - done);
                const io::ExactLinesParams params{done, part, level, level == kLineLevels, tolerance};
                commands.dispatch(made(linesSource()),
                                  {high(), low(), normal(), centre(), range(), fewRecords_, lists_, sums_,
                                   cells_[level % 2], cells_[(level + 1) % 2], counters_.buffer()},
                                  params, gpu::groupsFor(part, io::kExactGroup));
            }
            counters_.submitAndRead(std::move(commands));
            left = std::min(counters_[io::kExactCellCount], left);
            if (level < kLineLevels) statistics.cells += uint64_t{left} << (2 * (level + 1));
        }
        finish(fewRecords_, 0, count, a, b);
    }

    void finish(const gpu::Buffer& records, uint32_t first, uint32_t count, const ExactTileRange& a,
                const ExactTileRange& b) {
        gpu::Commands commands(device_);
        for (uint32_t done = 0; done < count; done += kChunk) {
            const uint32_t part = std::min(kChunk, count - done);
            const io::ExactFinishParams params{first + done, part, a.pieces, b.pieces};
            commands.dispatch(made(finishSource()),
                              {normal(), range(), records, sums_, there_, backOf(&a == &b)}, params,
                              gpu::groupsFor(part, io::kExactGroup));
        }
        device_.submitAndWait(std::move(commands));
        collectErrors(records, first, count);
    }

    // Level by level: cells that are not good enough come back as four. Pairs whose cells do not fit together
    // begin again in two halves.
    void refine(const gpu::Kernel& kernel, const gpu::Buffer& records, uint32_t firstPair, uint32_t pairs) {
        bool firstLevel = true;
        uint32_t first = firstPair, count = pairs;
        for (uint32_t depth = 0; count > 0; ++depth) {
            gpu::Commands commands(device_);
            counters_.clear(commands);
            for (uint32_t done = 0; done < count; done += kChunk) {
                const uint32_t part = std::min(kChunk, count - done);
                const io::ExactCellsParams params{scene_.pieceCount,
                                                  first + done,
                                                  part,
                                                  cellCapacity_,
                                                  firstLevel ? 1u : 0u,
                                                  depth >= options_.maxDepth,
                                                  options_.maxError >= kQuickFrom ? 1u : 0u,
                                                  cellTolerance_};
                commands.dispatch(kernel,
                                  {high(), low(), normal(), centre(), range(), records, lists_,
                                   cells_[depth % 2], counters_.buffer(), sums_, cells_[(depth + 1) % 2]},
                                  params, gpu::groupsFor(part, io::kExactGroup));
            }
            counters_.submitAndRead(std::move(commands));
            count = std::min(counters_[io::kExactCellCount], cellCapacity_);
            statistics.cells += count;
            const uint32_t overflows = counters_[io::kExactOverflowCount];
            if (overflows > 0 && pairs > 1) {
                refine(kernel, records, firstPair, pairs / 2);
                refine(kernel, records, firstPair + pairs / 2, pairs - pairs / 2);
                return;
            }
            statistics.overflows += overflows;
            first = 0;
            firstLevel = false;
        }
    }

    void collectErrors(const gpu::Buffer& list, uint32_t first, uint32_t count) {
        const gpu::HostView<io::ExactRecord> records(list, count, first * sizeof(io::ExactRecord));
        const gpu::HostView<uint32_t> sums(sums_, 3 * static_cast<size_t>(count),
                                           static_cast<size_t>(first) * kSumBytes);
        for (uint32_t k = 0; k < count; ++k) {
            const double error = sums[3 * k + 2] / static_cast<double>(io::kExactOne);
            const io::ExactRecord& r = records[k];
            const double back = error * scene_.area[r.outer] / scene_.area[r.inner];
            rowSquares_[r.outer] += error * error;
            rowSquares_[r.inner] += back * back;
            if (!entryErrors_.empty()) {
                addEntryError(r.outer, r.inner, error);
                addEntryError(r.inner, r.outer, back);
            }
        }
    }

    void addEntryError(uint32_t from, uint32_t to, double error) {
        entryErrors_[size_t{scene_.patchOfPiece[from]} * scene_.patchCount + scene_.patchOfPiece[to]] +=
            (static_cast<float>(error) + tolerance_) * shareOfPatch_[from];
    }

    gpu::Device& device_;
    ExactOptions options_;
    uint32_t words_ = 1, recordCapacity_ = 1, listCapacity_ = 1, cellCapacity_ = 1;
    float tolerance_ = 0, cellTolerance_ = 0;
    ExactScene scene_;
    gpu::Buffer there_, back_; // the tile and its mirror image
    gpu::Counters counters_;
    gpu::Buffer sidesA_, sidesB_, blocks_, masks_, records_, fewRecords_, lists_, sums_, cells_[2];
    std::vector<double> rowSquares_;
    std::vector<float> entryErrors_, shareOfPatch_; // n x n; per piece
};

void report(const Solver& solver, const ExactOptions& options, ExactFormFactors& result) {
    const ExactScene& scene = solver.scene();
    FormFactorReport& report = result.factors.report;
    const ExactStatistics& s = result.statistics = solver.statistics;
    double squares = 0;
    for (size_t i = 0; i < scene.pieceCount; ++i) {
        float& error = result.rowError[scene.patchOfPiece[i]];
        error = std::max(error, static_cast<float>(kRowCaution * std::sqrt(solver.rowSquares()[i])));
        squares += solver.rowSquares()[i];
    }
    report.claimedRowError = std::sqrt(squares / std::max(1.0, static_cast<double>(scene.pieceCount)));
    report.why = fmt::format("row error {:g} asked; {} blockers, {} pairs partly hidden, {} cells",
                             options.maxError, s.blockers, s.partial, s.cells);
    if (s.blockers == 0) report.skipped.emplace_back("occlusion: nothing can stand between two patches");
    if (s.overflows > 0)
        report.warnings.push_back(fmt::format("kernel exact ran out of room in {} places (blockers of one "
                                              "pair beyond {}, or a buffer): form factors "
                                              "there are less exact than claimed",
                                              s.overflows, io::kExactListed));
}

ExactFormFactors emptyResult(const geometry::PatchMesh& mesh) {
    ExactFormFactors result;
    result.factors.report.kernel = "exact";
    result.factors.patchCount = static_cast<uint32_t>(mesh.patchCount());
    result.rowError.assign(mesh.patchCount(), 0.0f);
    return result;
}

} // namespace

ExactFormFactors exactFormFactorTiles(gpu::Device& device, const geometry::PatchMesh& mesh,
                                      const ExactOptions& options,
                                      const std::function<void(const ExactTile&)>& take) {
    ExactFormFactors result = emptyResult(mesh);
    if (mesh.patchCount() == 0) return result;
    SecondsAdded timer(result.factors.report.seconds);
    Solver solver(device, mesh, options);
    solver.run([&](const ExactTileRange& a, const ExactTileRange& b) {
        handOver(solver.scene(), a, b, solver.there(), take);
        if (&a != &b) handOver(solver.scene(), b, a, solver.back(), take);
    });
    report(solver, options, result);
    return result;
}

ExactFormFactors exactFormFactors(gpu::Device& device, const geometry::PatchMesh& mesh,
                                  const ExactOptions& options) {
    ExactFormFactors result = emptyResult(mesh);
    const size_t n = mesh.patchCount();
    SecondsAdded timer(result.factors.report.seconds);
    Solver solver(device, mesh, options);
    if (solver.scene().tiles.size() == 1 && solver.scene().pieceCount == n) {
        solver.run([](const ExactTileRange&, const ExactTileRange&) {});
        result.factors.values = solver.takeMatrix();
    } else {
        // Every entry is in one tile or its mirror image.
        gpu::Buffer& matrix = result.factors.values = gpu::Buffer(device, n * n * 4, "form factors");
        const ExactScene& scene = solver.scene();
        if (scene.tiles.empty()) matrix.upload(std::vector<float>(n * n, 0.0f));
        solver.run([&](const ExactTileRange& a, const ExactTileRange& b) {
            placeTile(device, scene, a, b, solver.there(), matrix);
            if (&a != &b) placeTile(device, scene, b, a, solver.back(), matrix);
        });
    }
    result.entryError = solver.takeEntryErrors();
    if (options.entryErrors) {
        const std::vector<float> values = result.factors.values.download<float>(n * n);
        for (size_t k = 0; k < n * n; ++k)
            if (values[k] > 0 && result.entryError[k] == 0) result.entryError[k] = solver.tolerance();
    }
    report(solver, options, result);
    return result;
}

} // namespace heliodon::compute
