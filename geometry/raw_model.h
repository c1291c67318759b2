// A model as its file states it, before any judgement: what the readers of .obj and .gltf/.glb hand to
// model_file.cpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/glass_mark.h"
#include "geometry/input_error.h"
#include "geometry/model_file.h"
#include "geometry/patch_mesh.h"

namespace heliodon::geometry {

// The file's units along an axis from the origin: twice a national grid (5000 km) in millimetres. Beyond it
// double precision no longer tells the parts of a room well enough apart.
constexpr double kFarthest = 1e10;
constexpr double kLargest = 1e7; // from one face to another; beyond it the unit is wrong

// Heliodon's own: the group of PatchMesh::outside.
constexpr const char* kOutsideGroup = "heliodon_outside";

struct RawModel {
    std::string file;
    UpAxis up = UpAxis::y;            // of the file, where `vertices` were turned from that to y up
    std::vector<glm::dvec3> vertices; // finite, in the file's own axes
    double step = 0;                  // to which a glTF's accessors round these, as far as is known
    // Face i has the corners corners[firstCorner[i] .. firstCorner[i + 1]), at least three, all valid
    // indices.
    std::vector<uint32_t> corners;
    std::vector<uint32_t> firstCorner{0};
    // Per corner, in the file's own axes, as the file gives them, finite or not: what a curved surface is
    // smooth by. 0 where the file gives none; empty where it gives none at all.
    std::vector<glm::vec3> cornerNormals;
    // Per face, of those without normals: neighbours of one group but 0 are smooth. Empty where all are 0.
    std::vector<uint32_t> smoothing;
    std::vector<uint32_t> material; // per face, into `materials`
    std::vector<uint32_t> group;    // per face, into `groups`
    std::vector<size_t> number; // per face: its line in an .obj, its triangle within the primitive in a glTF
    std::vector<std::string> groups;
    std::vector<std::string> source; // per group: "" in an .obj, "meshes[0].primitives[1]" in a glTF
    // Per group, as programs show it: "object" and "Wall.003"; without a name "".
    struct Object {
        const char* kind;
        std::string name;
        bool operator==(const Object&) const = default;
    };
    std::vector<Object> object;
    std::vector<std::vector<std::string>>
        above; // per group, in a glTF: the names of the nodes that it is under
    std::vector<Material>
        materials;                  // finite, reflectance in [0, 1), with transmittance at most 1 (but flaws)
    std::optional<double> northDeg; // direction of north, as Building has it, where the file says it
    // Pairs of faces that are the two sides of interior glass, where the file says which: all other panes
    // then look outside. Any numbers at all; `of` faces, with this `glass`, that the file had when it was
    // said.
    struct Twins {
        uint32_t of = 0;
        std::optional<GlassMark> glass;
        std::vector<std::pair<uint32_t, uint32_t>> pairs;
    };
    std::optional<Twins> twins;
    // The faces of kOutsideGroup, by their corners in `vertices`; they are not among the others.
    struct Outside {
        std::vector<uint32_t> corners;
        uint32_t material;
    };
    std::vector<Outside> outside;
    // By material, one sentence each: what the file does not say, and what may have been meant otherwise.
    std::map<uint32_t, std::string> assumed, doubts;
    // By material, what else colours it in the file and is not read: "map_Kd brick.png", "COLOR_0".
    std::map<uint32_t, std::string> unread;
    std::vector<std::string> leftOut; // of GivenMaterials::leftOut, one sentence each
    // What keeps materials from being used, in the order of the file, unless GivenMaterials mend it.
    struct Flaw {
        enum class Kind { missingFile, undefined, tooBright, unphysical } kind;
        std::string file, place, what;
        uint32_t material = 0; // of none where a file is missing
    };
    std::vector<Flaw> flaws;

    // Adds a corner to the face that is not ended yet.
    void addCorner(uint32_t vertex, glm::vec3 normal);
    void endFace(uint32_t itsMaterial, size_t itsNumber, uint32_t itsSmoothing = 0); // of the last group

    // One of `vertices`, or a point among them, as the file's axes have it.
    glm::dvec3 inFile(glm::dvec3 p) const { return up == UpAxis::z ? glm::dvec3(p.x, -p.z, p.y) : p; }
    size_t faceCount() const { return firstCorner.size() - 1; }
    std::span<const uint32_t> face(size_t i) const {
        return {corners.data() + firstCorner[i], firstCorner[i + 1] - firstCorner[i]};
    }
    // Its outline, and holes after it: a polygon that runs to a hole and back along the same edge, as
    // programs write what has no other way to say hole, is taken apart there. Else the face itself.
    std::vector<std::vector<uint32_t>> loops(size_t i) const;
    // How a message names the face: "12" (a line) or "meshes[0].primitives[1] triangle 5", and then the
    // object, as in R"(12 (object "Wall.003"))".
    std::string place(size_t i) const;
    // Of a list of faces; an object that several have in turn stands behind the last of them.
    std::string places(std::span<const uint32_t> faces) const;
    // What is wrong with the face, which the message names.
    InputError errorAt(uint32_t face, const std::string& what) const;
    // The same of a model that does not close.
    InputError openAt(uint32_t face, const std::string& what) const;
    // Where a message names an object that has no glass and is not most of what there is: how to do without
    // it, for a shell. Of a pane and what lies on it the latter. Else "".
    std::string doWithoutNamed(const InputError& error) const;
};

// Both throw InputError naming the line or the field. Unknown keys are ignored.
RawModel readObj(const std::filesystem::path& file);
RawModel readGltf(const std::filesystem::path& file);
// By extension; throws InputError for others, for a model without faces, and for one that names a face with a
// corner beyond kFarthest or kLargest, or `given` a material that it has not, or has a flaw that nothing
// given mends.
RawModel readRawModel(const std::filesystem::path& file, const GivenMaterials& given = {});

// Of a material that is see-through, so that `opacity` of what is behind it is hidden, but transmits nothing:
// glass may be meant, and is not made of it, for how much light passes at what angle is not known. Glazing
// says it.
std::string seeThroughButOpaque(const std::string& material, double opacity, const char* transmittance);

// What a format calls the values of a material.
struct MaterialFields {
    const char *reflectance, *transmittance, *exitance, *refractiveIndex;
};

// Naming the field, unless the material's values are physical.
std::optional<RawModel::Flaw> flawOf(const Material& material, const MaterialFields& fields,
                                     const std::string& file, const std::string& place);

} // namespace heliodon::geometry
