#include "engine/app/floor_cells.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

namespace heliodon::app {

namespace {

glm::dvec2 flat(glm::dvec3 p) {
    return {p.x, p.z};
}

bool coversOne(const geometry::PatchMesh& mesh, size_t patch, glm::dvec2 p) {
    const auto corners = mesh.patch(patch);
    for (size_t k = 0; k < corners.size(); ++k) {
        const glm::dvec2 a = flat(mesh.vertices[corners[k]]),
                         b = flat(mesh.vertices[corners[(k + 1) % corners.size()]]);
        if ((b.y - a.y) * (p.x - a.x) - (b.x - a.x) * (p.y - a.y) < -1e-9) return false;
    }
    return true;
}

} // namespace

FloorCells::FloorCells(const geometry::PatchMesh& mesh, const std::vector<size_t>& patches)
    : mesh_(mesh), side_(static_cast<int>(std::ceil(std::sqrt(static_cast<double>(patches.size()) + 1)))),
      cells_(static_cast<size_t>(side_ * side_)) {
    const auto extend = [&](size_t patch, glm::dvec2& low, glm::dvec2& high) {
        for (const uint32_t corner : mesh.patch(patch)) {
            const glm::dvec2 p = flat(mesh.vertices[corner]);
            low = glm::min(low, p), high = glm::max(high, p);
        }
    };
    for (const size_t i : patches) extend(i, low_, high_);
    const glm::dvec2 margin(1e-5 *
                            std::max({high_.x - low_.x, high_.y - low_.y, 1e-6})); // of what is on an edge
    low_ -= margin, high_ += margin;
    for (const size_t i : patches) {
        glm::dvec2 low(1e300), high(-1e300);
        extend(i, low, high);
        const glm::ivec2 first = cellOf(low - margin), last = cellOf(high + margin);
        for (int y = first.y; y <= last.y; ++y)
            for (int x = first.x; x <= last.x; ++x) cells_[at(x, y)].push_back(i);
    }
}

bool FloorCells::covers(glm::dvec2 p) const {
    if (!(p.x >= low_.x && p.y >= low_.y && p.x <= high_.x && p.y <= high_.y)) return false;
    const glm::ivec2 cell = cellOf(p);
    return std::ranges::any_of(cells_[at(cell.x, cell.y)],
                               [&](size_t patch) { return coversOne(mesh_, patch, p); });
}

glm::ivec2 FloorCells::cellOf(glm::dvec2 p) const {
    const glm::dvec2 cell = glm::floor((p - low_) / (high_ - low_) * static_cast<double>(side_));
    return glm::ivec2(glm::clamp(cell, glm::dvec2(0), glm::dvec2(side_ - 1)));
}

} // namespace heliodon::app
