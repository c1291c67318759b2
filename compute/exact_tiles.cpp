#include "compute/exact_tiles.h"

#include <vector>

namespace heliodon::compute {

void handOver(const ExactScene& scene, const ExactTileRange& a, const ExactTileRange& b,
              const gpu::Buffer& values, const std::function<void(const ExactTile&)>& take) {
    const gpu::HostView<float> view(values, static_cast<size_t>(a.pieces) * b.pieces);
    ExactTile tile{a.firstPatch, a.patches, b.firstPatch, b.patches, view.data()};
    std::vector<float> merged;
    if (a.pieces != a.patches || b.pieces != b.patches) {
        std::vector<double> sums(static_cast<size_t>(a.patches) * b.patches, 0.0), area(a.patches, 0.0);
        std::vector<uint32_t> column(b.pieces);
        for (uint32_t k = b.firstPiece; k < b.firstPiece + b.pieces; ++k)
            column[scene.placeOfPiece[k]] = scene.patchOfPiece[k] - b.firstPatch;
        for (uint32_t k = a.firstPiece; k < a.firstPiece + a.pieces; ++k) {
            const size_t row = scene.patchOfPiece[k] - a.firstPatch;
            const float* from = tile.values + static_cast<size_t>(scene.placeOfPiece[k]) * b.pieces;
            area[row] += double{scene.area[k]};
            for (size_t j = 0; j < b.pieces; ++j)
                sums[row * b.patches + column[j]] += double{scene.area[k]} * double{from[j]};
        }
        for (size_t k = 0; k < sums.size(); ++k)
            merged.push_back(area[k / b.patches] > 0 ? static_cast<float>(sums[k] / area[k / b.patches])
                                                     : 0.0f);
        tile.values = merged.data();
    }
    take(tile);
}

} // namespace heliodon::compute
