#include "geometry/gltf_materials.h"

#include <cstddef>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>
#pragma GCC diagnostic pop

#include "geometry/texture_mean.h"

namespace heliodon::geometry {

namespace {

constexpr const char* kSpecularGlossiness = "KHR_materials_pbrSpecularGlossiness";

double extensionNumber(const tinygltf::Material& material, const char* extension, const char* field,
                       double otherwise) {
    const auto found = material.extensions.find(extension);
    if (found == material.extensions.end() || !found->second.Has(field)) return otherwise;
    return found->second.Get(field).GetNumberAsDouble();
}

template<class List> bool isIn(const List& list, int index) {
    return index >= 0 && static_cast<size_t>(index) < list.size();
}

} // namespace

const tinygltf::Value* diffuse(const tinygltf::Material& in, const char* field) {
    const auto found = in.extensions.find(kSpecularGlossiness);
    return found != in.extensions.end() && found->second.Has(field) ? &found->second.Get(field) : nullptr;
}

bool hasColour(const tinygltf::Material& in) {
    return in.values.contains("baseColorFactor") || diffuse(in, "diffuseFactor");
}

std::vector<double> colourOf(const tinygltf::Material& in) {
    const tinygltf::Value* stated = diffuse(in, "diffuseFactor");
    if (!stated) return in.pbrMetallicRoughness.baseColorFactor;
    std::vector<double> colour;
    for (size_t c = 0; c < stated->ArrayLen(); ++c)
        colour.push_back(stated->Get(static_cast<int>(c)).GetNumberAsDouble());
    return colour;
}

std::pair<int, const char*> textureOf(const tinygltf::Material& in) {
    if (const tinygltf::Value* older = diffuse(in, "diffuseTexture"))
        return {older->Has("index") ? older->Get("index").GetNumberAsInt() : 0, "diffuseTexture"};
    return {in.pbrMetallicRoughness.baseColorTexture.index, "baseColorTexture"};
}

const char* otherTextureOf(const tinygltf::Material& in) {
    if (in.emissiveTexture.index >= 0 && in.emissiveFactor != std::vector<double>{0, 0, 0})
        return "emissiveTexture";
    const auto through = in.extensions.find("KHR_materials_transmission");
    return through != in.extensions.end() && through->second.Has("transmissionTexture")
               ? "transmissionTexture"
               : nullptr;
}

std::optional<glm::vec3> meanOf(const tinygltf::Model& model, int texture) {
    if (!isIn(model.textures, texture)) return std::nullopt;
    const int source = model.textures[static_cast<size_t>(texture)].source;
    if (!isIn(model.images, source)) return std::nullopt;
    const tinygltf::Image& image = model.images[static_cast<size_t>(source)];
    if (image.bufferView < 0) return textureMean(image.image);
    if (!isIn(model.bufferViews, image.bufferView)) return std::nullopt;
    const tinygltf::BufferView& view = model.bufferViews[static_cast<size_t>(image.bufferView)];
    if (!isIn(model.buffers, view.buffer)) return std::nullopt;
    const std::vector<unsigned char>& bytes = model.buffers[static_cast<size_t>(view.buffer)].data;
    if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset)
        return std::nullopt;
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(view.byteOffset);
    return textureMean({begin, begin + static_cast<std::ptrdiff_t>(view.byteLength)});
}

Material materialOf(const tinygltf::Material& in, glm::vec3 texture) {
    Material out;
    out.name = in.name;
    const std::vector<double> base = colourOf(in);
    const double transmission = extensionNumber(in, "KHR_materials_transmission", "transmissionFactor", 0);
    const double strength = extensionNumber(in, "KHR_materials_emissive_strength", "emissiveStrength", 1);
    for (int c = 0; c < 3; ++c) {
        const auto channel = static_cast<size_t>(c);
        const double colour = base.at(channel) * static_cast<double>(texture[c]);
        out.reflectance[c] = static_cast<float>(colour * (1 - transmission));
        out.transmittance[c] = static_cast<float>(colour * transmission);
        out.exitance[c] = static_cast<float>(in.emissiveFactor.at(channel) * strength);
    }
    out.refractiveIndex = static_cast<float>(extensionNumber(in, "KHR_materials_ior", "ior", 1.52));
    return out;
}

} // namespace heliodon::geometry
