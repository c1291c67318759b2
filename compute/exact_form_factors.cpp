#include "compute/exact_form_factors.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "compute/exact_clusters.h"
#include "compute/exact_contours.h"
#include "compute/exact_kernels.h"
#include "compute/exact_scene.h"
#include "compute/exact_tiles.h"
#include "compute/exact_tolerances.h"
#include "compute/gpu/commands.h"
#include "compute/gpu/counters.h"
#include "compute/gpu/device.h"
#include "compute/gpu/kernel.h"
#include "compute/matrix_band.h"
#include "compute/refinement_forecast.h"
#include "compute/stopwatch.h"
#include "shaders/io/exact_form_factors.io.h"

namespace heliodon::compute {

namespace {

// Pieces along a side of what is handled at once: few on a CPU, which wants them in its cache; a discrete
// device is through with a tile sooner than the host asks for the next (9824 patches on an H200: 116 ms by
// 2304, 31 in one). And fewest where the matrix itself takes tiles, which then are as high as the device
// binds rows of it.
constexpr uint32_t kTile = 2304, kDiscreteTile = 16384, kDiscreteStream = 8192, kLeastRows = 1024;
// Records whose cells are refined together: few on a CPU, which wants them in its cache; a discrete device
// waits longer for the host between two levels than it works on so many.
constexpr uint32_t kBatch = 1u << 16, kDiscreteBatch = 1u << 18;
constexpr size_t kSumWords = 4; // per record: form factor, its fraction, error, its fraction
constexpr uint64_t kDiscreteRecords = 1u << 24, kWorkBytes = 256u << 20;
constexpr size_t kCellBytes = 4 * io::kExactCellWords;
constexpr uint32_t kChunk = 65535u * io::kExactGroup; // invocations of one dispatch
constexpr uint32_t kMostGroups = 65535;
constexpr uint32_t kManyWords = 8;  // of 32 blockers
constexpr double kQuickFrom = 3e-5; // row error from which four points settle most pairs
constexpr double kLinesFrom = 3e-5; // and from which lines across far pieces cost less than exact borders
constexpr double kCutsFrom = 1e-4;  // and down from which large patches behind crowds are cut
constexpr uint32_t kLineLevels = 3; // halvings of a piece in exact_lines.comp
// Of single entries over what cells behind crowds err by, each by itself, as they estimate it; of single
// rows, of which few such entries may be nearly all.
constexpr double kCrowdEntries = 2.6;
// Of the matrix: 3 to 13 times its error in rooms with a reference, 1.3 to 2 where this share of its square
// and more is of crowds (160 and 624 boards).
constexpr double kCaution = 5, kCrowdCaution = 1.5, kOfCrowds = 0.2;
constexpr double kRowCaution = 1.3; // of single rows over their estimates, so that 99 of 100 hold (measured)

class Solver {
public:
    // With `whole` tiles are parts of the matrix where they can be, see takeMatrix.
    Solver(gpu::Device& device, const geometry::PatchMesh& mesh, const ExactOptions& options, bool whole)
        : device_(device), options_(options), discrete_(device.info().type == "discrete") {
        const uint64_t storage = device_.limits().maxStorageBufferRange;
        scene_ = exactScene(device, mesh, tileFor(mesh.patchCount(), storage, whole),
                            options.maxError <= kCutsFrom);
        tolerance_ = exactEntryTolerance(options.maxError, scene_.pieceCount);
        words_ = std::max(1u, (scene_.blockerCount + 31) / 32);
        kernels_ = ExactKernels(device, scene_.mostCorners);
        kernels_.prepare(byLines(), scene_.blockerCount);
        if (whole && isBoundByRows(storage))
            matrix_ = gpu::Buffer(device_, size_t{scene_.patchCount} * scene_.patchCount * 4, "form factors");
        makeBuffers(storage);
        statistics.blockers = scene_.blockerCount;
        rowSquares_.assign(scene_.patchCount, 0.0);
        cautiousSquares_.assign(scene_.patchCount, 0.0);
        if (options.entryErrors) entrySquares_.assign(size_t{scene_.patchCount} * scene_.patchCount, 0.0f);
        for (const ExactScene::Covered& c : scene_.covered) {
            claimCovered(c.first, c.second, c.passes);
            claimCovered(c.second, c.first, c.passes);
        }
    }

    const ExactScene& scene() const { return scene_; }
    // Of patches' rows, the squared norms of their estimated errors.
    const std::vector<double>& rowSquares() const { return rowSquares_; }
    // The same of each row by itself.
    const std::vector<double>& cautiousSquares() const { return cautiousSquares_; }
    double crowdSquares() const { return crowdSquares_; }
    // Of what was integrated; far pairs in the open, which were held to the tolerance, are left at zero.
    std::vector<float> takeEntryErrors() {
        for (float& square : entrySquares_) square = std::sqrt(square);
        return std::move(entrySquares_);
    }
    float tolerance() const { return tolerance_; }
    // All of it, if tiles are parts of it: where each patch is one piece, and the device binds enough of its
    // rows.
    gpu::Buffer takeMatrix() { return std::move(matrix_); }
    bool hasMatrix() const { return matrix_.valid(); }

    // Calls `done(a, b)` after each pair of tiles.
    template<class Done> void run(const Done& done) {
        const double all = 0.5 * static_cast<double>(scene_.pieceCount) * scene_.pieceCount;
        double pairs = 0;
        clearSums();
        for (const ExactTileRange& a : scene_.tiles) {
            findSides(a, sidesA_);
            for (const ExactTileRange* b = &a; b < scene_.tiles.data() + scene_.tiles.size(); ++b) {
                const double ofThese = (b == &a ? 0.5 : 1.0) * a.pieces * b->pieces;
                tiles_.begin(ofThese / all);
                if (b != &a) findSides(*b, sidesB_);
                runTile(a, *b);
                done(a, *b);
                tellOfLongWork(0);
                pairs += ofThese;
                if (options_.progress) options_.progress(pairs / all);
            }
        }
        readClaims();
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
    gpu::Binding sides(const gpu::Buffer& of) const { return gpu::texel(of, VK_FORMAT_R32G32B32A32_UINT); }
    gpu::Binding sidesOf(bool diagonal) const { return sides(diagonal ? sidesA_ : sidesB_); }

    uint32_t tileFor(size_t patches, uint64_t storage, bool whole) const {
        uint64_t tile = discrete_ ? whole ? kDiscreteTile : kDiscreteStream : kTile;
        const uint64_t rows = storage / (4 * std::max<uint64_t>(patches, 1)) - 1; // and what alignment adds
        if (whole && rows >= kLeastRows) tile = std::min(tile, rows);
        // Records, lists and cells of a discrete device's tiles take about 8 bytes a pair.
        const uint64_t most =
            discrete_ ? std::min(storage / 4, device_.memory().largestHeap() / 32) : storage / 4;
        return static_cast<uint32_t>(
            std::min(static_cast<double>(tile), std::sqrt(static_cast<double>(most))));
    }

    bool isBoundByRows(uint64_t storage) const {
        return std::ranges::all_of(scene_.tiles, [&](const ExactTileRange& tile) {
            return tile.piecesArePatches &&
                   4 * uint64_t{scene_.patchCount} * tile.pieces + kBandAlignment <= storage;
        });
    }

    // Where F of rows of one tile and columns of another stands; `buffer` if not in the matrix.
    struct Half {
        gpu::Binding binding;
        uint32_t first, stride; // in floats
    };
    Half halfOf(const ExactTileRange& rows, const ExactTileRange& columns, const gpu::Buffer& buffer) const {
        if (!hasMatrix()) return {buffer, 0, columns.pieces};
        const size_t n = scene_.patchCount, first = rows.firstPatch * n + columns.firstPatch;
        const MatrixBand band = bandOf(matrix_, first, first + (rows.patches - 1) * n + columns.patches);
        return {band.binding, band.first, scene_.patchCount};
    }

    struct Halves {
        Half there, back;
        io::ExactHalves params() const { return {there.first, there.stride, back.first, back.stride}; }
    };
    Halves halvesOf(const ExactTileRange& a, const ExactTileRange& b) const {
        return {halfOf(a, b, there_), halfOf(b, a, &a == &b ? there_ : back_)};
    }

    // Whether far pairs with blockers are sampled along lines.
    bool byLines() const {
        return options_.maxError >= kLinesFrom && scene_.mostCorners == 3 && scene_.blockerCount > 0;
    }

    void makeBuffers(uint64_t storage) {
        uint64_t pieces = 0, mostClusters = 1;
        for (const ExactTileRange& tile : scene_.tiles) {
            pieces = std::max<uint64_t>(pieces, tile.pieces);
            mostClusters = std::max<uint64_t>(mostClusters, tile.clusters);
        }
        const bool oneTile = scene_.tiles.size() == 1;
        const uint64_t pairs = oneTile ? pieces * (pieces - 1) / 2 : pieces * pieces,
                       mostRecords = discrete_ ? std::max(kDiscreteRecords, pairs / 8) : pairs;
        recordCapacity_ = static_cast<uint32_t>(
            std::clamp<uint64_t>(std::min(pairs, mostRecords), 1, storage / sizeof(io::ExactRecord)));
        workBytes_ = options_.workBytes.value_or(std::max(kWorkBytes, discrete_ ? 2 * pairs : 0));
        listCapacity_ =
            static_cast<uint32_t>(std::max<uint64_t>(1, std::min<uint64_t>(storage, workBytes_ / 2) / 4));
        const uint64_t slack = 4 * (uint64_t{options_.maxDepth} + 2); // four of each level, see `refine`
        cellCapacity_ =
            static_cast<uint32_t>(std::max<uint64_t>(std::min<uint64_t>(storage, workBytes_ / 4) / kCellBytes,
                                                     slack + cellsOfPair()) -
                                  slack);
        // exact_lines.comp keeps numbers of records there, too.
        const uint64_t cellBytes =
            std::max<uint64_t>((cellCapacity_ + slack) * kCellBytes, 4 * uint64_t{recordCapacity_});
        if (!hasMatrix()) there_ = gpu::Buffer(device_, pieces * pieces * 4, "exact tile");
        if (!hasMatrix() && !oneTile) back_ = gpu::Buffer(device_, pieces * pieces * 4, "exact mirror tile");
        for (gpu::Buffer* sides : {&sidesA_, &sidesB_})
            *sides = gpu::Buffer(device_, (pieces + mostClusters) * words_ * 16, "exact sides");
        blocks_ = gpu::Buffer(device_, mostClusters * mostClusters * 4, "exact blocks");
        masks_ = gpu::Buffer(device_, mostClusters * mostClusters * words_ * 4, "exact masks");
        counters_ = gpu::Counters(device_, io::kExactCounters, "exact counters");
        for (gpu::Buffer* records : {&records_, &fewRecords_})
            *records = gpu::Buffer(device_, sizeof(io::ExactRecord) * recordCapacity_, "exact records");
        lists_ = gpu::Buffer(device_, static_cast<size_t>(listCapacity_) * 4, "exact lists");
        sums_ = gpu::Buffer(device_, 4 * kSumWords * recordCapacity_, "exact sums");
        claims_ = gpu::Buffer(device_, size_t{4} * io::kExactClaimWords * scene_.patchCount, "exact claims");
        for (gpu::Buffer& cells : cells_) cells = gpu::Buffer(device_, cellBytes, "exact cells");
    }

    void findSides(const ExactTileRange& tile, const gpu::Buffer& sides) {
        gpu::Commands commands(device_);
        const io::ExactSidesParams params{scene_.pieceCount, scene_.blockerCount, words_,
                                          tile.firstPiece,   tile.pieces,         tile.firstCluster,
                                          tile.clusters,     scene_.samePlane};
        const size_t count = static_cast<size_t>(tile.pieces + tile.clusters) * words_;
        commands.dispatch(kernels_.sides(), {high(), low(), normal(), centre(), range(), sides}, params,
                          gpu::groupsFor(count, io::kExactGroup));
        device_.submitAndWait(std::move(commands));
    }

    // Some of a pair of tiles' blocks.
    struct Window {
        uint32_t clear, firstMixed, mixed;
        double share; // of all mixed ones
    };

    // Blocks that something may stand in are taken in windows: all at once, or as many as have room.
    void runTile(const ExactTileRange& a, const ExactTileRange& b) {
        const auto [clear, mixed] = findBlocks(a, b);
        // A count of listed blockers must not come round.
        const uint64_t mostOfBlock =
            uint64_t{kClusterPieces} * kClusterPieces * std::max(1u, scene_.blockerCount);
        uint32_t size =
            static_cast<uint32_t>(std::clamp<uint64_t>(UINT32_MAX / mostOfBlock, 1, std::max(1u, mixed)));
        uint32_t done = 0;
        do {
            size = std::min(size, mixed - done);
            const uint32_t firstMixed = a.clusters * b.clusters - mixed;
            if (done == 0 &&
                size < mixed) { // they came as invocations end; what a window holds sets tolerances
                std::vector<uint32_t> blocks = blocks_.download<uint32_t>(mixed, size_t{firstMixed} * 4);
                std::sort(blocks.begin(), blocks.end());
                blocks_.upload(blocks, size_t{firstMixed} * 4);
            }
            const Window window{done == 0 ? clear : 0, firstMixed + done, size,
                                size / std::max(1.0, static_cast<double>(mixed))};
            if (!classify(a, b, window)) {
                if (size <= 1)
                    throw std::runtime_error(fmt::format(
                        "kernel exact: {} bytes, in storage buffers as device '{}' has them, do not hold "
                        "what may stand between two clusters of patches",
                        workBytes_, device_.info().name));
                size /= 2;
                continue;
            }
            ++statistics.windows;
            integrateWindow(a, b, window.share);
            done += size;
        } while (done < mixed);
    }

    void integrateWindow(const ExactTileRange& a, const ExactTileRange& b, double share) {
        const uint32_t open = counters_[io::kExactOpenCount], one = counters_[io::kExactOneCount],
                       two = counters_[io::kExactTwoCount], many = counters_[io::kExactManyCount],
                       lines = counters_[io::kExactLineCount], openMany = counters_[io::kExactOpenManyCount];
        statistics.partial += uint64_t{lines} + one + two + many - openMany;
        cellTolerance_ = tolerance_;
        if (lines) integrateLines(lines, pairTolerance(lines / share, a, b), a, b);
        if (open) integrate(kernels_.few(0), records_, 0, open, a, b, true);
        if (byLines() && share > 0)
            cellTolerance_ = std::min(tolerance_, pairTolerance((one + two + many) / share, a, b));
        if (one) integrate(kernels_.few(1), fewRecords_, 0, one, a, b, false);
        if (two) integrate(kernels_.few(2), fewRecords_, recordCapacity_ - two, two, a, b, false);
        if (many) integrate(kernels_.many(), records_, recordCapacity_ - many, many, a, b, openMany > 0);
    }

    // Leaves what the kernels counted in `counters_`.
    void submit(gpu::Commands&& commands) {
        counters_.submitAndRead(std::move(commands));
        if (counters_[io::kExactCutCount] > 0)
            throw TooManyBlockers(
                fmt::format("kernel exact: more blockers stand between two patches than device "
                            "'{}' has turns of loops for; --kernel hierarchical takes any number",
                            device_.info().name));
    }

    // Counts of pairs of clusters that face one another: nothing may stand between, something may.
    std::pair<uint32_t, uint32_t> findBlocks(const ExactTileRange& a, const ExactTileRange& b) {
        const bool diagonal = &a == &b;
        gpu::Commands commands(device_);
        if (!hasMatrix()) commands.fill(there_, 0, 0, static_cast<size_t>(a.pieces) * b.pieces * 4);
        if (!hasMatrix() && !diagonal)
            commands.fill(back_, 0, 0, static_cast<size_t>(a.pieces) * b.pieces * 4);
        counters_.clear(commands);
        const io::ExactBlocksParams params{scene_.pieceCount, words_,     a.pieces,       b.pieces,
                                           a.firstCluster,    a.clusters, b.firstCluster, b.clusters};
        commands.dispatch(kernels_.blocks(),
                          {high(), low(), normal(), centre(), range(), clusters(), sides(sidesA_),
                           sidesOf(diagonal), counters_.buffer(), blocks_, masks_},
                          params, gpu::groupsFor(b.clusters, io::kExactGroup), a.clusters);
        submit(std::move(commands));
        const uint32_t clear = counters_[io::kExactClearCount], mixed = counters_[io::kExactMixedCount];
        return {clear, mixed};
    }

    // False where records or lists of blockers did not fit; nothing is counted then.
    bool classify(const ExactTileRange& a, const ExactTileRange& b, const Window& window) {
        gpu::Commands commands(device_);
        counters_.clear(commands);
        recordPairs(commands, a, b, 0, window.clear, true);
        recordPairs(commands, a, b, window.firstMixed, window.mixed, false);
        submit(std::move(commands));
        const auto fit = [&](uint32_t one, uint32_t other) {
            return uint64_t{counters_[one]} + counters_[other] <= recordCapacity_;
        };
        return counters_[io::kExactListCount] <= listCapacity_ &&
               fit(io::kExactOpenCount, io::kExactManyCount) && fit(io::kExactOneCount, io::kExactTwoCount) &&
               fit(io::kExactLineCount, io::kExactTwoCount);
    }

    void recordPairs(gpu::Commands& commands, const ExactTileRange& a, const ExactTileRange& b,
                     uint32_t first, uint32_t count, bool clear) {
        const bool diagonal = &a == &b;
        // Groups that share the pairs of a block: where blockers are many, one pair is enough for an
        // invocation.
        const uint32_t strips =
            words_ > kManyWords ? gpu::groupsFor(kClusterPieces * kClusterPieces, io::kExactGroup) : 1;
        const Halves halves = halvesOf(a, b);
        for (uint32_t done = 0; done < count; done += kMostGroups) {
            const io::ExactPairsParams params{scene_.pieceCount, words_,        first + done,
                                              a.firstPiece,      b.firstPiece,  a.firstCluster,
                                              b.firstCluster,    b.clusters,    halves.params(),
                                              recordCapacity_,   listCapacity_, byLines() ? 1u : 0u,
                                              tolerance_};
            commands.dispatch(kernels_.pairs(clear),
                              {high(), low(), normal(), centre(), range(), clusters(), sides(sidesA_),
                               sidesOf(diagonal), counters_.buffer(), blocks_, masks_, records_, lists_,
                               halves.there.binding, halves.back.binding, fewRecords_},
                              params, strips, std::min(kMostGroups, count - done));
        }
    }

    // `open`: nothing may stand between some.
    void integrate(const gpu::Kernel& kernel, gpu::Buffer& records, uint32_t first, uint32_t count,
                   const ExactTileRange& a, const ExactTileRange& b, bool open) {
        const uint32_t most = discrete_ ? kDiscreteBatch : kBatch;
        const uint32_t batch = std::min(most, cellCapacity_ / cellsOfPair());
        const uint32_t byCells = count - (open ? integrateContours(records, first, count) : 0);
        RefinementForecast forecast(byCells);
        for (uint32_t done = 0; done < byCells; done += batch)
            refine(kernel, records, first + done, std::min(batch, byCells - done), forecast);
        finish(records, first, count, a, b, true);
    }

    // How many; they stand at the end then.
    uint32_t integrateContours(gpu::Buffer& records, uint32_t first, uint32_t count) {
        auto list = records.download<io::ExactRecord>(count, first * sizeof(io::ExactRecord));
        const std::vector<glm::uvec4> sums = sumsByContours(scene_, list, tolerance_);
        if (sums.empty()) return 0;
        records.upload(list, first * sizeof(io::ExactRecord));
        sums_.upload(sums, sizeof(glm::uvec4) * (first + count - sums.size()));
        return static_cast<uint32_t>(sums.size());
    }

    float pairTolerance(double count, const ExactTileRange& a, const ExactTileRange& b) const {
        const double perRow = count * (&a == &b ? 2 : 1) / a.pieces * scene_.pieceCount / b.pieces;
        return exactPairTolerance(options_.maxError, scene_.pieceCount, perRow);
    }

    // Far pairs with blockers: in rounds, of which the next takes pairs that are not good enough.
    void integrateLines(uint32_t count, float tolerance, const ExactTileRange& a, const ExactTileRange& b) {
        uint32_t left = count;
        for (uint32_t level = 0; level <= kLineLevels && left > 0; ++level) {
            gpu::Commands commands(device_);
            counters_.clear(commands);
            for (uint32_t done = 0; done < left; done += kChunk) {
                const uint32_t part = std::min(kChunk, left - done);
                const io::ExactLinesParams params{done, part, level, level == kLineLevels, tolerance};
                commands.dispatch(kernels_.lines(),
                                  {high(), low(), normal(), centre(), range(), fewRecords_, lists_, sums_,
                                   cells_[level % 2], cells_[(level + 1) % 2], counters_.buffer()},
                                  params, gpu::groupsFor(part, io::kExactGroup));
            }
            submit(std::move(commands));
            left = std::min(counters_[io::kExactCellCount], left);
            if (level < kLineLevels) statistics.cells += uint64_t{left} << (2 * (level + 1));
        }
        finish(fewRecords_, 0, count, a, b, false);
    }

    // `byCells`: sums are as exact_cubature.glsl leaves them.
    void finish(const gpu::Buffer& records, uint32_t first, uint32_t count, const ExactTileRange& a,
                const ExactTileRange& b, bool byCells) {
        const Halves halves = halvesOf(a, b);
        const uint32_t mostExact = !byCells                                    ? UINT32_MAX
                                   : cellTolerance_ < io::kExactCrowdTolerance ? io::kExactCrowdExact
                                                                               : io::kExactCrowd;
        gpu::Commands commands(device_);
        for (uint32_t done = 0; done < count; done += kChunk) {
            const uint32_t part = std::min(kChunk, count - done);
            const io::ExactFinishParams params{first + done, part, mostExact, halves.params()};
            commands.dispatch(kernels_.finish(),
                              {normal(), range(), records, sums_, halves.there.binding, halves.back.binding,
                               gpu::texel(scene_.rowOfPiece, VK_FORMAT_R32G32_UINT), claims_},
                              params, gpu::groupsFor(part, io::kExactGroup));
        }
        device_.submitAndWait(std::move(commands));
        if (!entrySquares_.empty()) collectEntryErrors(records, first, count, mostExact);
    }

    void clearSums() {
        gpu::Commands commands(device_);
        commands.fill(claims_, 0);
        if (hasMatrix()) commands.fill(matrix_, 0);
        device_.submitAndWait(std::move(commands));
    }

    void readClaims() {
        const gpu::HostView<uint32_t> words(claims_, size_t{io::kExactClaimWords} * scene_.patchCount);
        const auto sumFrom = [&](size_t word) {
            return words[word] + std::ldexp(words[word + 1], -32) + std::ldexp(words[word + 2], -64);
        };
        for (size_t i = 0; i < scene_.patchCount; ++i) {
            const double plain = sumFrom(io::kExactClaimWords * i),
                         crowd = sumFrom(io::kExactClaimWords * i + 3);
            rowSquares_[i] += plain + crowd;
            cautiousSquares_[i] += plain + kCrowdEntries * kCrowdEntries * crowd;
            crowdSquares_ += crowd;
        }
    }

    // A pair becomes at most four cells for each triangle of a piece that another's plane has cut.
    uint32_t cellsOfPair() const { return 4 * (scene_.mostCorners - 1); }

    // Level by level, and depth first where a level is large: a step takes so many cells that whatever they
    // become fits into half of the room left. Levels take turns in two buffers.
    void refine(const gpu::Kernel& kernel, const gpu::Buffer& records, uint32_t firstPair, uint32_t pairs,
                RefinementForecast& forecast) {
        struct Level {
            uint32_t first, count;
        };
        const auto once = [&](uint32_t first, uint32_t count, uint32_t next, uint32_t depth) {
            const uint32_t made = refineOnce(kernel, records, first, count, next, depth);
            forecast.step(depth, count, made);
            // A few small steps, most of them waiting for the device, say little.
            const bool known = forecast.secondsTimed() > options_.longFrom / 20;
            tellOfLongWork(known ? forecast.secondsLeft() : 0);
            return made;
        };
        std::vector<Level> levels{{0, once(firstPair, pairs, 0, 0)}};
        while (!levels.empty()) {
            const auto depth = static_cast<uint32_t>(levels.size());
            Level& level = levels.back();
            if (level.count == 0) {
                levels.pop_back();
                continue;
            }
            const uint32_t next = depth > 1 ? levels[depth - 2].first + levels[depth - 2].count : 0;
            const uint32_t left = cellCapacity_ - std::min(cellCapacity_, next);
            // Pairs that are looked at from the other piece begin there.
            const uint32_t each = depth > 1 ? 4 : cellsOfPair();
            const uint32_t part = std::min(level.count, std::max(1u, left / (2 * each)));
            if (part < level.count) ++statistics.depthFirstSteps;
            level.count -= part;
            const uint32_t first = level.first + level.count;
            levels.push_back({next, once(first, part, next, depth)});
        }
    }

    // `ofThese`: seconds left of the pair of tiles at work, as far as is known.
    void tellOfLongWork(double ofThese) {
        const double left = tiles_.secondsLeft(ofThese), all = watch_.seconds() + left;
        if (!options_.longWork || left <= options_.longFrom || all < 2 * longestTold_) return;
        longestTold_ = all;
        options_.longWork(left);
    }

    // Pairs, at depth 0, or cells; how many were written from `next` on.
    uint32_t refineOnce(const gpu::Kernel& kernel, const gpu::Buffer& records, uint32_t first, uint32_t count,
                        uint32_t next, uint32_t depth) {
        gpu::Commands commands(device_);
        counters_.clear(commands);
        for (uint32_t done = 0; done < count; done += kChunk) {
            const uint32_t part = std::min(kChunk, count - done);
            const io::ExactCellsParams params{scene_.pieceCount,
                                              first + done,
                                              part,
                                              next,
                                              depth == 0,
                                              depth >= options_.maxDepth,
                                              options_.maxError >= kQuickFrom ? 1u : 0u,
                                              cellTolerance_};
            commands.dispatch(kernel,
                              {high(), low(), normal(), centre(), range(), records, lists_,
                               cells_[(depth + 1) % 2], counters_.buffer(), sums_, cells_[depth % 2]},
                              params, gpu::groupsFor(part, io::kExactGroup));
        }
        submit(std::move(commands));
        statistics.cells += counters_[io::kExactCellCount];
        return counters_[io::kExactCellCount];
    }

    void collectEntryErrors(const gpu::Buffer& list, uint32_t first, uint32_t count, uint32_t mostExact) {
        const gpu::HostView<io::ExactRecord> records(list, count, first * sizeof(io::ExactRecord));
        const gpu::HostView<uint32_t> sums(sums_, kSumWords * count, 4 * kSumWords * first);
        for (uint32_t k = 0; k < count; ++k) {
            const uint32_t* sum = sums.data() + kSumWords * k;
            const double added = (sum[2] + sum[3] / double{io::kExactFraction}) / double{io::kExactOne};
            const io::ExactRecord& r = records[k];
            const bool crowd = r.listed > mostExact;
            const double error = crowd ? kCrowdEntries * std::sqrt(added) : added;
            claimEntry(r.outer, r.inner, error);
            claimEntry(r.inner, r.outer, error * scene_.area[r.outer] / scene_.area[r.inner]);
        }
    }

    // Errors of an entry's pairs of pieces are independent: of patches cut in 25, their sum would be 25 times
    // as large.
    void claimEntry(uint32_t from, uint32_t to, double error) {
        const float most = (static_cast<float>(error) + tolerance_) * scene_.shareOfPatch[from];
        entrySquares_[size_t{scene_.pieces[from].patch} * scene_.patchCount + scene_.pieces[to].patch] +=
            most * most;
    }

    void claimCovered(uint32_t from, uint32_t to, double passes) {
        const double error = passes / scene_.patchArea[from];
        rowSquares_[from] += error * error;
        cautiousSquares_[from] += error * error;
        if (!entrySquares_.empty())
            entrySquares_[size_t{from} * scene_.patchCount + to] += static_cast<float>(error * error);
    }

    gpu::Device& device_;
    ExactOptions options_;
    bool discrete_;
    uint32_t words_ = 1, recordCapacity_ = 1, listCapacity_ = 1, cellCapacity_ = 1;
    uint64_t workBytes_ = 0;
    float tolerance_ = 0, cellTolerance_ = 0;
    ExactScene scene_;
    ExactKernels kernels_;
    gpu::Buffer matrix_;       // that tiles are parts of; else
    gpu::Buffer there_, back_; // the tile and its mirror image
    gpu::Buffer claims_;       // as in exact_finish.comp
    gpu::Counters counters_;
    gpu::Buffer sidesA_, sidesB_, blocks_, masks_, records_, fewRecords_, lists_, sums_, cells_[2];
    Stopwatch watch_;
    PartsForecast tiles_;
    double longestTold_ = 0; // seconds, in all
    std::vector<double> rowSquares_, cautiousSquares_;
    double crowdSquares_ = 0;         // of all rows, what pairs behind crowds have
    std::vector<float> entrySquares_; // n x n: of entries' errors
};

void report(const Solver& solver, const ExactOptions& options, ExactFormFactors& result) {
    const ExactScene& scene = solver.scene();
    FormFactorReport& report = result.factors.report;
    const ExactStatistics& s = result.statistics = solver.statistics;
    double squares = 0;
    for (size_t i = 0; i < scene.patchCount; ++i) {
        result.rowError[i] = static_cast<float>(kRowCaution * std::sqrt(solver.cautiousSquares()[i]));
        squares += solver.rowSquares()[i];
    }
    report.claimedRowError = std::sqrt(squares / std::max(1.0, static_cast<double>(scene.patchCount)));
    report.caution = solver.crowdSquares() > kOfCrowds * squares ? kCrowdCaution : kCaution;
    report.why = fmt::format("row error {:g} asked; {} blockers, {} pairs partly hidden, {} cells",
                             options.maxError, s.blockers, s.partial, s.cells);
    if (s.blockers == 0) report.skipped.emplace_back("occlusion: nothing can stand between two patches");
}

ExactFormFactors emptyResult(const geometry::PatchMesh& mesh) {
    ExactFormFactors result;
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
    Solver solver(device, mesh, options, false);
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
    Solver solver(device, mesh, options, true);
    if (solver.hasMatrix()) {
        solver.run([](const ExactTileRange&, const ExactTileRange&) {});
        result.factors.values = solver.takeMatrix();
    } else {
        // Every entry is in one tile or its mirror image.
        gpu::Buffer& matrix = result.factors.values = gpu::Buffer(device, n * n * 4, "form factors");
        const ExactScene& scene = solver.scene();
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
