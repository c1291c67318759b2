#include "compute/daylight/sky_table.h"

#include <stdexcept>

namespace heliodon::daylight {

SkyTables::SkyTables(std::span<const Sky* const, kSkies> skies) {
    for (size_t s = 0; s < kSkies; ++s) {
        if (!skies[s]) continue;
        const SkyFormula& formula = skies[s]->formula;
        if (formula.intermediate) throw std::invalid_argument("SkyTables: a sky that is not separable");
        const glm::vec3 sun(skies[s]->shapeDirection);
        x_[s] = sun.x, y_[s] = sun.y, z_[s] = sun.z;
        for (size_t k = 0; k < gradation_.size(); ++k) {
            const double root = static_cast<double>(k) / kHeights;
            gradation_[k][s] = static_cast<float>(formula.scale * gradation(formula, root * root));
        }
        for (size_t k = 0; k < indicatrix_.size(); ++k) {
            const double chord = 2.0 * static_cast<double>(k) / kChords;
            indicatrix_[k][s] = static_cast<float>(indicatrix(formula, 1.0 - 0.5 * chord * chord));
        }
    }
}

} // namespace heliodon::daylight
