// Models as files: .obj with .mtl, .gltf, .glb.
// Material conventions: Kd = diffuse reflectance, Tf = visible transmittance at normal incidence (absent =
// opaque), Ni 1.52 glass or 1.0 open hole, Ke = exitance in lux. glTF: baseColorFactor
// (absent, as an absent Kd: 0.5, or 0 of a lamp; importModel says so among the repairs),
// KHR_materials_transmission, KHR_materials_emissive_strength. North, where it is not -z (y with z up): a
// line "north DEG" in an .obj, asset.extras.north_deg in a glTF; both heliodon's own.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/building.h"
#include "geometry/patch_mesh.h"
#include "geometry/refused_model.h"

namespace heliodon::geometry {

enum class UpAxis { y, z };

constexpr double kModelNorthDeg = 90; // of files that say nothing of it

// A material that is glass whatever its file says of it, with no reflectance but glass's own; visible
// transmittance at normal incidence, each above 0 and at most 1. Many programs write none.
struct Glazing {
    std::string material;
    glm::vec3 transmittance;
};

// What is said of a model beside its file, most of it of its materials.
struct GivenMaterials {
    std::vector<Glazing> glazing;
    // 0 to below 1: what materials reflect that the file names and does not define, and the brightest channel
    // of those that it states as 1 or more, as no paint is.
    std::optional<float> reflectance;
    // Objects, groups, nodes, meshes and materials of these names: their faces count as not in the file.
    std::vector<std::string> leftOut{};
};

// A model with z up is turned to y up: (x, y, z) -> (x, z, -y). The same turn applies to sensors and skies of
// that model.
glm::dvec3 worldFromModel(glm::dvec3 p, UpAxis up);

// The faces exactly as in the file, one patch each (planar convex polygons; others are refused by line), but
// for what writeModel() wrote of PatchMesh::outside. No closure is asked for. Throws InputError, and so where
// `given` names a material as glass that the file does not.
PatchMesh readPatches(const std::filesystem::path& file, UpAxis up = UpAxis::y,
                      const GivenMaterials& given = {});

// World metres a metre of building, where nobody says it: rooms less than a metre high are of the table's
// size, 12 times smaller than what they stand for.
double assumedWorldPerBuilding(std::span<const glm::dvec3> corners);

struct ImportOptions {
    // Called before each part of the work (1 s of 300,000 faces); what it throws ends the work.
    std::function<void()> beforePart = [] {};
    std::optional<double>
        worldPerBuilding;     // what people and storeys are measured in; none: assumed of the rooms
    GivenMaterials materials; // as of readPatches()
    // Where set, called before a model is refused whose file could be read.
    std::function<void(const RefusedModel&)> onRefusal = {};
};

// The model as closed rooms: duplicate vertices welded, T-vertices split, flipped faces turned where that is
// safe; otherwise refused with the faces named. A model that is not closed is refused. Throws
// InputError.
Building importModel(const std::filesystem::path& file, UpAxis up = UpAxis::y,
                     const ImportOptions& options = {});

// Files of materials that reading a model reads, too: none but of an .obj. Throws InputError where the .obj
// is no text.
std::vector<std::filesystem::path> materialFiles(const std::filesystem::path& file);

// .obj (+ .mtl beside it) or .glb, by extension; written whole. Groups carry role and room, or are
// PatchMesh::outside. `northDeg`: direction of north in the plan, degrees counter-clockwise from +x seen from
// above.
void writeModel(const PatchMesh& mesh, const std::filesystem::path& file, double northDeg = kModelNorthDeg);

} // namespace heliodon::geometry
