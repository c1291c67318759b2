// From whatever the user named to a mesh: photograph -> sketch -> building -> mesh, entered where the input
// starts.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "engine/app/arguments.h"
#include "engine/app/run.h"
#include "geometry/model_file.h"
#include "geometry/patch_mesh.h"
#include "geometry/rig.h"
#include "geometry/sketch.h"

namespace heliodon::vision {
struct Photograph;
}

namespace heliodon::app {

constexpr size_t kDefaultTriangles = 2000;
constexpr const char* kAssumedNorth = "north along y of the plan (no arrow)";

struct Scene {
    std::optional<geometry::Rig> rig;
    std::optional<geometry::Sketch> sketch; // none for models
    geometry::UpAxis up = geometry::UpAxis::y;
    geometry::Occluders occluders; // physical walls; none for models
    // Direction of north in the plan: degrees counter-clockwise from +x, seen from above.
    double northDeg = 90;
    std::string assumedNorth;           // in words, where neither sketch, model nor --north says it
    double worldPerBuilding = 1.0 / 12; // world metres a metre of building
    geometry::PatchMesh mesh;
};

// Says which `fields` of a file (geometry/field_names.h) are "no part of a rig"; nothing where there are
// none.
void warnOfUnknown(Run& run, const std::filesystem::path& file, const std::vector<std::string>& fields,
                   const char* of);

// True when the input is a picture: what the file's name says.
bool isPhotograph(const std::filesystem::path& input);

// Throws InputError: colours state what the pieces are.
void refuseGrey(const vision::Photograph& photograph);

// A rig that says nothing of its table: the paper's is assumed, and noted.
geometry::Rig loadRig(Run& run, const std::filesystem::path& file);

// Of a rig that has none, where pictures for them were to be expected.
void warnOfNoProjectors(Run& run, const std::filesystem::path& rig);

geometry::UpAxis upAxisOf(const SceneArguments& arguments);

// Of --glass, --reflectance and --leave-out. Throws InputError.
geometry::GivenMaterials materialsOf(const SceneArguments& arguments);

// The sketch in a file, or detected in a photograph (which needs a rig). Fills `stages.detect` and `detected`
// of the report.
geometry::Sketch loadSketch(Run& run, const SceneArguments& arguments,
                            const std::optional<geometry::Rig>& rig);

// What loadScene reads before it meshes: the rig and the sketch of what has them.
struct SceneSource {
    std::optional<geometry::Rig> rig;
    std::optional<geometry::Sketch> sketch; // none for models
};
SceneSource readSource(Run& run, const SceneArguments& arguments);

// Everything up to the mesh. A closure that is refused fills the report (`outcome`, `code`, `message`) and
// throws InputError.
Scene loadScene(Run& run, const SceneArguments& arguments);

// As geometry::ImportOptions has it.
using OnRefusal = std::function<void(const geometry::RefusedModel&)>;

// The same from a sketch that is at hand (none: from the model that the arguments name, which names the
// source in messages all the same).
Scene makeScene(Run& run, const SceneArguments& arguments, std::optional<geometry::Rig> rig,
                std::optional<geometry::Sketch> sketch, const OnRefusal& onRefusal = {});

} // namespace heliodon::app
