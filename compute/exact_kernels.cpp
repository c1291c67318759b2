#include "compute/exact_kernels.h"

#include <algorithm>
#include <array>
#include <vector>

#include "compute/gpu/device.h"
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

using Words = std::span<const uint32_t>;

ExactKernels::Source ExactKernels::sidesSource() {
    return {exact_sides_comp, "exact_sides", {}};
}
ExactKernels::Source ExactKernels::blocksSource() {
    return {exact_blocks_comp, "exact_blocks", {{"kCorners", 4u}}};
}
ExactKernels::Source ExactKernels::linesSource() {
    return {exact_lines_comp, "exact_lines", {}};
}
ExactKernels::Source ExactKernels::manySource() {
    return {exact_cells_comp, "exact_cells", {}};
}
ExactKernels::Source ExactKernels::finishSource() {
    return {exact_finish_comp, "exact_finish", {}};
}

// Patches of three corners have shaders of their own, folded when the program is built.
ExactKernels::Source ExactKernels::pairsSource(bool clear) const {
    const Words folded = clear ? Words(exact_pairs_clear_comp) : Words(exact_pairs_mixed_comp);
    return {corners_ == 3 ? folded : Words(exact_pairs_comp),
            "exact_pairs",
            {{"kCorners", corners_}, {"kClear", clear ? 1u : 0u}}};
}

ExactKernels::Source ExactKernels::fewSource(uint32_t blockers) const {
    const uint32_t corners = std::min(corners_, io::kExactFewCorners);
    static constexpr std::array<Words, io::kExactFew + 1> kFolded{
        Words(exact_few_open_comp), Words(exact_few_one_comp), Words(exact_few_two_comp)};
    return {corners == 3 ? kFolded[blockers] : Words(exact_few_comp),
            "exact_few",
            {{"kCorners", corners}, {"kBlockers", blockers}}};
}

const gpu::Kernel& ExactKernels::made(const Source& s) const {
    return device_->kernels().get(s.spirv, s.name, s.values);
}

void ExactKernels::prepare(bool byLines, uint32_t blockers) const {
    std::vector<Source> likely{sidesSource(), blocksSource(), pairsSource(true), pairsSource(false),
                               fewSource(0)};
    if (byLines) {
        likely.push_back(linesSource());
        likely.push_back(fewSource(io::kExactFew));
    } else {
        for (uint32_t k = 1; k <= std::min(blockers, io::kExactFew); ++k) likely.push_back(fewSource(k));
        if (blockers > io::kExactFew) likely.push_back(manySource());
    }
    likely.push_back(finishSource());
    for (const Source& s : likely) device_->kernels().prepare(s.spirv, s.name, s.values);
}

} // namespace heliodon::compute
