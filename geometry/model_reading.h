// What every try at the rooms of one model goes by, whichever of its faces it takes.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include <glm/vec3.hpp>

#include "geometry/input_error.h"
#include "geometry/model_faces.h"
#include "geometry/model_file.h"
#include "geometry/raw_model.h"

namespace heliodon::geometry {

struct ModelReading {
    RawModel model;                   // turned to y up
    std::optional<double> givenScale; // world metres a metre of building
    std::function<void()> beforePart; // as ImportOptions has it
    double extent = 0;                // world metres, times how much coarser than usual tolerances are

    // Of a pane that has one room on both sides and lies on a wall: says more than what is refused after it.
    std::optional<InputError> coveredPane;

    double tolerance() const { return kWeldOfExtent * extent; }
    double flatness() const { return kPlanarOfExtent * extent; }
    double worldPerBuilding(std::span<const glm::dvec3> corners) const {
        return givenScale.value_or(assumedWorldPerBuilding(corners));
    }
    double worldPerBuilding() const { return worldPerBuilding(model.vertices); }
    // World metres, or a point of the world, in metres of the building.
    template<class Lengths> Lengths inBuilding(Lengths metres) const { return metres / worldPerBuilding(); }

    // Of a material, and of a face by its number in the file; good as long as this stands where it does.
    std::function<bool(uint32_t)> isGlass() const {
        return [this](uint32_t m) { return model.materials[m].isOpening(); };
    }
    std::function<std::string(uint32_t)> place() const {
        return [this](uint32_t f) { return model.place(f); };
    }
};

} // namespace heliodon::geometry
