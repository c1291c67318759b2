#include "compute/exact_tiles.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "compute/gpu/commands.h"
#include "compute/gpu/device.h"

namespace heliodon::compute {

void handOver(const ExactScene& scene, const ExactTileRange& a, const ExactTileRange& b,
              const gpu::Buffer& values, const std::function<void(const ExactTile&)>& take) {
    const gpu::HostView<float> view(values, static_cast<size_t>(a.pieces) * b.pieces);
    ExactTile tile{a.firstPatch, a.patches, b.firstPatch, b.patches, view.data()};
    std::vector<float> merged;
    if (!a.piecesArePatches || !b.piecesArePatches) {
        std::vector<double> sums(static_cast<size_t>(a.patches) * b.patches, 0.0);
        std::vector<uint32_t> column(b.pieces);
        for (uint32_t k = b.firstPiece; k < b.firstPiece + b.pieces; ++k)
            column[scene.pieces[k].place] = scene.pieces[k].patch - b.firstPatch;
        for (uint32_t k = a.firstPiece; k < a.firstPiece + a.pieces; ++k) {
            const size_t row = scene.pieces[k].patch - a.firstPatch;
            const float* from = tile.values + static_cast<size_t>(scene.pieces[k].place) * b.pieces;
            for (size_t j = 0; j < b.pieces; ++j)
                sums[row * b.patches + column[j]] += double{scene.area[k]} * double{from[j]};
        }
        const auto across = [&](uint32_t i, uint32_t j, double exchange) {
            if (i - a.firstPatch < a.patches && j - b.firstPatch < b.patches)
                sums[size_t{i - a.firstPatch} * b.patches + (j - b.firstPatch)] += exchange;
        };
        for (const ExactScene::Covered& covered : scene.covered) {
            across(covered.first, covered.second, covered.area);
            across(covered.second, covered.first, covered.area);
        }
        for (size_t k = 0; k < sums.size(); ++k) {
            const double area = scene.patchArea[a.firstPatch + k / b.patches];
            merged.push_back(area > 0 ? static_cast<float>(sums[k] / area) : 0.0f);
        }
        tile.values = merged.data();
    }
    take(tile);
}

void placeTile(gpu::Device& device, const ExactScene& scene, const ExactTileRange& a, const ExactTileRange& b,
               const gpu::Buffer& values, gpu::Buffer& matrix) {
    const size_t n = scene.patchCount, offset = size_t{a.firstPatch} * n + b.firstPatch;
    const auto copyOnDevice = [&](const gpu::Buffer& from) {
        gpu::Commands commands(device);
        commands.copyRows(from, size_t{b.patches} * sizeof(float), matrix, offset * sizeof(float),
                          n * sizeof(float), size_t{b.patches} * sizeof(float), a.patches);
        device.submitAndWait(std::move(commands));
    };
    float* all = matrix.mapped<float>();
    if (!all && a.piecesArePatches && b.piecesArePatches) return copyOnDevice(values);
    handOver(scene, a, b, values, [&](const ExactTile& tile) {
        const size_t rows = tile.rows, columns = tile.columns;
        if (!all)
            return copyOnDevice(
                gpu::Buffer::from(device, std::span(tile.values, rows * columns), "exact tile"));
        for (size_t i = 0; i < rows; ++i)
            std::copy_n(tile.values + i * columns, columns, all + offset + i * n);
    });
}

} // namespace heliodon::compute
