#include "engine/app/bench_scenes.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include <fmt/format.h>

#include "compute/closed_solid.h"
#include "geometry/input_error.h"
#include "geometry/mesher.h"
#include "geometry/model_file.h"
#include "geometry/whole_file.h"

namespace heliodon::app {

namespace {

struct Block {
    bool air; // else solid: what comes later in a list wins
    glm::dvec3 low, high;
};

struct Recipe {
    BuiltInScene scene;
    std::vector<Block> blocks; // metres, z up
};

std::vector<Block> louvres() {
    std::vector<Block> blocks{{true, {0, 0, 0}, {4, 4, 3}}};
    for (int k = 0; k < 8; ++k) {
        const double z = 0.4 + 0.3 * k;
        blocks.push_back({false, {1.9, 0, z}, {2.1, 4, z + 0.02}});
    }
    return blocks;
}

const std::vector<Recipe>& recipes() {
    static const std::vector<Recipe> all{
        {{"box", "convex: nothing can hide anything"}, {{true, {0, 0, 0}, {6, 4, 3}}}},
        {{"ell", "L-shaped: one corner hides"}, {{true, {0, 0, 0}, {8, 4, 3}}, {true, {0, 0, 0}, {4, 8, 3}}}},
        {{"partitions", "three partitions of different heights"},
         {{true, {0, 0, 0}, {8, 6, 3}},
          {false, {2, 0, 0}, {2.2, 4, 3}},
          {false, {4, 2, 0}, {4.2, 6, 2.5}},
          {false, {6, 1.5, 0}, {6.2, 4.5, 2}}}},
        {{"blocks", "a box with two blocks on its floor"},
         {{true, {0, 0, 0}, {5, 5, 5}},
          {false, {0.8, 2.6, 0}, {2.4, 4.2, 3.2}},
          {false, {2.8, 0.8, 0}, {4.2, 2.2, 1.6}}}},
        {{"slot", "two rooms that see each other through a slot of 1 %"},
         {{true, {0, 0, 0}, {3, 4, 3}}, {true, {3, 0, 1.5}, {3.1, 4, 1.53}}, {true, {3.1, 0, 0}, {6, 4, 3}}}},
        {{"louvres", "eight thin slats across the middle"}, louvres()}};
    return all;
}

// The border between air and what is not, as rectangles on the grid of all the blocks' planes, wound as seen
// from the air. Wavefront text with z up.
class GridSurface {
public:
    explicit GridSurface(const std::vector<Block>& blocks) : blocks_(blocks) {
        for (int axis = 0; axis < 3; ++axis) {
            std::set<double> planes;
            for (const Block& b : blocks) planes.insert({b.low[axis], b.high[axis]});
            planes_[static_cast<size_t>(axis)].assign(planes.begin(), planes.end());
        }
    }

    std::string obj() {
        const Cell cells{planes_[0].size() - 1, planes_[1].size() - 1, planes_[2].size() - 1};
        for (size_t i = 0; i < cells[0]; ++i)
            for (size_t j = 0; j < cells[1]; ++j)
                for (size_t k = 0; k < cells[2]; ++k)
                    for (size_t axis = 0; axis < 3; ++axis) addSides({i, j, k}, axis, cells);
        return vertices_ + faces_;
    }

private:
    using Cell = std::array<size_t, 3>;

    bool isAir(const Cell& cell) const {
        bool air = false;
        for (const Block& b : blocks_) {
            bool inside = true;
            for (size_t axis = 0; axis < 3; ++axis) {
                const int a = static_cast<int>(axis);
                const double middle = 0.5 * (planes_[axis][cell[axis]] + planes_[axis][cell[axis] + 1]);
                inside = inside && middle > b.low[a] && middle < b.high[a];
            }
            if (inside) air = b.air;
        }
        return air;
    }

    void addSides(const Cell& cell, size_t axis, const Cell& cells) {
        if (!isAir(cell)) return;
        for (size_t side = 0; side < 2; ++side) {
            Cell other = cell;
            const bool border = side ? cell[axis] + 1 == cells[axis] : cell[axis] == 0;
            other[axis] += side ? 1 : static_cast<size_t>(-1);
            if (!border && isAir(other)) continue;
            const size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
            std::array<Cell, 4> corners{cell, cell, cell, cell};
            for (Cell& c : corners) c[axis] += side;
            ++corners[1][a], ++corners[2][a], ++corners[2][b], ++corners[3][b];
            if (side) std::swap(corners[1], corners[3]); // low sides face up their axis: a x b
            faces_ += "f";
            for (const Cell& c : corners) faces_ += fmt::format(" {}", vertex(c));
            faces_ += "\n";
        }
    }

    size_t vertex(const Cell& c) {
        const auto [place, isNew] = numbers_.try_emplace(c, numbers_.size() + 1);
        if (isNew)
            vertices_ += fmt::format("v {} {} {}\n", planes_[0][c[0]], planes_[1][c[1]], planes_[2][c[2]]);
        return place->second;
    }

    const std::vector<Block>& blocks_;
    std::array<std::vector<double>, 3> planes_;
    std::map<Cell, size_t> numbers_;
    std::string vertices_, faces_;
};

std::string knownNames() {
    std::string names;
    for (const BuiltInScene& scene : builtInScenes())
        names += std::string(names.empty() ? "" : ", ") + std::string(scene.name);
    return names;
}

auto recipeOf(const std::string& name) {
    return std::find_if(recipes().begin(), recipes().end(),
                        [&](const Recipe& r) { return r.scene.name == name; });
}

// In the folder of results; models of the user's own are not copied.
std::string fileOf(const std::string& builtIn) {
    return fmt::format("scenes/{}.obj", builtIn);
}
std::string fileOf(const std::string& builtIn, size_t size) {
    return fmt::format("scenes/{}-{}.obj", builtIn, size);
}

// Named after its file; where two are named alike, after the whole path.
void addUserScene(const std::filesystem::path& file, std::vector<BenchScene>& scenes) {
    const std::string stem = file.stem().string();
    const bool taken =
        recipeOf(stem) != recipes().end() ||
        std::any_of(scenes.begin(), scenes.end(), [&](const auto& s) { return s.name == stem; });
    scenes.push_back({taken ? file.string() : stem, geometry::readPatches(file)});
    const geometry::PatchMesh& mesh = scenes.back().mesh;
    if (mesh.patchCount() == 0) throw geometry::InputError(file.string(), "", "has no faces");
    // Nothing reaches anything there: all kernels, and the reference, would agree on zeros.
    if (compute::isClosedSolid(mesh) && compute::facesLookOutwards(mesh))
        throw geometry::InputError(file.string(), "", compute::kFacesLookOutwards);
}

} // namespace

std::span<const BuiltInScene> builtInScenes() {
    static const std::vector<BuiltInScene> scenes = [] {
        std::vector<BuiltInScene> result;
        for (const Recipe& recipe : recipes()) result.push_back(recipe.scene);
        return result;
    }();
    return scenes;
}

void checkBenchScenes(const std::vector<std::string>& names) {
    for (const std::string& name : names) {
        if (recipeOf(name) != recipes().end()) continue;
        const std::string extension = std::filesystem::path(name).extension().string();
        if (extension != ".obj" && extension != ".gltf" && extension != ".glb")
            throw geometry::InputError("--scenes", name,
                                       "unknown; expected a model (.obj .gltf .glb) or " + knownNames());
        if (!std::filesystem::exists(name)) throw geometry::InputError(name, "", "does not exist");
    }
}

std::vector<std::string> sceneFiles(const std::vector<std::string>& names, const std::vector<size_t>& sizes) {
    std::vector<std::string> files;
    for (const std::string& name : names) {
        if (recipeOf(name) == recipes().end()) continue;
        files.push_back(fileOf(name));
        for (const size_t size : sizes) {
            const std::filesystem::path mesh = fileOf(name, size);
            files.push_back(mesh.string());
            files.push_back(std::filesystem::path(mesh).replace_extension(".mtl").string());
        }
    }
    return files;
}

std::vector<BenchScene> benchScenes(const std::vector<std::string>& names, const std::vector<size_t>& sizes,
                                    const std::filesystem::path& folder) {
    std::vector<BenchScene> scenes;
    for (const std::string& name : names) {
        const auto recipe = recipeOf(name);
        if (recipe == recipes().end()) {
            addUserScene(name, scenes);
            continue;
        }
        const std::filesystem::path file = folder / fileOf(name);
        std::filesystem::create_directories(file.parent_path());
        geometry::writeWholeText(file, GridSurface(recipe->blocks).obj());
        const geometry::Building building = geometry::importModel(file, geometry::UpAxis::z);
        for (const size_t size : sizes) {
            scenes.push_back({name, geometry::meshBuilding(building, {size})});
            geometry::writeModel(scenes.back().mesh, folder / fileOf(name, size));
        }
    }
    return scenes;
}

} // namespace heliodon::app
