// Rooms to bench form factors on, at any size, and models of the user's own.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/patch_mesh.h"

namespace heliodon::app {

struct BenchScene {
    std::string name;
    geometry::PatchMesh mesh;
};

struct BuiltInScene {
    std::string_view name, what;
};
std::span<const BuiltInScene> builtInScenes();

// Throws InputError on a name that is neither a built-in scene nor a model (.obj .gltf .glb) that exists.
void checkBenchScenes(const std::vector<std::string>& names);

// What benchScenes writes, in its `folder`.
std::vector<std::string> sceneFiles(const std::vector<std::string>& names, const std::vector<size_t>& sizes);

// `names`, checked: built-in scenes, each meshed to every one of `sizes` (triangles), or models, whose faces
// are taken as they are; InputError where those look out of what they enclose. The meshes are kept as models
// in `folder`/scenes, so that other programs can be run on them.
std::vector<BenchScene> benchScenes(const std::vector<std::string>& names, const std::vector<size_t>& sizes,
                                    const std::filesystem::path& folder);

} // namespace heliodon::app
