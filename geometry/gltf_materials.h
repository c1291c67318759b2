// Materials of glTF 2.0: metallic-roughness or KHR_materials_pbrSpecularGlossiness,
// KHR_materials_transmission, KHR_materials_ior and KHR_materials_emissive_strength.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "geometry/raw_model.h"

namespace tinygltf {
struct Material;
class Model;
class Value;
} // namespace tinygltf

namespace heliodon::geometry {

// What is transmitted is tinted by the base colour, the rest of it is reflected.
constexpr MaterialFields kGltfFields{"baseColorFactor", "transmissionFactor", "emissiveFactor", "ior"};

// The same as the base colour of a material that has no metal, in older files; null where there is none.
const tinygltf::Value* diffuse(const tinygltf::Material& in, const char* field);
bool hasColour(const tinygltf::Material& in); // else the loader fills in the default
// Red, green, blue and opacity, without the texture's.
std::vector<double> colourOf(const tinygltf::Material& in);

// Index of the texture that colours it, negative where there is none, and its field.
std::pair<int, const char*> textureOf(const tinygltf::Material& in);
// The field of one that dims what it emits or transmits; null where there is none.
const char* otherTextureOf(const tinygltf::Material& in);
// Its textureMean(), where the image loader kept the bytes of files; none where its picture cannot be read.
std::optional<glm::vec3> meanOf(const tinygltf::Model& model, int texture);

// `texture`: what its colour is multiplied with.
Material materialOf(const tinygltf::Material& in, glm::vec3 texture);

} // namespace heliodon::geometry
