// The floors of a plan, with the sensors that stand over them and the sun among those.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "engine/app/floor_cells.h"
#include "engine/app/plan_chart.h"
#include "engine/app/plan_field.h"
#include "engine/app/plan_frame.h"

namespace heliodon::app {

using Points = std::vector<glm::dvec2>;

// Where the sun falls on the planes of a floor's sensors.
struct Sunlight {
    std::vector<double> heights; // of the planes
    struct Part {
        size_t plane;
        Points polygon; // convex
        double lux;
    };
    std::vector<Part> parts;
};

using Edges = std::vector<std::array<glm::dvec3, 2>>;

struct PlanFloor {
    uint32_t room;
    double height;               // of its lowest patch, world metres
    std::vector<size_t> patches; // from the lowest
    FloorCells cells;
    Edges outline, openings{};
    Edges section{}; // of the room by the plane of the sensors, where that cuts what stands free of the floor
    size_t storey = 0;             // from the lowest, which is 0, among those that have sensors
    std::vector<Sample> samples{}; // all that is shown
    std::optional<Sunlight> sun{}; // of all samples, which have their values without it in `shaded`
    std::vector<Sample> shaded{};

    // Whether p is floor and, in the plane of the sensors, air.
    bool isOpenAt(glm::dvec2 p) const;
};

// A sensor stands over the highest floor below it. Floors of which one lies over another are of different
// storeys, others of that whose height is nearest; without any sensor all storeys are there, with all in them
// that looks up below a person's height. Tops of walls that no sensor stands above are no floor, nor is what
// is as high as sensors stand over floor, but for such floor itself (pits, stages). Of several sensors at one
// place over a floor the first is taken.
std::vector<PlanFloor> planFloors(const Scene& scene, const PlanValues& given);

// "floors from 3.00 m", building metres, of some of a storey.
std::string storeyInWords(const std::vector<PlanFloor>& floors, double worldPerBuilding);

// Edges of some patches that only one of them has, by place so that welding does not matter.
Edges borders(const geometry::PatchMesh& mesh, const std::vector<size_t>& patches);

} // namespace heliodon::app
