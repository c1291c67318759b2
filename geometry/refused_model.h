// What a plan shows of a model that is refused: its faces as they were read, and where the refusal is about.
#pragma once

#include <vector>

#include <glm/vec3.hpp>

namespace heliodon::geometry {

struct ModelPlace;
struct RawModel;

// World metres. Edges: both ends of each.
struct RefusedModel {
    using Outlines = std::vector<std::vector<glm::dvec3>>;
    Outlines walls, glass;          // of all faces
    std::vector<Outlines> named;    // of the faces that are at fault, the one that is named first
    std::vector<glm::dvec3> border; // edges round the hole that is named
    std::vector<glm::dvec3> open;   // all edges that end in the air
    double worldPerBuilding = 1, northDeg = 90;
};

// `extent`: of the model, world metres. Cost: that of cutIntoSheets().
RefusedModel refusedModel(const RawModel& model, const ModelPlace& where, double extent,
                          double worldPerBuilding);

} // namespace heliodon::geometry
