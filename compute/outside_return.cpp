#include "compute/outside_return.h"

#include <glm/geometric.hpp>

#include "geometry/outline_area.h"

namespace heliodon::compute {

OutsideReturn::OutsideReturn(const geometry::PatchMesh& mesh, const OutsideReflection& reflection,
                             std::span<const std::vector<OutsideShare>> patchWalls)
    : reflection_(&reflection) {
    if (reflection.isEmpty()) return;
    seen_ = patchWalls;
    for (size_t i = 0; i < seen_.size(); ++i) area_.push_back(geometry::patchArea(mesh, i));
    for (const OutsideCell& cell : reflection.cells())
        cellArea_.push_back(0.5 * glm::length(geometry::areaVector(cell.corners)));
}

void OutsideReturn::add(uint32_t channel, std::span<const float> in, std::span<float> out) const {
    if (isEmpty()) return;
    const auto axis = static_cast<int>(channel);
    std::vector<double> lumens(cellArea_.size(), 0);
    for (size_t i = 0; i < seen_.size(); ++i)
        for (const OutsideShare& share : seen_[i])
            lumens[share.cell] += area_[i] * double{share.weight[axis]} * double{in[i]};
    std::vector<glm::vec3> straight(lumens.size(), glm::vec3(0));
    for (size_t c = 0; c < lumens.size(); ++c)
        straight[c][axis] = static_cast<float>(lumens[c] / cellArea_[c]);
    const std::vector<glm::vec3> sent = reflection_->exitance(straight);
    for (size_t i = 0; i < seen_.size(); ++i)
        for (const OutsideShare& share : seen_[i]) out[i] += share.weight[axis] * sent[share.cell][axis];
}

std::vector<TintedShare> OutsideReturn::rowOf(std::span<const OutsideShare> own) const {
    std::vector<TintedShare> row;
    if (isEmpty() || own.empty()) return row;
    std::vector<glm::vec3> answers(cellArea_.size(), glm::vec3(0));
    for (uint32_t c = 0; c < 3; ++c) {
        const auto axis = static_cast<int>(c);
        std::vector<float> channel(answers.size(), 0);
        for (const OutsideShare& share : own) channel[share.cell] += share.weight[axis];
        reflection_->answer(c, channel);
        for (size_t k = 0; k < channel.size(); ++k)
            answers[k][axis] = channel[k] / static_cast<float>(cellArea_[k]);
    }
    for (uint32_t i = 0; i < seen_.size(); ++i) {
        glm::vec3 sum(0);
        for (const OutsideShare& share : seen_[i]) sum += share.weight * answers[share.cell];
        if (sum != glm::vec3(0)) row.push_back({i, static_cast<float>(area_[i]) * sum});
    }
    return row;
}

std::vector<glm::vec3> OutsideReturn::rowSums() const {
    std::vector<glm::vec3> sums(seen_.size(), glm::vec3(0));
    const std::vector<float> ones(seen_.size(), 1.0F);
    for (uint32_t c = 0; c < 3 && !isEmpty(); ++c) {
        std::vector<float> of(seen_.size(), 0);
        add(c, ones, of);
        for (size_t i = 0; i < of.size(); ++i) sums[i][static_cast<int>(c)] = of[i];
    }
    return sums;
}

} // namespace heliodon::compute
