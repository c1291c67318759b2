// What a glTF needs to be read: its version, the extensions that it requires, and the types of the fields
// that rooms are made of. The loader passes over a field of another type and goes on with its default, which
// would place or colour things silently wrong.
#pragma once

#include <string>
#include <string_view>

namespace heliodon::geometry {

// Throws InputError naming the first field that is wrong, "nodes[0].scale[1]", with what was expected.
// `bytes`: of a .gltf or .glb; what is no JSON is left to the loader to complain about.
void checkGltfFields(std::string_view bytes, const std::string& file);

} // namespace heliodon::geometry
