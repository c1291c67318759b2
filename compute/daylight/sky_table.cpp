#include "compute/daylight/sky_table.h"

#include <algorithm>
#include <stdexcept>

namespace heliodon::daylight {

SkyTable::SkyTable(const Sky& sky) : sun_(sky.shapeDirection) {
    if (sky.formula.intermediate) throw std::invalid_argument("SkyTable: a sky that is not separable");
    for (size_t k = 0; k < gradation_.size(); ++k) {
        const double root = static_cast<double>(k) / kHeights;
        gradation_[k] = static_cast<float>(sky.formula.scale * gradation(sky.formula, root * root));
    }
    for (size_t k = 0; k < indicatrix_.size(); ++k) {
        const double chord = 2.0 * static_cast<double>(k) / kChords;
        indicatrix_[k] = static_cast<float>(indicatrix(sky.formula, 1.0 - 0.5 * chord * chord));
    }
}

} // namespace heliodon::daylight
