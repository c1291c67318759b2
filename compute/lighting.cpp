#include "compute/lighting.h"

#include <algorithm>

namespace heliodon::compute {

void addTimes(std::vector<glm::vec3>& sum, glm::vec3 times, const std::vector<glm::vec3>& more) {
    sum.resize(std::max(sum.size(), more.size()), glm::vec3(0));
    for (size_t i = 0; i < more.size(); ++i) sum[i] += times * more[i];
}

void LightDetail::add(const LightDetail& other, glm::vec3 times) {
    addTimes(mean, times, other.mean);
    addTimes(corners, times, other.corners);
    std::vector<PatchGlow> all;
    auto mine = grids.begin();
    for (const PatchGlow& grid : other.grids) {
        while (mine != grids.end() && mine->patch < grid.patch) all.push_back(*mine++);
        PatchGlow& sum = mine != grids.end() && mine->patch == grid.patch ? all.emplace_back(*mine++)
                                                                          : all.emplace_back(grid.patch);
        for (size_t k = 0; k < sum.lux.size(); ++k) sum.lux[k] += times * grid.lux[k];
    }
    all.insert(all.end(), mine, grids.end());
    grids = std::move(all);
}

} // namespace heliodon::compute
